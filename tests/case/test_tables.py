"""Tables that a case names: read in SI as text or array, or refused with what is wrong and where."""

import math
import re

import numpy as np
import pytest
from case_texts import refusal_of_table

from asperity import WheelOnRail
from asperity.case import measured, tables
from asperity.errors import CaseError, InputError
from refusals import refusals

LEVELS = "wavelength (m), level (dB)\n"
ASKED = "a heading with the units in brackets. Add the line 'wavelength (m), level (dB)' above the numbers"
MODES = "frequency (Hz), damping ratio, modal mass (kg)\n"
SHAPES = MODES.replace("\n", ", diameters, axial, radial\n")
RATIOS = "frequency (Hz), ratio\n"
RECEPTANCE = "f (Hz), real (m/N), imaginary (m/N)\n"
RATES = "frequency (Hz), decay rate (dB/m)\n"
MOBILITY = "frequency (Hz), mobility ((m/s)/N)\n"
PAD = "f (Hz), real part (MN/m), imaginary part (MN/m)\n"
BY_LOSS = "f (Hz); dynamic stiffness (kN/mm); loss factor; preload (kN)\n"
COMPLEX = "f (Hz), real (m/s/N), imaginary (m/s/N)\n"
TWELVE = "".join(f"{n}, 1, 1\n" for n in range(1, 13))
READ = {
    "levels": (tables.read_levels, '[surface] spectrum = "levels.csv"', "surface.spectrum"),
    "modes": (lambda path: tables.read_mode_table(path).T, '[wheel] modes = "modes.csv"', "wheel.modes"),
    "ratios": (tables.read_ratios, '[noise] rail_radiation = "ratios.csv"', "noise.rail_radiation"),
    "receptance": (tables.read_receptance, '[wheel] receptance = "receptance.csv"', "wheel.receptance"),
    "rates": (measured.read_decay_rates, '[track] decay_rates = "rates.csv"', "track.decay_rates"),
    "bands": (measured.read_band_levels, '[noise] measured_bands = "bands.csv"', "noise.measured_bands"),
    "pad": (tables.read_dynamic_stiffness, '[track] pad_table = "pad.csv"', "track.pad_table"),
    "mobility": (measured.read_mobility, '[track] mobility = "mobility.csv"', "track.mobility"),
}


@pytest.mark.parametrize(("name", "expected"), [
    ("levels", ([0.1, 0.08, 0.063, 0.05], [3, 2, 1, 0])),
    ("modes", ([2000, 3100], [1e-4, 1e-4], [300, 250])),
    ("ratios", ([100, 1000], [0.01, 0.8])),
    ("receptance", (100.0 * np.arange(1, 30), [-1e-9 / n - 1e-11j for n in range(1, 30)])),
])  # fmt: skip
def test_they_are_read_in_si(name, expected, source):
    for found, wanted in zip(READ[name][0](source.parent / f"{name}.csv"), expected, strict=True):
        np.testing.assert_allclose(found, wanted, rtol=1e-2 if name == "receptance" else 1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "wavelength (m), level (dB)\n0.08 2\n0.1 3\n",
        "measured [mm],of [dB re 1 um]\n100,3\n80,2\n",
        "# lathe 3\n# wavelength (m); level (dB)\n0,1; 3\n0,08; 2  # the shorter one\n",
        "\ufeffwavelength [cm];level [dB]\r\n10;3\r\n8;2\r\n",
        "Rail roughness, EN 15610\nSite;km 12,3\nOperator;A\nWavelength [cm];Level [dB re 1 µm]\n10;3\n8;2\n",
        "Wavelength;Level\ncm;dB re 1 µm\n10;3,0\n8;2,0\n",
        "Wavelength;Level\n[mm];[dB re. 1 micron]\n100;3\n80;2\n",
        "wavelength [m]\tlevel [dB]\n0,1\t3\n0,08\t2\n",
        "Wellenlänge / cm;Pegel / dB ref 1 µm;\n8;2;\n10;3;\n",
        "wavelength in mm,level in dB\n100,3\n80,2\n",
        'lambda/cm,L/dB\n"10","3"\n"8","2"\n',
        "wavelength (mm) level (dB)\n100 3\n80 2\n",
        "wavelength (cm);left (dB);right (dB)\n10;3;3\n8;2;2\n",
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_levels_are_read_in_the_ways_they_are_written(text, encoding, tmp_path):
    text = text.replace("\ufeff", "") if encoding == "latin-1" else text
    (tmp_path / "levels.txt").write_text(text, encoding=encoding)
    wavelengths, levels = tables.read_levels(tmp_path / "levels.txt")
    assert (list(wavelengths), list(levels)) == (pytest.approx([0.1, 0.08]), pytest.approx([3, 2]))


def test_lines_beside_each_other_have_their_energy_mean(tmp_path):
    (tmp_path / "levels.csv").write_text("wavelength (m), left (dB), right (dB)\n0.1, 10, 0\n0.08, -5, -5\n")
    _, levels = tables.read_levels(tmp_path / "levels.csv")
    np.testing.assert_allclose(levels, [10.0 * math.log10((10 + 1) / 2), -5.0], rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("levels", "wavelength (m), left (dB), right (m)\n0.1, 3, 3", "heading 'right (m)'; allowed: level"),
        ("levels", "wavelength (m), left (dB), right (dB)\n0.1, 3, 3\n0.08, 2", "'0.08, 2' in line 3"),
        ("levels", "Site; A\nDate; 1 May\n100; 3", f"heading 'Date, 1 May'; allowed: {ASKED}"),
        ("levels", "frequency (Hz), level (dB)\n100, 3", "'frequency (Hz)'; allowed: wavelength in m"),
        ("levels", LEVELS + "0.1, 3\n0.063, 1", "a gap in the bands between 100 mm and 63 mm"),
        ("levels", LEVELS + "0.1, 3\n0.09, 1", "bands closer than one-third octaves between 100 mm and 90"),
        ("levels", LEVELS + "0.1, 3\n0, 1", "a wavelength of 0 m"),
        ("levels", LEVELS + "0.1, -95\n0.08, -96", "levels up to -95 dB re 1 um"),
        ("levels", LEVELS + "0.1, 3\n0.08", "'0.08' in line 3; allowed: a table with the columns wave"),
        ("levels", LEVELS + "0.1, 3\n0.08, nan", "'0.08, nan' in line 3"),
        ("levels", "wavelength (kg), level (dB)\n0.1, 3", "'wavelength (kg)'; allowed: wavelength in m"),
        ("levels", "wavelength (mm),level (dB)\n100,00,3,1\n80,00,2,2\n", "and between them"),
        ("levels", "wavelength (mm),level (dB)\n100,3,1\n80,2,2\n", "3 numbers in line 2 below 2 titles"),
        ("levels", "100, 3\n80, 2", f"no heading; allowed: {ASKED}"),
        ("levels", "wavelength, level (dB)\n100, 3", f"heading 'wavelength, level (dB)'; allowed: {ASKED}"),
        ("levels", "level [dB], wavelength [mm]\n3, 100", "'level [dB]' for the wavelength; allowed: colu"),
        (
            "levels",
            "wavelength (m), level (dB re 1 um/s)\n0.1, 3",
            "the heading 'level (dB re 1 um/s)'; allowed: a level in dB re 1 um, or re another number of m",
        ),
        ("levels", "Wellenlänge (m), Pegel (dB re 20 µPa)\n0.1, 3", "allowed: a level in dB re 1 um, or re"),
        (
            "levels",
            "wavelength (m), left (dB), right (dB), mean (dB)\n0.1, 3, 3, 3",
            "the heading 'mean (dB)' beside other columns of levels; allowed: levels of lines beside each",
        ),
        (
            "levels",
            "rail,date,10 cm,8 cm,6.3 cm,5 cm\nleft,1 May,3,2,1,0\n",
            "4 wavelengths beside each other in line 1, one measurement in a row; allowed: one line for each "
            "wavelength, with the columns wavelength (m), level (dB). Turn the table: write the line "
            "'wavelength (cm), level (dB)' and lines below it as '10, …'",
        ),
        ("levels", "100 mm;80 mm;63 mm;50 mm\n3;2;1;0\n", "4 wavelengths beside each other in line 1"),
        ("levels", "n;100 mm;80 mm;63 mm;50 mm\n1;3;2;1;0\n", "4 wavelengths beside each other in line 1"),
        ("rates", "place,100 Hz,125 Hz,160 Hz,200 Hz\nB1,3,4,5,6\n", "4 frequencies beside each other in"),
        ("rates", "f (Hz); 100; 125; 160\nTDR (dB/m); 3; 4; 5\n", "one measurement in a row; allowed: one"),
        ("levels", "# nothing", "no line of numbers"),
        ("levels", "100 mm, 3\n80 mm, 2", "'100 mm, 3' in line 1"),
        ("modes", MODES + "0, 0.1, 300", "a frequency of 0; allowed: greater than 0 Hz"),
        ("modes", MODES + "2000, 0, 300", "a damping ratio of 0; allowed: greater than 0 and less than 1"),
        ("modes", MODES + "2000, 0.1, -3", "a modal mass of -3; allowed: greater than 0 kg"),
        ("modes", MODES + "2000, 0.1", "'2000, 0.1' in line 2"),
        ("modes", SHAPES + "2000, 0.1, 300, 1.5, 4, 0.5", "nodal diameters of 1.5; allowed: a whole number"),
        ("modes", SHAPES + "2000, 0.1, 300, -1, 4, 0.5", "a number of nodal diameters of -1"),
        ("modes", SHAPES + "2000, 0.1, 300, 2, -4, 0.5", "an rms velocity of -4; allowed: zero or more, per"),
        ("modes", SHAPES + "2000, 0.1, 300, 2, 4", "or with these and nodal diameters (1), axial velo"),
        ("modes", SHAPES + "2000, 0.1, 300, 2, 4, 1\n2100, 0.1, 300", "'2100, 0.1, 300' in line 3"),
        ("ratios", RATIOS + "100, 0.1\n100, 0.2", "do not rise; allowed: rising frequencies, all above 0 Hz"),
        ("ratios", RATIOS + "100, 0\n200, 0.2", "a radiation ratio of 0; allowed: greater than 0"),
        ("receptance", RECEPTANCE + "100, 1, 1\n" * 3, "3 frequencies; allowed: at least 10"),
        ("receptance", RECEPTANCE + "0, 1, 1\n" + TWELVE, "frequencies that do not rise; allowed: rising"),
        ("receptance", "f (Hz), imaginary (m/N), real (m/N)\n" + TWELVE, "'imaginary (m/N)' for the real"),
        ("rates", RATES + "100, 4\n125, 5\n", "2 frequencies; allowed: at least 3"),
        ("rates", RATES + "100, 4\n125, -5\n160, 4", "a decay rate of -5 dB/m; allowed: 0.01 to 200 dB/m"),
        ("rates", RATES + "100, 400\n125, 500\n160, 4", "a decay rate of 400 dB/m; allowed: 0.01"),
        ("rates", RATES + "100, 4\n125, 5\n126, 4", "twice the band of 126 Hz; allowed: centres"),
        ("rates", RATES + "100, 4\n110, 5\n120, 4", "a frequency of 110 Hz; allowed: centres of"),
        ("rates", "f (Hz), rate (dB/kg)\n100, 4\n", "the heading 'rate (dB/kg)'; allowed: vertical decay"),
        ("rates", "f (Hz), rate\n100, 4\n", "the heading 'f (Hz), rate'; allowed: a heading with the units"),
        ("rates", "f (Hz), lateral (dB/m), vertical (dB/m)\n100, 1, 4\n", "'lateral (dB/m)' for the vert"),
        ("mobility", MOBILITY + "100, 1e-5\n200, 1e-5\n", "2 frequencies; allowed: at least 3"),
        ("mobility", MOBILITY + "100, 1e-5\n200, -1e-5\n300, 1e-5", "a mobility of -1·10⁻⁵ (m/s)/N"),
        ("mobility", MOBILITY + "100, 15\n200, 12\n300, 9", "a mobility of 15 (m/s)/N; allowed: 1e-09 to"),
        ("mobility", "f (Hz), size (kg)\n100, 1\n", "'size (kg)'; allowed: magnitude or real part in"),
        ("mobility", COMPLEX + "100, -1e-5, 0\n200, 1e-5, 0\n300, 1e-5, 0", "power to the hammer at 100 Hz"),
        ("mobility", COMPLEX + "100, 1e-5\n", "'100, 1e-5' in line 2; allowed: a table with the columns"),
        ("pad", PAD + "10, 90, 9\n300, 120, -18\n900, 160, 40", "an imaginary part below zero at 300 Hz"),
        (
            "pad",
            BY_LOSS + "1; 9; -1; 9\n8; 9; -1; 9\n9; 9; -1; 9",
            "below zero from 1 to 9 Hz, by which the pad",
        ),
        ("pad", PAD + "10, 90, 9\n300, 0, 18\n900, 160, 40", "a real part of zero or less at 300 Hz"),
        ("pad", PAD + "10, 90, 9\n10, 1, 1", "numbers that do not rise"),
        ("pad", PAD + "10, 90, 9", "1 frequency"),
        ("pad", PAD.replace("(MN/m)", "(m/N)") + "10, 90, 9", "real part in N/m"),
        (
            "pad",
            PAD.replace("MN/m", "N/m") + "10, 180, 9\n300, 190, 9",
            "a stiffness of 180.225 N/m; allowed: 1",
        ),
        ("pad", BY_LOSS + "1; 90; 0.1; 9e5\n8; 90; 0.1; 9e5", "a preload of 900 MN; allowed: 1 N to 10 MN."),
        ("pad", PAD + "10, 90", "'10, 90' in line 2"),
        ("pad", "frequency (Hz), loss factor\n1, 1", "magnitude"),
        ("bands", "f (Hz), L (dB)\n100, 60\n200, 70\n201, 60", "twice the band of 201 Hz"),
        ("bands", "t (s), L (dB)\n1, 60\n2, 70\n3, 60", "the heading 't (s)'; allowed: frequency in Hz"),
    ],
)
def test_tables_that_are_wrong(name, text, message, source):
    """By themselves, and as the key of a case that names them."""
    told, of_case = refusal_of_table(*READ[name], source.parent / f"{name}.csv", text)
    assert message in told
    assert message.partition(";")[0] in of_case


@pytest.mark.parametrize("title", [
    "Limit ISO 3095 [dB re 1 um]", "limit (dB)", "EN ISO 3095 [dB]", "Grenzkurve [dB]", "TSI [dB re 1 µm]",
    "Valeur limite [dB]", "Target [dB]", "EN 13979-1 [dB]", "Reference curve [dB]", "Exceedance [dB]",
    "Diff. [dB]",
])  # fmt: skip
@pytest.mark.parametrize("first", [True, False])
def test_a_limit_beside_the_levels_is_none_of_them(title, first, tmp_path):
    cells = [[at, *((17, level) if first else (level, 17))] for at, level in ((10, 3), (8, 2))]
    titles = [title, "Level [dB re 1 um]"] if first else ["Level [dB re 1 um]", title]
    lines = [";".join(map(str, row)) for row in (["Wavelength [cm]", *titles], *cells)]
    for text in ("\n".join(lines), "# " + "\n".join(lines), "Site;A;B\n" + "\n".join(lines)):
        (tmp_path / "levels.csv").write_text(text, encoding="utf-8")
        np.testing.assert_allclose(tables.read_levels(tmp_path / "levels.csv")[1], [3, 2])


@pytest.mark.parametrize(
    "title", ["Gesamt [dB]", "Total [dB]", "σ [dB]", "StDev [dB]", "L95 [dB]", "Sum [dB]"]
)
def test_a_total_or_a_spread_beside_levels_is_refused(title, tmp_path):
    (tmp_path / "a.csv").write_text(
        f"Wavelength [cm];Wheel 1 [dB];{title}\n10;3;5\n8;2;5\n", encoding="utf-8"
    )
    with pytest.raises(InputError, match=f"the heading '{re.escape(title)}' beside other columns of levels"):
        tables.read_levels(tmp_path / "a.csv")


@pytest.mark.parametrize(("head", "told"), [
    ("λ [cm];Left [dB];Limit [dB]", "'Left [dB]', without 'Limit [dB]'"),
    ("λ [cm];Left [dB];Right [dB]", "the energy mean of 'Left [dB]', 'Right [dB]'"),
    ("λ;Left;Right\ncm;dB;dB", "the energy mean of 'Left (dB)', 'Right (dB)'"),
])  # fmt: skip
def test_columns_that_count_are_told(head, told, tmp_path):
    (tmp_path / "a.csv").write_text(f"{head}\n10;3;5\n8;2;5\n", encoding="utf-8")
    assert tables.columns_of_levels(tmp_path / "a.csv") == told


def test_a_limit_is_none_of_the_lateral_decay_rates(tmp_path):
    (tmp_path / "a.csv").write_text(
        "f (Hz), rate (dB/m), limit TSI (dB/m)\n100, 4, 8\n125, 5, 8\n160, 6, 8\n"
    )
    _, vertical, lateral = measured.read_decay_rates(tmp_path / "a.csv")
    assert (vertical.tolist(), lateral) == ([4, 5, 6], None)


def test_levels_by_the_standard_in_each_title_are_levels(tmp_path):
    text = "wavelength (m), left ISO 3095 (dB), right ISO 3095 (dB)\n0.1, 3, 3\n0.08, 2, 2\n"
    (tmp_path / "a.csv").write_text(text)
    np.testing.assert_allclose(tables.read_levels(tmp_path / "a.csv")[1], [3, 2])


@pytest.mark.parametrize(("reference", "more"), [
    ("re 1 nm", -60), ("re 1nm", -60), ("rel. 1 m", 120), ("re 1e-6 m", 0), ("ref. 1 µm", 0),
    ("re: 1 mm", 60), ("re 1 micron", 0), ("re nm", -60),
])  # fmt: skip
def test_levels_have_whatever_reference(reference, more, tmp_path):
    """20 lg of the ratio of both references."""
    text = f"wavelength (m), level (dB {reference})\n0.1, {3 - more}\n0.08, {2 - more}\n"
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    np.testing.assert_allclose(tables.read_levels(tmp_path / "a.csv")[1], [3, 2], atol=1e-9)


def test_levels_of_sound_have_whatever_reference(tmp_path):
    text = "f (Hz), L (dB(A) re 1 Pa)\n1000, -20\n1250, -20\n1600, -20\n"
    (tmp_path / "a.csv").write_text(text)
    expected = -20 + 20 * math.log10(1 / 20e-6)
    assert measured.read_band_levels(tmp_path / "a.csv")[1][0] == pytest.approx(
        expected, abs=1e-3
    )  # weighted by 0 dB


@pytest.mark.parametrize(
    ("unit", "scale"), [("dB/km", 1000), ("dB/cm", 0.01), ("dB/m", 1), ("dB / km", 1000)]
)
def test_decay_rates_per_any_length(unit, scale, tmp_path):
    rows = "".join(f"{f}, {rate * scale:g}\n" for f, rate in ((100, 4), (125, 5), (160, 6)))
    (tmp_path / "a.csv").write_text(f"f (Hz), rate ({unit})\n{rows}")
    np.testing.assert_allclose(measured.read_decay_rates(tmp_path / "a.csv")[1], [4, 5, 6])


@pytest.mark.parametrize(("row", "message"), [
    ("0.6, 180, 1e8", "a pad stiffness of 180 N/m; allowed: 1 kN/m to 1 TN/m. Pads lie between. Is the unit"),
    ("600, 3e8, 1e8", "a spacing of 600 m; allowed: 0.1 m to 10 m"),
    ("0.6, 3e8, 1e-3", "a ballast stiffness of 0.001 N/m; allowed: 1 kN/m to 1 TN/m"),
])  # fmt: skip
def test_what_is_refused_as_a_key_is_refused_in_a_table(row, message, tmp_path):
    (tmp_path / "bays.csv").write_text(f"d (m), pad (N/m), ballast (N/m)\n{row}\n")
    with pytest.raises(InputError, match=re.escape(message)):
        tables.read_bays(tmp_path / "bays.csv")


def bytes_of_levels(content, tmp_path):
    (tmp_path / "levels.csv").write_bytes(content)
    tables.read_levels(tmp_path / "levels.csv")


test_a_table_that_is_no_text_or_too_large = refusals(
    (b"\xff\xfe\x00", "no UTF-16 in line 1"),
    (b"#" * (32 * 2**20 + 1), "more than 32 MiB"),
    of=bytes_of_levels,
)


def test_modes_say_how_they_move_the_wheel(tmp_path):
    path, row = tmp_path / "modes.csv", np.array([[2000.0, 1e-4, 300.0, 2.0, 4.0, 0.5]])
    path.write_text(SHAPES.replace("Hz", "kHz") + "2, 1e-4, 300, 2, 4, 0.5\n")
    for table in (path, row, row[:, :3]):
        assert tables.read_mode_table(table).tolist() == (row if table is path else table).tolist()
    with pytest.raises(CaseError, match=r"an array of shape \(n, 3\) or \(n, 6\) of real numbers"):
        WheelOnRail(surface={"spectrum": "iso3095"}, wheel={"modes": np.ones((2, 4))})


# --- measured on a track and beside it


def test_decay_rates_are_read_with_and_without_those_sideways(source):
    centres, vertical, lateral = measured.read_decay_rates(source.parent / "rates.csv")
    np.testing.assert_allclose(centres, 10.0 ** np.array([2.0, 2.1, 2.3]))  # 125 and 200 Hz are nominal
    assert (list(vertical), list(lateral)) == ([4.5, 4.0, 5.0], [0.5, 0.5, 0.4])
    table = np.array([[3150.0, 2.0], [4000.0, 2.1], [5000.0, 2.2]])
    centres, vertical, lateral = measured.read_decay_rates(WheelOnRail(
        surface={"spectrum": "iso3095"}, track={"decay_rates": table}).track.decay_rates)  # fmt: skip
    np.testing.assert_allclose(centres, 10.0 ** np.array([3.5, 3.6, 3.7]))
    assert (list(vertical), lateral) == ([2.0, 2.1, 2.2], None)


def test_decay_rates_of_both_rails_are_as_long_as_their_mean(tmp_path):
    """Two rails radiate as one with the mean of 1/Δ."""
    heads = (
        "f (Hz), vertical left (dB/m), vertical right (dB/m)",
        ", lateral left (dB/m), lateral right (dB/m)",
    )
    rows = "100, 2, 6", "125, 4, 4", "160, 1, 3"
    (tmp_path / "a.csv").write_text("\n".join([heads[0], *rows]))
    (tmp_path / "b.csv").write_text("\n".join(["".join(heads), *(f"{each}, 3, 3" for each in rows)]))
    for name, sideways in (("a.csv", None), ("b.csv", [3.0, 3.0, 3.0])):
        _, vertical, lateral = measured.read_decay_rates(tmp_path / name)
        np.testing.assert_allclose(vertical, [3.0, 4.0, 1.5])
        assert (None if lateral is None else lateral.tolist()) == sideways
    row = np.array([[100.0, 2, 6, 1, 3], [125.0, 4, 4, 1, 1], [160.0, 1, 3, 2, 6]])
    np.testing.assert_allclose(measured.read_decay_rates(row)[1:], [[3.0, 4.0, 1.5], [1.5, 1.0, 3.0]])
    (tmp_path / "c.csv").write_text(f"{heads[0]}, lateral left (dB/m)\n100, 1, 1, 1\n125, 1, 1, 1\n")
    with pytest.raises(InputError, match="vertical decay rate"):
        measured.read_decay_rates(tmp_path / "c.csv")


@pytest.mark.parametrize("rails", ["left (dB/m), right (dB/m)", "links (dB/m); rechts (dB/m)"])
def test_columns_of_both_rails_are_no_lateral_rates(rails, tmp_path):
    """Named by the rails alone the second is not read as another direction; named lateral it is."""
    apart = ";" if ";" in rails else ","
    lines = ("100", "2", "6"), ("125", "4", "4"), ("160", "1", "3")
    rows = "".join(f"{apart.join(each)}\n" for each in lines)
    (tmp_path / "a.csv").write_text(f"f (Hz){apart}{rails}\n{rows}")
    _, vertical, lateral = measured.read_decay_rates(tmp_path / "a.csv")
    np.testing.assert_allclose(vertical, [3.0, 4.0, 1.5])
    assert lateral is None
    sideways = rails.replace("right", "lateral right").replace("rechts", "lateral rechts")
    (tmp_path / "b.csv").write_text(f"f (Hz){apart}{sideways}\n{rows}")
    assert measured.read_decay_rates(tmp_path / "b.csv")[2].tolist() == [6.0, 4.0, 3.0]


def test_a_mobility_in_decibels_is_asked_for_as_a_value(tmp_path):
    (tmp_path / "y.csv").write_text("f (Hz), mobility (dB re 1e-6 m/s/N)\n100, 10\n200, 11\n400, 12\n")
    with pytest.raises(InputError, match=r"its reference times 10\^\(L/20\)"):
        measured.read_mobility(tmp_path / "y.csv")
    (tmp_path / "y.csv").write_text("f (Hz), mobility (kg)\n100, 10\n200, 11\n400, 12\n")
    with pytest.raises(InputError, match="kg") as told:
        measured.read_mobility(tmp_path / "y.csv")
    assert "10^(L/20)" not in str(told.value)
    (tmp_path / "y.csv").write_text("f (Hz), level (dB re 1 N)\n100, 10\n125, 11\n160, 12\n")
    with pytest.raises(InputError, match="level") as told:
        measured.read_band_levels(tmp_path / "y.csv")
    assert "10^(L/20)" not in str(told.value)


OMEGA = 2.0 * np.pi * np.array([100.0, 200.0, 400.0])
TRUE = np.array([2e-5 + 1e-5j, 1e-5 - 2e-5j, 3e-5 + 0j])


@pytest.mark.parametrize(("unit", "numbers"), [
    ("(m/s)/N", TRUE), ("m/(N s)", TRUE), ("m/(Ns)", TRUE), ("mm/s/kN", 1e6 * TRUE),
    ("m/s^2/N", 1j * OMEGA * TRUE), ("(m/s²)/N", 1j * OMEGA * TRUE),
    ("m/N", TRUE / (1j * OMEGA)), ("m/kN", 1e3 * TRUE / (1j * OMEGA)),
])  # fmt: skip
def test_a_mobility_is_read_in_its_three_forms(unit, numbers, tmp_path):
    rows = zip((100, 200, 400), numbers, strict=True)
    text = "".join(f"{f}; {y.real:.12g}; {y.imag:.12g}\n" for f, y in rows)
    (tmp_path / "y.csv").write_text(f"f (Hz); real [{unit}]; imaginary [{unit}]\n{text}", encoding="utf-8")
    np.testing.assert_allclose(measured.read_mobility(tmp_path / "y.csv")[1], TRUE, rtol=1e-9)
    for phase, turn in (("deg", 180.0 / np.pi), ("rad", 1.0)):
        rows = zip((100, 200, 400), np.abs(numbers), turn * np.angle(numbers), strict=True)
        text = "".join(f"{f}; {size:.12g}; {angle:.12g}\n" for f, size, angle in rows)
        (tmp_path / "y.csv").write_text(f"f (Hz); size [{unit}]; phase ({phase})\n{text}", encoding="utf-8")
        np.testing.assert_allclose(measured.read_mobility(tmp_path / "y.csv")[1], TRUE, rtol=1e-9)
    rows = zip((100, 200, 400), np.abs(numbers), strict=True)
    text = f"f (Hz)\tsize [{unit}]\n" + "".join(f"{f}\t{size:.12g}\n" for f, size in rows)
    (tmp_path / "size.txt").write_text(text, encoding="utf-8")
    np.testing.assert_allclose(measured.read_mobility(tmp_path / "size.txt")[1], np.abs(TRUE), rtol=1e-9)


def test_bands_are_read_without_weighting(tmp_path):
    weighted = 60.0 + 10.8  # IEC 61672-1: −10.9 dB at 200 Hz nominal
    for unit, at_200 in (("dB", 60.0), ("dB(A)", weighted), ("dBA", weighted), ("dB(A) re 20 µPa", weighted)):
        text = f"f (kHz), L ({unit})\n0.2, 60\n1, 70\n5, 50\n"
        (tmp_path / "bands.csv").write_text(text, encoding="utf-8")
        centres, level = measured.read_band_levels(tmp_path / "bands.csv")
        np.testing.assert_allclose(centres, 10.0 ** np.array([2.3, 3.0, 3.7]))
        assert level[0] == pytest.approx(at_200, abs=0.11)
        assert level[1] == pytest.approx(70.0, abs=0.01)


@pytest.mark.parametrize(("first", "cells", "line", "row"), [
    ("wavelength (mm)", "315;250;200;160;125;100", "wavelength (mm), level (dB)", "315, …"),
    ("n", "31.5 cm;25 cm;20 cm;16 cm;12.5 cm;10 cm", "wavelength (cm), level (dB)", "31.5, …"),
    ("Wellenlänge / cm", "31,5;25;20;16;12,5;10", "wavelength (cm), level (dB)", "31.5, …"),
])  # fmt: skip
def test_a_table_on_its_side_is_turned_as_it_is_told(tmp_path, first, cells, line, row):
    """With the unit that it has: the line that is advised above the cells is read."""
    file = tmp_path / "levels.csv"
    file.write_text(f"{first};{cells}\n1;3;2;1;0;-1;-2\n", encoding="utf-8")
    with pytest.raises(
        InputError, match=re.escape(f"write the line '{line}' and lines below it as '{row}'.")
    ):
        tables.read_levels(file)
    counted = "wavelength (cm);1;2;3;4\n31.5;3;3;3;3\n"  # names of lines, which count on
    file.with_name("lines.csv").write_text(counted)
    with pytest.raises(InputError, match="a heading with the units in brackets"):
        tables.read_levels(file.with_name("lines.csv"))
    places = [cell.partition(" ")[0] for cell in cells.split(";")]
    rows = "".join(f"{place}; {level}\n" for place, level in zip(places, (3, 2, 1, 0, -1, -2), strict=True))
    file.write_text(f"{line.replace(',', ';')}\n{rows}", encoding="utf-8")
    np.testing.assert_allclose(tables.read_levels(file)[0][0], 0.315)


@pytest.mark.parametrize("title", ["wavenumber (1/m)", "Wellenzahl [1/cm]", "k (m^-1)", "q (1/mm)"])
def test_wavenumbers_are_to_be_turned_over(tmp_path, title):
    (tmp_path / "levels.csv").write_text(f"{title};level (dB)\n10;3\n12.5;2\n", encoding="utf-8")
    with pytest.raises(
        InputError, match=r"wavelength in m\. Write wavelengths: one over wavenumbers in cycles"
    ):
        tables.read_levels(tmp_path / "levels.csv")
