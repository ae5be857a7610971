"""Positions as printed: length over count is the spacing, and half of the last digit is no fault."""

from pathlib import Path

import h5netcdf
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as some

from asperity import read_surface
from asperity.errors import InputError, OutOfRangeWarning
from asperity.studies.recorded import read_signal
from asperity.surfaces.readers import positions

DIGITS = range(3, 9)


def printed(values, form):
    """Numbers that a column holds, as a format writes them."""
    return np.array([float(format(value, form)) for value in values])


def even(start, step, count):
    return start + step * np.arange(count)


forms = some.one_of(
    some.integers(3, 8).map("{}".format).map(".{}g".format),
    some.integers(2, 6).map(".{}f".format),
)
lines = some.tuples(some.sampled_from([0.0, 0.00031, -1.7]), some.floats(0.011, 1.9), some.integers(30, 900))


@settings(max_examples=150, deadline=None)
@given(lines, forms, some.booleans())
@example((-1.7, 0.020348171688921987, 30), ".3g", False)  # one step printed as 0.03: no point is missing
@example((0.0, 1.6171875, 621), ".3g", False)  # the last two are printed as 1e+03: none is there twice
def test_any_even_line_is_even_however_it_is_printed(line, form, falling):
    exact = even(*line)
    x = printed(exact[::-1] if falling else exact, form)
    index, step = positions.places(x, "x")
    np.testing.assert_array_equal(index, np.arange(len(x))[:: -1 if falling else 1])
    off = np.abs(np.sort(x) - exact)
    assert abs(step - line[1]) * (len(x) - 1) <= off[0] + off[-1] + 1e-12


@settings(max_examples=60, deadline=None)
@given(lines, some.integers(2, 4), some.sampled_from([-1, 1]), some.data())
def test_a_point_more_than_a_digit_off_is_told(line, decimals, side, data):
    """The digit is at least 0.05 of the spacing, so that it decides."""
    digit = 10.0**-decimals
    start, step, count = line
    x = np.round(even(start, min(step, 19.0 * digit), count), decimals)
    moved = data.draw(some.integers(2, count - 3))
    x[moved] += side * max(1.5 * digit, 0.3 * min(step, 19.0 * digit))
    with pytest.raises(InputError, match=r"not uniform|several points|regular grid"):
        positions.line(np.round(x, decimals + 1), np.zeros(count), "f")


def test_points_that_stand_in_no_order_and_are_printed_alike_are_at_one_place():
    """In order the two 1e+03 at the end are neighbours; shuffled, nothing tells them apart."""
    x = printed(even(0.0, 1.6171875, 621), ".3g")
    shuffled = np.random.default_rng(1).permutation(621)
    index, _ = positions.places(x[shuffled], "x")
    assert np.sort(index)[-2:].tolist() == [619, 619]


@pytest.mark.parametrize("x", [
    np.cumsum(1.0 + 0.03 * np.arange(400) / 400),  # the spacing grows by 3 %
    np.sort(np.random.default_rng(2).random(400)) * 400,
    np.concatenate([even(0, 1, 200), even(200, 1.1, 200)]),
    np.array([0.0, 1.0, 2.6]),
])  # fmt: skip
def test_what_is_uneven_is_told(x):
    for decimals in (2, 4):
        with pytest.raises(InputError, match=r"not uniform|several points|regular grid"):
            positions.line(np.round(x, decimals), np.zeros(len(x)), "f")
    with pytest.raises(InputError, match="not uniform"):  # so few points that chance rounds them to a line
        positions.line(np.array([0.0, 1.0, 3.0]), np.zeros(3), "f")


@pytest.mark.parametrize("share", [0.02, 0.2])
@pytest.mark.parametrize("step", [0.0995613, 1.0, 0.86089])
def test_points_left_out_keep_their_places(step, share):
    there = np.random.default_rng(5).random(2001) > share
    there[[0, -1]] = True
    heights, spacing = positions.line(np.round(even(0, step, 2001), 2)[there], np.ones(there.sum()), "f")
    np.testing.assert_array_equal(np.isfinite(heights), there)
    assert spacing == pytest.approx(step, abs=0.01 / 2000)
    once = np.delete(np.arange(11.0), 5)  # also evenly 10/9 apart, if these were rounded
    assert np.isnan(positions.line(once, once, "f")[0]).nonzero()[0].tolist() == [5]


@pytest.mark.parametrize("x", [np.repeat(np.arange(50.0), 2), np.tile(np.arange(50.0), 2)])
def test_two_heights_at_each_place_are_told(x):
    with pytest.raises(InputError, match="several points at one place"):
        positions.line(x, x, "f")


# --- in every reader that takes positions


@pytest.mark.parametrize("digits", DIGITS)
def test_text_of_a_line(tmp_path, digits):
    x, file = even(0.0, 0.0995613, 2001), tmp_path / "a.txt"
    np.savetxt(file, np.c_[x, np.sin(x)], fmt=f"%.{digits}g", delimiter="\t", header="x (um)\tz (um)")
    line = read_surface(file)
    assert line.size == pytest.approx(2000 * 0.0995613e-6, rel=2 * 10.0**-digits + 1e-3)
    np.testing.assert_allclose(line.heights, 1e-6 * np.sin(x), atol=1e-8)
    assert line.shape == (2001,)


@pytest.mark.parametrize("decimal", [".", ","])
def test_both_rails_by_a_trolley_that_prints_hundredths_of_a_millimetre(tmp_path, decimal):
    """15 m; the median of its gaps is 0.86 mm, so that the last point were 20 places off."""
    x = even(0.0, 0.86089, 17424)
    both = np.c_[np.sin(x / 30), np.cos(x / 30)]
    rows = (f"{at:.2f};{left:.3f};{right:.3f}\n".replace(".", decimal) for at, (left, right) in zip(x, both))  # noqa: B905
    file = tmp_path / "rails.csv"
    file.write_text("Distance [mm];Left [µm];Right [µm]\n" + "".join(rows), encoding="utf-8")
    surface = read_surface(file)
    np.testing.assert_allclose(surface.heights, 1e-6 * both, atol=1e-9)
    assert surface.spacing[0] == pytest.approx(0.86089e-3, abs=1e-9)


@pytest.mark.parametrize("digits", DIGITS)
@pytest.mark.parametrize("along_x", [True, False])
def test_text_of_a_map(tmp_path, digits, along_x):
    """With three digits some columns have the same x: their order tells them apart."""
    x, y = even(0.97e-6, 1.9466146e-6, 300), even(0.97e-6, 1.9466146e-6, 12)
    x, y = np.meshgrid(x, y, indexing="xy" if along_x else "ij")
    points, file = np.c_[x.ravel(), y.ravel(), 0.1 * x.ravel() + y.ravel()], tmp_path / "a.xyz"
    np.savetxt(file, points, fmt=f"%.{digits}g", header="x (m) y (m) z (m)")
    surface = read_surface(file)
    assert surface.shape == (300, 12)
    assert surface.spacing == pytest.approx((1.9466146e-6,) * 2, rel=0.01)
    np.testing.assert_allclose(surface.heights, (0.1 * x + y).T if along_x else 0.1 * x + y, rtol=0.01)


def test_points_of_a_map_in_any_order(tmp_path):
    rng, file = np.random.default_rng(1), tmp_path / "a.xyz"
    x, y = (each.ravel() for each in np.meshgrid(even(0, 0.30331, 150), even(2, 0.71717, 40), indexing="ij"))
    some_of_them = rng.permutation(x.size)[: int(0.9 * x.size)]
    np.savetxt(file, np.c_[x, y, 0.1 * x + y][some_of_them], fmt="%.2f", header="x (um) y (um) z (um)")
    with pytest.warns(match="ha(s|ve) no height"):
        surface = read_surface(file)
    assert surface.shape == (150, 40)
    found, expected = surface.heights.ravel(), 1e-6 * (0.1 * x + y)
    there = np.sort(some_of_them)
    np.testing.assert_allclose(found[there], expected[there], atol=6e-9)


@pytest.mark.parametrize("store", [lambda x: np.round(x, 5), np.float32])
def test_coordinates_of_netcdf(tmp_path, store):
    """In m: printed with 0.01 mm, and in single precision, of which a last digit at 30 m is 1.9 µm."""
    file = tmp_path / "a.nc"
    x = 30.0 + even(0.0, 0.0300331e-3, 3000)
    with h5netcdf.File(file, "w") as opened:
        opened.dimensions = {"x": len(x)}
        stored = store(x)
        variable = opened.create_variable("x", ("x",), stored.dtype, data=stored)
        variable.attrs["units"] = "m"
        heights = opened.create_variable("heights", ("x",), float, data=np.sin(np.arange(3000.0)))
        heights.attrs["units"] = "um"
    line = read_surface(file)
    np.testing.assert_allclose(line.heights, 1e-6 * np.sin(np.arange(3000.0)))
    assert line.spacing == pytest.approx(0.0300331e-3, rel=1e-3)


SIGNAL = np.random.default_rng(4).normal(size=4000)


@pytest.mark.parametrize("digits", DIGITS)
@pytest.mark.parametrize(("title", "second"), [("Time (s)", 1.0), ("Zeit [ms];", 1e3), ("t in µs", 1e6)])
def test_times_give_the_sampling_rate(tmp_path, digits, title, second):
    rate, file = 25_600.0, Path(tmp_path, "run.csv")
    times = np.arange(len(SIGNAL)) / rate * second
    rows = [f"{t:.{digits}g};{a:.6f}" for t, a in zip(times, SIGNAL, strict=True)]
    file.write_text("\n".join([f"{title.rstrip(';')};a (m/s^2)", *rows]), encoding="utf-8")
    values, found = read_signal(file)
    np.testing.assert_allclose(values, SIGNAL, atol=1e-6)
    assert found == pytest.approx(rate, rel=2 * 10.0**-digits + 1e-6)


@pytest.mark.parametrize("kind", ["csv", "npy", "npz"])
def test_times_without_a_title_are_seconds(tmp_path, kind):
    both, file = np.c_[np.arange(len(SIGNAL)) / 12e3, SIGNAL], tmp_path / f"run.{kind}"
    if kind == "csv":
        np.savetxt(file, both, fmt="%.6f", delimiter=",")
    else:
        np.save(file, both) if kind == "npy" else np.savez(file, both)
    values, rate = read_signal(file)
    assert len(values) == len(SIGNAL)
    assert rate == pytest.approx(12e3, rel=1e-4)
    with pytest.warns(OutOfRangeWarning, match="rises as times of 12000 Hz do, and 24000 Hz was given"):
        _, rate = read_signal(file, 24e3, column=2)  # without a title, what is given is stronger
    assert rate == 24e3
    assert read_signal(file, 12e6)[1] == 12e6  # of times in ms, say


@pytest.mark.parametrize(("text", "rate", "column", "message"), [
    ("0,1\n1,2\n2,3\n3,5\n", None, 2, 'Give it, as in --rate "12 kHz"'),  # numbers of samples
    ("time (s),a\n0,1\n0.1,2\n0.3,3\n0.35,5\n", None, None, r"times in run.csv: received uneven .*--rate"),
    ("time (s),a\n0,1\n0.1,2\n0.2,3\n0.3,5\n", 12.0, None, "received 12 Hz; allowed: 10 Hz, as its times"),
    ("time (s),a,b\n0,1,2\n0.1,2,3\n0.2,3,5\n", None, None, "one of 1 to 3, of which 1 holds the times"),
    ("time (s),a,b\n0,1,2\n0.1,2,3\n0.2,3,5\n", None, 1, "one of 1 to 3, of which 1 holds the times"),
    ("time (kg),a\n0,1\n0.1,2\n0.2,3\n", None, None, "unit: received 'kg'"),
])  # fmt: skip
def test_times_that_give_no_rate(tmp_path, text, rate, column, message):
    file = tmp_path / "run.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=message):
        read_signal(file, rate, column=column)


@pytest.mark.parametrize("step", [0.0015, 0.0045, 0.0063])
def test_points_finer_than_their_last_digit_stand_one_after_the_other(step):
    """Several share each printed coordinate: as many places as points, not as digits."""
    index, spacing = positions.places(np.round(np.arange(60) * step, 2), "x")
    assert index.tolist() == list(range(60))
    assert spacing == pytest.approx(step, abs=0.01 / 59)
