"""Tables of what was measured on a track: read as people write them, or refused with what is wrong."""

import numpy as np
import pytest
from case_texts import refusal_of_table, write_files

from asperity import WheelOnRail
from asperity.case.measured import read_band_levels, read_decay_rates, read_mobility, read_passage

RATES = "frequency (Hz), decay rate (dB/m)\n"
MOBILITY = "frequency (Hz), mobility ((m/s)/N)\n"
COMPLEX = "f (Hz), real (m/s/N), imaginary (m/s/N)\n"
READ = {
    "rates": (read_decay_rates, '[track] decay_rates = "rates.csv"', "track.decay_rates"),
    "passage": (read_passage, '[noise] measured_passage = "passage.csv"', "noise.measured_passage"),
    "bands": (read_band_levels, '[noise] measured_bands = "bands.csv"', "noise.measured_bands"),
    "mobility": (read_mobility, '[track] mobility = "mobility.csv"', "track.mobility"),
}


@pytest.fixture
def source(tmp_path):
    return write_files(tmp_path)


def test_decay_rates_are_read_with_and_without_those_sideways(source):
    centres, vertical, lateral = read_decay_rates(source.parent / "rates.csv")
    np.testing.assert_allclose(centres, 10.0 ** np.array([2.0, 2.1, 2.3]))  # 125 and 200 Hz are nominal
    assert (list(vertical), list(lateral)) == ([4.5, 4.0, 5.0], [0.5, 0.5, 0.4])
    table = np.array([[3150.0, 2.0], [4000.0, 2.1], [5000.0, 2.2]])
    centres, vertical, lateral = read_decay_rates(WheelOnRail(
        surface={"spectrum": "iso3095"}, track={"decay_rates": table}).track.decay_rates)  # fmt: skip
    np.testing.assert_allclose(centres, 10.0 ** np.array([3.5, 3.6, 3.7]))
    assert (list(vertical), lateral) == ([2.0, 2.1, 2.2], None)


OMEGA = 2.0 * np.pi * np.array([100.0, 200.0, 400.0])
TRUE = np.array([2e-5 + 1e-5j, 1e-5 - 2e-5j, 3e-5 + 0j])


@pytest.mark.parametrize(
    ("unit", "numbers"),
    [
        ("(m/s)/N", TRUE),
        ("m/(N s)", TRUE),
        ("m/(Ns)", TRUE),
        ("mm/s/kN", 1e6 * TRUE),
        ("m/s^2/N", 1j * OMEGA * TRUE),
        ("(m/s²)/N", 1j * OMEGA * TRUE),
        ("m/N", TRUE / (1j * OMEGA)),
        ("m/kN", 1e3 * TRUE / (1j * OMEGA)),
    ],
)
def test_a_mobility_is_read_in_its_three_forms(unit, numbers, tmp_path):
    rows = zip((100, 200, 400), numbers, strict=True)
    text = "".join(f"{f}; {y.real:.12g}; {y.imag:.12g}\n" for f, y in rows)
    (tmp_path / "y.csv").write_text(f"f (Hz); real [{unit}]; imaginary [{unit}]\n{text}", encoding="utf-8")
    np.testing.assert_allclose(read_mobility(tmp_path / "y.csv")[1], TRUE, rtol=1e-9)
    rows = zip((100, 200, 400), np.abs(numbers), strict=True)
    text = f"f (Hz)\tsize [{unit}]\n" + "".join(f"{f}\t{size:.12g}\n" for f, size in rows)
    (tmp_path / "size.txt").write_text(text, encoding="utf-8")
    np.testing.assert_allclose(read_mobility(tmp_path / "size.txt")[1], np.abs(TRUE), rtol=1e-9)


@pytest.mark.parametrize("unit", ["dB(A)", "dB", "dBA", "dB(A) re 20 µPa"])
def test_the_level_of_a_passage_is_read(unit, tmp_path):
    text = f"t (s); L ({unit})\n" + "".join(f"{n / 10}; {90 - (n - 20) ** 2 / 8}\n" for n in range(40))
    (tmp_path / "passage.csv").write_text(text.replace(".", ","), encoding="utf-8")
    time, level = read_passage(tmp_path / "passage.csv")
    np.testing.assert_allclose(time, np.arange(40) / 10)
    assert (level.max(), level[0]) == (90.0, 40.0)


def test_bands_are_read_without_weighting(tmp_path):
    for unit, at_200 in (("dB", 60.0), ("dB(A)", 60.0 + 10.8)):  # IEC 61672-1: −10.9 dB at 200 Hz nominal
        (tmp_path / "bands.csv").write_text(f"f (kHz), L ({unit})\n0.2, 60\n1, 70\n5, 50\n")
        centres, level = read_band_levels(tmp_path / "bands.csv")
        np.testing.assert_allclose(centres, 10.0 ** np.array([2.3, 3.0, 3.7]))
        assert level[0] == pytest.approx(at_200, abs=0.11)
        assert level[1] == pytest.approx(70.0, abs=0.01)


PASSAGE = "time (s), level (dB(A))\n" + "".join(f"{n}, {60 + 5 * min(n, 11 - n)}\n" for n in range(12))


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("rates", RATES + "100, 4\n125, 5\n", "2 frequencies; allowed: at least 3"),
        ("rates", RATES + "100, 4\n125, -5\n160, 4", "a decay rate of -5 dB/m; allowed: 0.01 to 200 dB/m"),
        ("rates", RATES + "100, 4\n125, 0\n160, 4", "a decay rate of 0 dB/m"),
        ("rates", RATES + "100, 400\n125, 500\n160, 4", "a decay rate of 400 dB/m; allowed: 0.01"),
        ("rates", RATES + "100, 4\n160, 5\n125, 4", "frequencies that do not rise"),
        ("rates", RATES + "100, 4\n125, 5\n126, 4", "twice the band of 126 Hz; allowed: centres"),
        ("rates", RATES + "100, 4\n110, 5\n120, 4", "a frequency of 110 Hz; allowed: centres of"),
        ("rates", "f (Hz), rate (dB/km)\n100, 4\n", "the heading 'rate (dB/km)'; allowed: vertical decay"),
        ("rates", "f (Hz), rate\n100, 4\n", "the heading 'f (Hz), rate'; allowed: a heading with the units"),
        ("rates", "f (Hz), lateral (dB/m), vertical (dB/m)\n100, 1, 4\n", "'lateral (dB/m)' for the vert"),
        ("mobility", MOBILITY + "100, 1e-5\n200, 1e-5\n", "2 frequencies; allowed: at least 3"),
        ("mobility", MOBILITY + "100, 1e-5\n90, 1e-5\n300, 1", "frequencies that do not rise"),
        ("mobility", MOBILITY + "100, 1e-5\n200, -1e-5\n300, 1e-5", "a mobility of -1e-05 (m/s)/N"),
        ("mobility", MOBILITY + "100, 15\n200, 12\n300, 9", "a mobility of 15 (m/s)/N; allowed: 1e-09 to"),
        ("mobility", "f (Hz), size (kg)\n100, 1\n", "'size (kg)'; allowed: magnitude or real part in"),
        ("mobility", COMPLEX + "100, -1e-5, 0\n200, 1e-5, 0\n300, 1e-5, 0", "power to the hammer at 100 Hz"),
        ("mobility", COMPLEX + "100, 1e-5\n", "'100, 1e-5' in line 2; allowed: a table with the columns"),
        ("passage", PASSAGE[:-20], "9 instants; allowed: at least 10"),
        ("passage", PASSAGE.replace("11, 60", "10, 60"), "times that do not rise; allowed: rising times"),
        ("passage", PASSAGE + "12, 76", "begins at 60.0 and ends at 76.0 dB(A); allowed: one that begins"),
        ("passage", PASSAGE + "12, 1e3", "a level of 1e+03 dB re 20 uPa; allowed: -20 to 180 dB"),
        ("passage", "time (s), p (Pa)\n0, 1\n", "the heading 'p (Pa)'; allowed: level in dB(A)"),
        ("bands", "f (Hz), L (dB)\n100, 60\n200, 70", "2 frequencies; allowed: at least 3"),
        ("bands", "f (Hz), L (dB)\n100, 60\n200, 70\n201, 60", "twice the band of 201 Hz"),
        ("bands", "t (s), L (dB)\n1, 60\n2, 70\n3, 60", "the heading 't (s)'; allowed: frequency in Hz"),
    ],
)  # fmt: skip
def test_tables_that_are_wrong(name, text, message, source):
    """By themselves, and as the key of a case that names them."""
    told, of_case = refusal_of_table(*READ[name], source.parent / f"{name}.csv", text)
    assert message in told
    assert message.partition(";")[0] in of_case
