"""``asperity surface``: what is in a measured file, in words, numbers and pictures."""

import csv
import importlib
import json
import re
import subprocess
import sys
import tracemalloc
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from asperity.surfaces.readers import read_surface
from command_line import call, words_of
from memory_of_files import single_digits, times_of_file

HINTS = ("--height-unit", "um", "--pixel", "2 um")


@pytest.fixture(autouse=True)
def drawn(monkeypatch):
    """Titles and names of pictures, which are not drawn here."""
    found = []
    module = importlib.import_module("asperity.cli.surface")
    monkeypatch.setattr(module, "write_chart", lambda chart, title, path: found.append((title, path)))
    return found


def noise(*shape):
    return np.random.default_rng(0).normal(size=shape)


def surface(heights, *words, name="map.npy"):
    """What is said of heights, in micrometres and 2 µm apart."""
    np.save(name, heights)
    return call("surface", name, *HINTS, *words)


def column(path, title):
    with open(path, encoding="utf-8", newline="") as file:
        found = [row[title] for row in csv.DictReader(file)]
    return np.array([float(value) for value in found if value])


@pytest.mark.parametrize(
    ("words", "picture", "title", "message"),
    [
        ("a", "maps-a-surface.png", "maps.npz, a, the first of 3 maps", "maps.npz, a: 3 maps, each 40 × 32 "
         "points, 0.08 × 0.064 mm, 2 × 2 µm apart, all with a height"),
        ("a --transpose -o a.svg", "a.svg", "maps.npz, a, the first of 3 maps", "3 maps, each 32 × 40"),
        ("a --index 2", "maps-a-2-surface.png", "maps.npz, a, map 2", "a map of 40 × 32 points"),
        ("a --index 0 --lines", "maps-a-0-surface.png", "maps.npz, a, map 0",
         "32 parallel lines, each of 40 points, 0.08 mm"),
        ("b", "maps-b-surface.png", "maps.npz, b", "a plane has no texture to be tested"),
    ],
)  # fmt: skip
def test_an_array_has_words_and_a_picture_of_its_own(words, picture, title, message, drawn):
    np.savez("maps.npz", a=noise(3, 40, 32), b=np.ones((30, 30)).cumsum(0))
    said = words_of(call("surface", "maps.npz", *HINTS, "--array", *words.split()).stdout)
    assert message in said
    assert re.search(r"wavelengths 4 µm to 0.0\d+ mm.*?: [SR]q ", said)
    assert drawn == [(title, Path(picture))]


def test_missing_points_are_said_and_filled_by_an_option():
    heights = noise(300)
    heights[5] = np.nan
    told = surface(heights)
    assert "a line of 300 points, 0.6 mm, 2 µm apart, 0.33 % without a height" in told.stdout
    assert "Rq" in told.stdout
    assert "--fill interpolates them" in told.stderr
    assert "all with a height" in surface(heights, "--fill").stdout


def test_coordinates_may_be_given_their_unit():
    Path("plain.txt").write_text("".join(f"{x} {x % 3}\n" for x in range(20)))
    read = call("surface", "plain.txt", "--height-unit", "um", "--pixel-unit", "mm")
    assert "a line of 20 points, 20 mm" in read.stdout


def test_lines_measured_side_by_side_are_no_map():
    lines = noise(3, 900) * [[2.0], [4.0], [6.0]]
    lines[1, 850:] = np.nan
    shown = surface(lines).stdout
    assert "map.npy: 3 parallel lines, each of 900 points, 1.8 mm, 2 µm apart, 1.9 % without" in shown
    assert "--map takes it for a map" in shown
    assert "wavelengths 4 µm to 1.8 mm" in shown
    measured = re.search(r"Rq +([\d.]+) µm  rms height \(([\d.]+) µm to ([\d.]+) µm\)", shown)
    assert [float(number) for number in measured.groups()] == pytest.approx([4.0, 2.0, 6.0], rel=0.05)
    assert "Sal" not in shown
    assert "--map" not in surface(lines, "--lines").stdout
    three = call("surface", "map.npy", "--height-unit", "nm", "--pixel", "2 um", "--map").stdout
    assert "a map of 3 × 900 points" in three


def test_spectra_of_a_surface_are_written():
    """The PSD of a wave of amplitude A has its peak at 1/λ and the integral A²/2."""
    x = 2.0 * np.arange(200)
    wave = np.tile(2.0 * np.sin(2 * np.pi * x / 50.0)[:, None], (1, 120))
    assert str(Path("map-psd.csv").resolve()) in surface(wave, "--psd", "--map").stdout
    wavenumber = column("map-psd.csv", "wavenumber along x [1/m]")
    density = column("map-psd.csv", "PSD along x [m³]")
    assert wavenumber[density.argmax()] == pytest.approx(1 / 50e-6)
    assert density.sum() * wavenumber[0] == pytest.approx(0.5 * (2e-6) ** 2, rel=1e-3)
    across = column("map-psd.csv", "PSD along y [m³]")
    assert across[2:].max() < 1e-12 * density.max()  # each line across is level, at a height of its own


@pytest.mark.parametrize(("angle", "std"), [("90 deg", 90), ("0.5235987756 rad", 150)])
def test_a_map_is_turned(angle, std):
    """What varies along x varies at 180° less the angle of the direction in which it is rolled over."""
    ridges = np.tile(np.repeat(noise(60), 3)[:, None], (1, 140))
    said = surface(ridges, "--map", "--direction", angle).stdout
    assert abs(int(re.search(r"Std +(\d+)°", said)[1]) - std) <= 2
    if angle == "90 deg":
        assert "a map of 140 × 180 points" in said


def test_it_says_whether_a_map_is_the_same_everywhere_and_which_way_it_runs():
    rng = np.random.default_rng(3)
    ridges = np.repeat(rng.normal(size=64), 2)[:, None] + 0.5 * rng.normal(size=(128, 128))
    even = surface(ridges).stdout
    direction = int(re.search(r"Std +(\d+)°  direction from x", even)[1])
    assert min(direction, 180 - direction) <= 2
    assert "the same everywhere, as far as chance tells" in even
    trend = surface(ridges * np.linspace(0.3, 2.0, 128)).stdout
    assert "(p = 0.025): not the same everywhere" in trend
    ridges[3:20, 4:90] = np.nan
    hole = surface(ridges).stdout
    assert re.search(r"Std +–", hole)
    words = "Homogeneity, Std and spectra are those of a map with at least 95% of its points: --fill"
    assert words in hole


def test_a_few_spikes_take_no_spectrum_away():
    """Three spikes of 16,384 points: direction, homogeneity and spectra are those of what lies between."""
    wave = np.sin(2 * np.pi * np.arange(128) / 16.0)[:, None] + 0.5 * noise(128, 128)
    wave[[30, 60, 90], [70, 20, 110]] = 300.0
    said = surface(1e-3 * wave, "--spikes", "--psd").stdout
    assert re.search(r"Std +(0|1|179|180)°", said)
    assert "are those of the map with its missing points, 0.00018 of all, interpolated" in said
    wavenumber = column("map-psd.csv", "wavenumber along x [1/m]")
    density = column("map-psd.csv", "PSD along x [m³]")
    assert wavenumber[density.argmax()] == pytest.approx(1 / 32e-6)
    assert density.sum() * wavenumber[0] == pytest.approx(0.5e-18 + 0.25e-18, rel=0.05)


def test_lines_of_a_rail_are_held_against_the_limit_of_its_roughness():
    """A corrugation of 10 µm has 10 lg 50 = 17.0 dB in its band, where the limit is −5.6."""
    x = np.arange(4000) * 1e-3
    lines = np.array([10.0 * np.sin(2 * np.pi * x / 25e-3 + phase) for phase in (0.0, 1.0, 2.0)])
    lines += 0.02 * noise(*lines.shape)
    lines[1, 3000:] = np.nan  # a short line stays out of it
    np.save("rail.npy", lines)
    rail = ["surface", "rail.npy", "--height-unit", "um", "--pixel", "1 mm"]
    said = call(*rail).stdout
    measured = dict(re.findall(r"^ +([\d.]+) mm +-?[\d.]+ +(-?[\d.]+ +\w+)", said, re.MULTILINE))
    assert len(measured) == 22
    assert measured["25"].split() == ["17.0", "FAIL"]
    assert [band for band, each in measured.items() if each.endswith("FAIL")] == ["25"]
    document = json.loads(call(*rail, "--json").stdout)["third_octaves"]
    assert document["limit"][0] == 17.1
    assert document["wavelength"][0] == pytest.approx(0.4, rel=0.01)
    assert "ISO 3095" not in surface(lines[0]).stdout  # it is too short for its bands


def test_scale_and_slope_are_told_and_a_wrong_unit_is_refused_with_its_cause():
    said = words_of(surface(noise(40, 32)).stdout)
    assert re.search(r"Slopes from point to point: 0\.\d+ \(3\d°\)\. Waves of 0\.08 mm to 4 µm pass", said)
    assert "with 12.5 kHz to 250 kHz at 1 m/s" in said
    np.save("rail.npy", 1e-6 * noise(2000))
    said = words_of(call("surface", "rail.npy", "--height-unit", "m", "--pixel", "1 mm").stdout)
    assert "Waves of 2 m to 2 mm pass with 13.9 Hz to 13.9 kHz at 100 km/h" in said
    refused = call("surface", "map.npy", "--height-unit", "m", "--pixel", "2 um", code=2).stderr
    assert "Were they in µm" in words_of(refused)
    assert "Give --height-unit um." in words_of(refused)


@pytest.mark.parametrize(("shape", "told"), [
    ((3, 10), "No Sdq and no Sdr: slopes by ISO 4287 take 7 points in a row."),
    ((40, 6), "No Sdq and no Sdr: slopes"),
    ((6,), "No Rdq: slopes by ISO 4287 take 7 points in a row."),
])  # fmt: skip
def test_small_maps_and_lines_have_all_statistics_but_slopes(shape, told):
    heights = 1e-2 * noise(*shape)
    out = words_of(surface(heights, *["--map"] * (len(shape) == 2)).stdout)
    assert told in out
    assert re.search(r"[SR]q +0\.0\d+ µm +rms height", out)
    assert re.search(r"[SR]dq +– +rms slope", out)


def test_a_column_of_single_digits_takes_five_times_its_file(monkeypatch):
    """Eight bytes a number as its height, and two beside it, whatever is evaluated: what the larger of two
    files takes more than the other."""
    for module in ("levelling", "statistics", "measured_lines"):
        name = "TOGETHER" if module == "measured_lines" else "PIECE"
        monkeypatch.setattr(f"asperity.surfaces.{module}.{name}", 2**14)
    monkeypatch.setattr("asperity.ranks.TOGETHER", 2**14)
    monkeypatch.setattr("asperity.surfaces.readers.belief.MOST_POINTS", 2**12)
    monkeypatch.setattr("asperity.spectra.LONGEST_SEGMENT", 2**14)
    monkeypatch.setattr("asperity.spectra.ROUND", 2**8)
    module = importlib.import_module("asperity.cli.surface")
    file = Path("column.txt")
    show = partial(module.show_surface, file, Path("a.png"), height_unit="nm", pixel="1 um")
    assert times_of_file(file, single_digits, show, shorter=200_000) < 5.0


def test_lines_are_gone_when_they_are_drawn(monkeypatch):
    """What draws takes as much memory as four million heights."""
    module = importlib.import_module("asperity.cli.surface")
    held = []
    monkeypatch.setattr(module, "write_chart", lambda *_: held.append(tracemalloc.get_traced_memory()[0]))
    count = 50_000
    single_digits(Path("column.txt"), np.arange(count))
    for psd in (False, False, True):  # the first for imports
        tracemalloc.start()
        try:
            module.show_surface(Path("column.txt"), Path("a.png"), psd=psd, height_unit="nm", pixel="1 um")
        finally:
            tracemalloc.stop()
    assert held[1] < 0.25 * 8 * count
    assert held[2] > held[1] + 0.9 * 8 * count  # the spectrum, where it is written to a file


@pytest.mark.parametrize("columns", [1, 4])
def test_columns_of_short_numbers_take_few_times_the_memory_of_their_heights(columns, monkeypatch):
    """Beside what it was read from: as many arrays, whatever its length, as the largest spectrum needs."""
    for module in ("levelling", "statistics"):
        monkeypatch.setattr(f"asperity.surfaces.{module}.PIECE", 2**12)
    monkeypatch.setattr("asperity.surfaces.measured_lines.TOGETHER", 2**12)
    monkeypatch.setattr("asperity.ranks.TOGETHER", 2**12)
    monkeypatch.setattr("asperity.surfaces.readers.belief.MOST_POINTS", 2**12)
    monkeypatch.setattr("asperity.spectra.LONGEST_SEGMENT", 2**16)
    monkeypatch.setattr("asperity.spectra.ROUND", 2**8)
    points = 200_000
    digits = np.random.default_rng(0).integers(0, 10, (points // columns, columns))
    module = importlib.import_module("asperity.cli.surface")
    np.savetxt("column.txt", digits[:2_000], "%d")
    module.show_surface(Path("column.txt"), Path("a.png"), height_unit="nm", pixel="1 um")  # imports
    np.savetxt("column.txt", digits, "%d")
    tracemalloc.start()
    try:
        module.show_surface(Path("column.txt"), Path("a.png"), height_unit="nm", pixel="1 um")
        assert tracemalloc.get_traced_memory()[1] < 4.05 * 8 * points
    finally:
        tracemalloc.stop()


READING = """
from functools import partial
from pathlib import Path
from asperity.surfaces.readers import read_surface
peaks = []
for name in ("few.txt", "many.txt"):
    surface = read_surface(name, height_unit="nm", pixel="1 um")
    _, _, largest = Path("/proc/self/status").read_text().partition("VmHWM:")
    peaks.append(1024 * int(largest.split()[0]))
print((peaks[1] - peaks[0]) / surface.heights.nbytes)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the largest size of a process is told elsewhere")
@pytest.mark.parametrize("columns", [1, 4])
def test_numbers_of_a_text_are_never_held_twice(columns):
    """Neither as they were written nor in another unit; beside them stands the text, a quarter of them."""
    digits = np.random.default_rng(0).integers(0, 10, (4_000_000 // columns, columns))
    written = np.full((*digits.shape, 2), ord(" "), np.uint8)
    written[..., 0] = ord("0") + digits
    written[:, -1, 1] = ord("\n")
    Path("many.txt").write_bytes(written.tobytes())
    Path("few.txt").write_bytes(written[:20_000].tobytes())
    few = read_surface("few.txt", height_unit="nm", pixel="1 um").heights
    np.testing.assert_array_equal(few.reshape(-1, columns), 1e-9 * digits[:20_000])
    told = subprocess.run([sys.executable, "-c", READING], capture_output=True, text=True, check=True)
    assert float(told.stdout) < 2.5


@pytest.mark.parametrize(("titles", "told"), [
    ("x (mm);z (um);Intensity;Quality", "'x (mm)', 'z (um)', without 'Intensity', 'Quality'"),
    ("Intensity;x (mm);Quality;Height (um)", "'x (mm)', 'Height (um)', without 'Intensity', 'Quality'"),
    ("valid;x (mm);a;z (um)", "'x (mm)', 'valid', 'z (um)', without 'a'"),
])  # fmt: skip
def test_columns_that_are_left_out_are_named(titles, told):
    place, height = (
        next(n for n, each in enumerate(titles.split(";")) if unit in each) for unit in ("mm", "um")
    )
    rows = np.ones((40, 4))
    rows[:, place] = 1e-3 * np.arange(40)
    rows[:, height] = np.round(noise(40), 4)
    text = "\n".join([titles, *(";".join(f"{cell:g}" for cell in row) for row in rows)])
    Path("a.csv").write_text(text)
    said = call("surface", "a.csv").stdout
    assert "a.csv: a line of 40 points, 40 µm" in said
    assert f"Columns taken: {told}." in said
    Path("a.csv").write_text("x (mm);z (um)\n0;1\n1e-3;2\n2e-3;1.5\n")
    assert "Columns" not in call("surface", "a.csv").stdout
