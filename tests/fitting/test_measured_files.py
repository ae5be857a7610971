"""Tables of what was measured: with a line for each frequency, or a measurement in each line."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.fitting.running import measured_for
from asperity.observables import reading
from asperity.observables.observable import Measured
from asperity.observables.reading import combined, read_measured, read_where, told_repeats
from refusals import refusals

WIDE = """\
section,rail,temperature (C),speed (km/h),direction,100 Hz,125 Hz,160 Hz,200 Hz
B1,left,11,120,vertical,4,5,6,7
B1,right,11,120,vertical,1,5,,7
B1,left,12,120,lateral,3,2,1,1
B2,left,12,90,vertical,9,9,9,9
"""
BANDS = 10.0 ** (0.1 * np.array([20, 21, 22, 23]))


@pytest.fixture
def file(tmp_path):
    def written(text, name="decay_rates.csv"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return written


def test_a_line_is_a_measurement_and_lines_alike_are_one(track, file):
    first, second = measured_for(track, file(WIDE), {"section": "b1"}, None)
    assert [first.what, second.what] == ["vertical decay rate", "lateral decay rate"]
    np.testing.assert_allclose(first.at, BANDS)
    np.testing.assert_allclose(first.values, [2.0, 5.0, 6.0, 7.0])  # geometric means
    assert (first.records, second.records) == (2, 1)
    assert first.conditions == {"speed": pytest.approx(120 / 3.6)}
    # 10 lg 4 apart in one of three bands measured twice, all taken together: over √2, of a mean of two
    of_one = 10.0 * np.log10(4.0) / np.sqrt(2.0)
    expected = of_one / np.sqrt(3.0) / np.sqrt([2.0, 2.0, 1.0, 2.0])
    np.testing.assert_allclose(first.uncertainty, expected)
    assert second.uncertainty is None


def test_in_which_columns_repeats_differ_is_said(track, file):
    """The one speed and the direction keep them apart: of sections, rails and temperatures nothing does."""
    several = WIDE.replace("B2,left,12,90", "B2,left,12,120") + "B2,right,,120,vertical,8,8,8,8\n"
    vertical, lateral = measured_for(track, file(several), {}, None)
    assert vertical.records == 4
    assert vertical.differing == {
        "section": ("B1", "B2"),
        "rail": ("left", "right"),
        "temperature (C)": ("11", "12", ""),
    }
    assert told_repeats(vertical) == (
        "4 measurements of the vertical decay rate in decay_rates.csv are taken as repeats of one, though "
        "they differ in section (B1, B2), rail (left, right) and temperature (11, 12, …): choose some of "
        "them, as with --where section=B1."
    )
    assert told_repeats(lateral) == ""
    (chosen,) = measured_for(track, file(several), {"section": "B1", "direction": "vertical"}, None)
    assert chosen.differing == {"rail": ("left", "right")}


def test_what_each_repeat_has_for_itself_is_named_where_nothing_else_differs():
    said = {
        "date": ("1 May", "2 May", "3 May"),
        "the make": ("", "Soft pads", "Stiff pads"),
        "level (dB)": ("1", "2", "3"),
    }
    of = Measured("mobility", [1.0], [1.0], source="a.csv", records=4, labels={"a": ("x",), **said})
    assert of.differing == said
    alone = replace(of, records=3, labels=said | {"rail": ("left", "right")})
    assert alone.differing == {"rail": ("left", "right")}
    assert replace(of, records=3, labels=said).differing == said
    many = replace(of, labels={f"c{n}": ("one", "two") for n in range(6)})
    assert "c2 (one, two), c3 (one, two) and 2 more columns: choose" in told_repeats(many)
    damper = replace(of, labels={"the make": ("", "Soft pads")})
    assert "in the make (nothing, Soft pads): choose" in told_repeats(damper)
    assert told_repeats(damper).endswith("as with --where 'the make=Soft pads'.")


def test_scatter_is_taken_over_as_few_neighbours_as_tell_it():
    """Of many repeats over one on either side, of two over three; both as the squares over their freedom."""
    square = np.arange(1.0, 10.0) ** 2
    often = reading._pooled(square, np.full(9, 8))
    np.testing.assert_allclose(often[1:-1] ** 2, (square[:-2] + square[1:-1] + square[2:]) / 21.0)
    twice = reading._pooled(square, np.full(9, 2))
    np.testing.assert_allclose(twice[4] ** 2, square[1:8].sum() / 7.0)
    np.testing.assert_allclose(twice[0] ** 2, square[:4].sum() / 4.0)


def test_columns_choose_lines(track, file):
    path = file(WIDE)
    found = measured_for(track, [path], {"temperature": "12", "direction": "vertical, lateral"}, None)
    assert [each.values[0] for each in found] == [3.0, 9.0]
    conditions = [each.conditions["speed"] for each in found]
    assert conditions == pytest.approx([120 / 3.6, 25.0])


def test_each_rail_of_a_table_is_a_repeat(track, tmp_path):
    """Their difference is the scatter, whether their columns say the direction or the rails alone."""
    for heading in ("left (dB/m), right (dB/m)", "vertical left (dB/m), vertical right (dB/m)"):
        (tmp_path / "rates.csv").write_text(f"f (Hz), {heading}\n100, 4, 9\n125, 4, 4\n160, 9, 4\n")
        (found,) = measured_for(track, tmp_path / "rates.csv", {}, None)
        assert (found.what, found.records) == ("vertical decay rate", 2)
        np.testing.assert_allclose(found.values, [6.0, 4.0, 6.0])
        assert found.uncertainty is not None


@pytest.mark.parametrize("units", [" Hz", ""])
def test_a_direction_may_stand_before_its_line_and_bands_without_a_unit(track, tmp_path, units):
    """As tables of EN 15461 often are: no column is called direction, centres are numbers alone."""
    path = tmp_path / "decay_rates.csv"
    for begin in ("f in Hz", ""):
        bands = "".join(f";{each}{units}" for each in ("800", "1000", "1250", "1600"))
        path.write_text(f"EN 15461, dB/m\n{begin}{bands}\nVertical;4;3;2;1,5\nLateral;1;0,8;0,6;0,5\n")
        vertical, lateral = measured_for(track, path, {}, None)
        assert (vertical.what, lateral.what) == ("vertical decay rate", "lateral decay rate")
        assert vertical.at == pytest.approx(10.0 ** np.array([2.9, 3.0, 3.1, 3.2]))
        assert (vertical.values[-1], lateral.values[1], vertical.records) == (1.5, 0.8, 1)


def test_a_column_that_is_called_direction_counts_before_others(track, tmp_path):
    path = tmp_path / "decay_rates.csv"
    path.write_text("sensor,direction,800,1000,1250,1600\nvertical,lateral,4,3,2,1\n")
    (found,) = measured_for(track, path, {}, None)
    assert found.what == "lateral decay rate"


@pytest.mark.parametrize(
    "bands", ["800;1000;1600;2000", "800;1000;1200;1600", "1600;1250;1000;800", "-1;0;1;2"]
)
def test_numbers_that_are_no_bands_one_after_the_other_head_no_table(track, tmp_path, bands):
    path = tmp_path / "decay_rates.csv"
    path.write_text(f"rail;{bands}\nleft;4;3;2;1\n")
    with pytest.raises(InputError, match=r"the columns frequency \(Hz\), vertical decay rate"):
        measured_for(track, path, {}, None)


def test_a_line_is_a_frequency(track, file):
    both = "frequency (Hz), vertical (dB/m), lateral (dB/m)\n100, 5, 7\n125, 6, 8\n160, 6, 9\n"
    found = measured_for(track, file(both, "track.csv"), {}, None)
    assert [each.what for each in found] == ["vertical decay rate", "lateral decay rate"]
    accelerance = "frequency (Hz), accelerance (m/s^2/N)\n" + "".join(f"{f}, 1e-3\n" for f in (100, 200, 400))
    (found,) = measured_for(track, file(accelerance, "hammer.csv"), {}, None)
    assert found.what == "mobility"
    np.testing.assert_allclose(found.values, 1e-3 / (2.0 * np.pi * found.at))


def test_transfer_mobilities_are_one_for_each_pair_of_places(track, file):
    lines = [f"{f}, {x}, 0.3, 1e-9, -2e-9" for x in (0.3, 0.9) for f in (100, 200, 400)]
    heading = "frequency (Hz), response at (m), force at (m), real (m/N), imaginary (m/N)\n"
    found = measured_for(track, file(heading + "\n".join(lines), "transfer.csv"), {}, None)
    assert [each.places for each in found] == [(0.3, 0.3), (0.9, 0.3)]
    np.testing.assert_allclose(found[1].values, 2j * np.pi * found[1].at * (1e-9 - 2e-9j))


def test_several_files_are_measurements_of_one(track, file):
    texts = (f"frequency (Hz), decay rate (dB/m)\n100, {a}\n125, 6\n160, 6\n" for a in (4, 9))
    (found,) = measured_for(track, [file(text, f"{n}.csv") for n, text in enumerate(texts)], {}, None)
    assert found.values[0] == pytest.approx(6.0)
    assert (found.records, found.source) == (2, "0.csv, 1.csv")


def test_repeated_levels_have_their_mean_and_complex_ones_theirs():
    at = [100.0, 200.0]
    pair = [Measured("mobility", at, [1e-3j, 4e-3]), Measured("mobility", at, [4e-3j, 1e-3])]
    (found,) = combined(pair)
    np.testing.assert_allclose(found.values, [2e-3j, 2e-3])


NIEDERWANGEN = Path(__file__).parents[2] / "../shared/data/niederwangen/decay_rates.csv"


@pytest.mark.skipif(not NIEDERWANGEN.exists(), reason="needs the measured railway beside the checkout")
def test_a_table_of_a_measured_railway_is_read_as_it_is(track):
    where = read_where(["section=B5", "damper=none", "direction=vertical"])
    (found,) = measured_for(track, NIEDERWANGEN, where, None)
    assert len(found.at) == 18
    assert 0.5 < found.values.min() < found.values.max() < 40.0


def test_a_case_names_what_was_measured(track, file):
    rates = np.array([[100.0, 5.0], [125.0, 6.0], [160.0, 7.0]])
    named = track.with_(**{"track.decay_rates": rates})
    (found,) = measured_for(named, None, {}, None)
    assert (found.what, found.values.tolist()) == ("vertical decay rate", [5.0, 6.0, 7.0])


test_it_says_what_is_wrong = refusals(
    (WIDE, {"section": "B9"}, "no line where section=B9; allowed: section: B1, B2"),
    (WIDE, {"part": "B1"}, "where: received the column 'part'; allowed: a column of a file: section, rail"),
    (WIDE, {"sections": "B1"}, 'Did you mean "section"?'),
    (WIDE.replace(",7\n", ",x\n", 1), {}, "received 'x' below 200 Hz; allowed: a number, or nothing"),
    (WIDE.replace("4,5,6,7", "0,5,6,7"), {}, "a vertical decay rate of 0; allowed: greater than 0"),
    (WIDE.replace("200 Hz", "220 Hz"), {}, "a column of 220 Hz; allowed: centres of one-third octaves"),
    (WIDE.replace("lateral", "up"), {}, "direction in decay_rates.csv: received 'up'; allowed: one of ver"),
    ("frequency (Hz),decay rate (dB/m)\n100,0,04\n", {}, "commas in numbers and between them"),
    ("frequency (Hz), a\n100, 1\n", {"section": "B1"}, "decay_rates.csv: received the heading"),
    ("frequency (Hz), decay rate (dB/m)\n100, 4\n125, 6\n160, 6\n", {"section": "B1"},
     "the column 'section'; allowed: a file with a measurement in each line"),
    of=lambda text, where, track, file: measured_for(track, file(text), where, None),
)  # fmt: skip


def test_what_no_heading_tells_has_to_be_said(track, file):
    path = file("x (m), y (kg)\n1, 2\n", "table.csv")
    with pytest.raises(
        InputError, match="a heading that does not tell what was measured; allowed: a table of"
    ):
        read_measured(track, path, {}, None)
    rates = file(WIDE, "table.csv")
    assert len(read_measured(track, rates, {}, "vertical decay rate")[0]) == 4


test_a_choice_of_lines_is_checked = refusals(
    (["section"], "where: received 'section'; allowed: a column and what it holds, as section=B5"),
    (["a=1", "a=2"], "where: received 'a=2'; allowed: each column once. Write a=one,other."),
    of=read_where,
)
