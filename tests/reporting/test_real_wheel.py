"""The figures and tables that only a wheel on a rail has, on a real run."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from report_reading import HOSTILE, Reader, read_csv
from report_tree import figures_by_name, laws_in

from asperity.cli.studying import print_table
from asperity.laws import spec_of
from asperity.reporting.chart import Boxes, Line, Note, Rules
from asperity.reporting.study_figures import key_chart
from asperity.scenes.figures.force import AROUND_PEAK, around_peak
from asperity.scenes.figures.motion import point_labels
from asperity.scenes.figures.noise import sound_power_table
from asperity.scenes.report import figures_of, page_of
from asperity.studies.member import kept, names_kept
from asperity.studies.table import USUAL, USUAL_IN_FIGURES, chosen, columns_of

PARTS = figures_by_name("wheel-on-rail")


@pytest.fixture
def tree(real_runs):
    return real_runs["wheel-on-rail"]


@pytest.fixture
def folder(reports):
    return reports["wheel-on-rail"]


def marks_of(tree, name, kind, panel=0):
    """Marks of a kind in a panel of a figure."""
    return [mark for mark in panels_of(tree, name)[panel].marks if isinstance(mark, kind)]


def panels_of(tree, name):
    return PARTS[name].laid_out(tree).panels


def rules_of(tree, name, *, short=False, panel=0):
    """Places of the rules of a panel, short or long."""
    return [at for mark in marks_of(tree, name, Rules, panel) if mark.short == short for at in mark.at]


def test_a_ball_has_no_chapters_of_a_track(real_runs):
    ball = {part.name for part in figures_of(real_runs["ball-on-beam"])}
    assert not {"receptance", "sound_power", "displacement"} & ball


def test_numbers_survive_the_csv_files_to_the_last_bit(tree, folder):
    spectra, track = tree["spectra"].to_dataset(), tree["track"].to_dataset()
    psd, bands = read_csv(folder / "force_psd.csv"), read_csv(folder / "force_bands.csv")
    for law in spectra["law"].values:
        power = read_csv(folder / "sound_power_bands.csv")[f"wheel, {law} [dB re 1 pW]"]
        assert np.array_equal(power, spectra["sound_power_level"].sel(law=law, source="wheel").values)
    assert np.array_equal(psd["linear, frequency domain [N^2/Hz]"], spectra["linear_reference_psd"].values)
    reference = bands["linear, frequency domain [dB re 1 N]"]
    assert np.array_equal(reference, spectra["linear_reference_level"].values)
    roughness = read_csv(folder / "roughness.csv")["wheel [dB re 1 µm]"]
    level = spectra["roughness_level"].sel(part="wheel").values
    assert np.array_equal(roughness, level, equal_nan=True)
    receptance = read_csv(folder / "receptance.csv")
    assert np.array_equal(receptance["receptance_midspan [m/N]"], track["receptance_midspan"].values)
    phase = receptance["receptance_support phase [rad]"]
    assert np.array_equal(phase, track["receptance_support_phase"].values)
    kernel = list(read_csv(folder / "moving_kernel.csv").items())
    assert kernel[1][0] == "kernel(start=0 m) [m/(N s)]"
    assert np.array_equal(kernel[1][1], track["moving_kernel"].values[0])


def test_force_spectrum_carries_the_marks_of_the_track(tree):
    speed, sleepers = tree["rolling"].attrs["speed"], tree["track"].attrs["sleeper_spacing"]
    pinned = tree["track"].attrs["pinned_pinned_frequency"]
    split = [pinned - speed / sleepers / 2, pinned + speed / sleepers / 2]
    assert rules_of(tree, "force_psd") == pytest.approx(split)
    tones = rules_of(tree, "force_psd", short=True)
    assert tones == pytest.approx(speed / sleepers * np.arange(1, len(tones) + 1))
    assert panels_of(tree, "force_psd")[0].x.high - tones[-1] < speed / sleepers
    caption = PARTS["force_psd"].said(tree)
    assert f"every {speed / sleepers:.1f} Hz" in caption
    assert f"{split[0]:.0f} and {split[1]:.0f} Hz" in caption


@pytest.mark.parametrize("name", ["receptance", "decay_rate"])
def test_track_frequencies_are_marked_and_named(tree, name):
    named = {"antiresonance": "anti-resonance", "cut_on": "cut-on", "pinned_pinned": "pinned–pinned"}
    marks = {tree["track"].attrs[f"{key}_frequency"]: label for key, label in named.items()}
    assert rules_of(tree, name) == sorted(marks)
    assert {note.text for note in marks_of(tree, name, Note)} == {
        f"{label}, {frequency:.0f} Hz" for frequency, label in marks.items()
    }


def test_sleepers_are_marked_where_the_wheel_passes_them(tree):
    rolling, sleepers = tree["rolling"].to_dataset(), tree["track"].attrs["sleeper_spacing"]
    for panel in range(len(panels_of(tree, "displacement"))):
        seconds = 1e-3 * np.array(rules_of(tree, "displacement", short=True, panel=panel))  # drawn in ms
        places = np.interp(seconds, rolling["time"].values, rolling["position"].values) / sleepers
        assert len(places) >= 3
        assert places == pytest.approx(np.round(places), abs=1e-6)


def test_table_of_sound_power_holds_levels_and_differences(tree, folder):
    text = (folder / "report.html").read_text(encoding="utf-8")
    body = text[text.index('id="sound_power_table"') :]
    rows = re.findall(r"<tr><td>(.*?)</td>(.*?)</tr>", body[: body.index("</table>")])
    levels = tree["spectra"].to_dataset()["sound_power_level_a"]
    assert [law for law, _ in rows] == [*levels["law"].values, "CNOSSOS-EU"]
    for law, cells in rows[:-1]:
        shown = [cell.replace("−", "-") for cell in re.findall(r">([^<]+)</td>", cells)]
        expected = levels.sel(law=law).values
        assert [float(cell) for cell in shown[:3]] == pytest.approx(expected, abs=0.051)
        for baseline, difference in zip(("linear-filtered", "linear"), shown[3:], strict=True):
            over = expected[-1] - float(levels.sel(law=baseline)[-1])
            assert (
                difference == "–" if law == baseline else float(difference) == pytest.approx(over, abs=0.051)
            )


def test_the_standard_stands_beside_the_laws(tree):
    standard = tree["spectra"].to_dataset()["cnossos_sound_power_level_a"]
    table = sound_power_table(tree)
    last = [cell.text for cell in table.rows[-1]]
    assert last[:4] == ["CNOSSOS-EU", *(f"{level:.1f}" for level in standard.values)]
    assert standard.attrs["contact_filter"] in table.note


def test_bars_end_at_their_levels(tree):
    levels = tree["spectra"].to_dataset()["sound_power_level_a"]
    bars = marks_of(tree, "sound_power", Boxes)
    for law, own in zip(levels["law"].values, bars, strict=True):
        assert own.law == own.label == law
        assert own.right.tolist() == levels.sel(law=law).values.tolist()
    assert len({(own.colour, own.hatch) for own in bars}) == len(bars)


def test_contact_of_wheel_and_rail_is_outlined_by_its_ellipse(tree):
    along, across = (tree["contact"].attrs[f"hertz_radius{end}"] for end in ("", "_across"))
    outlines = marks_of(tree, "contact_pressure", Line)
    for outline in outlines:
        sides = np.ptp(outline.x), np.ptp(outline.y)
        assert sides == pytest.approx((2e3 * along, 2e3 * across), rel=1e-3)
    assert len(outlines) == 2  # dark on light: seen on every colour
    assert "dashed ellipse" in PARTS["contact_pressure"].said(tree)


def test_large_forces_are_shown_in_kilonewtons(tree):
    for name in ("force_envelope", "force_peak", "contact_force"):
        assert any(panel.y.label.endswith("/ kN") for panel in panels_of(tree, name))


def of_laws(tree, *laws):
    """A result of the first laws of another, under other names."""
    tree = tree.copy(deep=True)
    for group in ("rolling", "spectra"):
        tree[group] = tree[group].to_dataset().isel(law=slice(len(laws))).assign_coords(law=list(laws))
    tree["scenario"].attrs["laws"] = json.dumps([spec_of(law).entry() for law in laws if law != HOSTILE])
    return tree


@pytest.mark.parametrize("laws", [["linear"], ["table"], ["direct", "hertz-filtered", "linear"]])
def test_any_set_of_laws(tree, laws):
    tree = of_laws(tree, *laws)
    for name in ("force_envelope", "force_peak", "force_psd", "force_bands", "sound_power", "displacement"):
        assert laws_in(PARTS[name].laid_out(tree)) == set(laws)
    assert sound_power_table(tree) is not None


def test_hostile_names_stay_text(tree):
    tree = of_laws(tree, HOSTILE, "linear")
    names = {"part": [HOSTILE, "b", "c"], "source": [HOSTILE, "b", "total"]}
    tree["spectra"] = tree["spectra"].to_dataset().assign_coords(names)
    tree["track"].attrs["kernel_method"] = HOSTILE
    del tree["surface"], tree["contact"]
    reader = Reader(page_of(tree))
    assert not reader.open
    assert "img" not in {tag for tag, _ in reader.tags}
    assert "".join(reader.text).count(HOSTILE) > 10


def test_smooth_surface_has_no_map_and_no_spectrum(tree):
    rough, tree = tree, tree.copy(deep=True)
    for name in ("sample_heights", "psd_sample", "psd_path"):
        tree["surface"][name].values[:] = 0.0
    drawn = {part.name for part in figures_of(tree)}
    assert {part.name for part in figures_of(rough)} - drawn == {"texture_sample", "texture_psd"}


def test_spectra_are_shaded_where_their_bands_say_little(tree):
    tree = tree.copy(deep=True)
    tree["spectra/band_time_product"].values[:] = 100.0
    for name in ("force_psd", "rail_velocity_psd"):
        assert not marks_of(tree, name, Boxes)
    tree["spectra/band_time_product"].values[:6] = 9.9
    for name in ("force_psd", "rail_velocity_psd"):
        assert all(len(marks_of(tree, name, Boxes, n)) == 1 for n in range(len(panels_of(tree, name))))
        assert "B T is below 10" in PARTS[name].said(tree)


def test_bands_without_roughness_are_not_drawn(tree):
    tree = tree.copy(deep=True)
    level = tree["spectra"]["roughness_level"].values
    level[:] = np.linspace(20.0, 0.0, level.shape[1])
    level[:, :5] = -130.0
    level[1, 12] = -100.0
    lines = {line.label: line.y for line in marks_of(tree, "roughness", Line)}
    assert np.array_equal(lines["rail"], level[0, 5:])
    assert np.isnan(lines["wheel"][7])
    assert len(PARTS["roughness"].collect(tree).columns["wavelength [m]"]) == level.shape[1]


def test_drawn_force_spectrum_keeps_the_power(tree):
    spectra = tree["spectra"].to_dataset()
    lines = 5.0 * np.arange(1, 1 + spectra.sizes["frequency"])
    tree = tree.copy()
    tree["spectra"] = spectra.assign_coords(frequency=lines)
    (line,) = [line for line in marks_of(tree, "force_psd", Line) if line.label == "areal"]
    drawn = np.mean(10 ** (line.y / 10))
    count = 4 * len(line.x)  # lines 5 Hz apart, drawn every 20 Hz
    assert count > 40
    assert drawn == pytest.approx(spectra["force_psd"].sel(law="areal").values[:count].mean())


def test_piece_around_the_peak_holds_it(tree):
    rolling = tree["rolling"].to_dataset()
    peak = int(np.argmax(rolling["contact_force"].sel(law="areal").values))
    part = around_peak(tree)
    assert part.start <= peak < part.stop
    step = float(rolling["time"][1])
    assert (part.stop - part.start) * step == pytest.approx(AROUND_PEAK, abs=step)
    assert f"{rolling['time'].values[peak]:.4f} s" in PARTS["force_peak"].said(tree)


@pytest.mark.parametrize("flat", [True, False])
def test_bars_of_lost_contact_are_drawn_where_it_is_lost(tree, flat):
    part, tree = PARTS["force_peak"], tree.copy(deep=True)
    rolling = tree["rolling"].to_dataset()
    force = rolling["contact_force"].sel(law="areal", contact=1)
    peak = int(np.argmax(force.values))
    if flat:  # in flight before the wheel strikes
        force[max(peak - 40, 0) : peak - 5] = 0.0
    rolling["contact_loss_share"][0] = 0.02 * flat
    tree["rolling"] = rolling
    assert len(part.laid_out(tree).panels) == 1 + flat
    assert ("Bars below" in part.said(tree)) == flat


@pytest.mark.parametrize("end", [0, -1])
def test_piece_around_a_peak_at_an_end_stays_inside(tree, end):
    tree = tree.copy(deep=True)
    tree["rolling"]["contact_force"].values[..., end] = 1e6
    part, count = around_peak(tree), tree["rolling"].sizes["time"]
    assert (part.start == 0) == (end == 0)
    assert (part.stop == count) == (end == -1)
    step = float(tree["rolling"]["time"][1])
    assert (part.stop - part.start) * step == pytest.approx(AROUND_PEAK, abs=step)


def test_passed_points_are_named_by_their_place_in_the_bay(tree):
    tree = tree.copy()
    points = {"point": [1.2, 1.5, 1.65]}
    rolling = tree["rolling"].to_dataset().drop_dims("point")
    tree["rolling"] = rolling.assign_coords(points)
    assert point_labels(tree) == ["x = 1.2 m, over a sleeper", "x = 1.5 m, mid-span", "x = 1.65 m"]


@pytest.mark.parametrize(
    ("name", "variable"),
    [
        ("force_bands", "band_time_product"),
        ("sound_power_bands", "noise_band_time_product"),
        ("roughness", "surface_band_length_product"),
    ],
)
def test_bands_that_say_little_are_shaded_and_in_the_csv_file(tree, name, variable):
    part, tree = PARTS[name], tree.copy(deep=True)
    product = tree[f"spectra/{variable}"].values
    product[:] = 100.0
    assert not marks_of(tree, name, Boxes)
    product[:4] = 9.9
    (box,) = marks_of(tree, name, Boxes)
    centres = part.collect(tree).at[:4]
    assert box.left < centres.min()
    assert box.right > centres.max()
    assert "Shaded" in part.said(tree)
    columns = part.collect(tree).columns
    assert columns["level says something [1]"].tolist() == [0.0] * 4 + [1.0] * (len(product) - 4)


def test_motion_is_compared_with_practice(tree):
    assert {line.label for line in marks_of(tree, "rail_velocity", Line)} == {"areal", "linear-filtered"}


def test_the_passage_follows_from_the_sound_power(tree):
    """SEL of an axle in each band: L_W + 10 lg(ρc/(2 d v)/(4e-10 Pa² s/W)), d² = 7.5² + 1.2² for the rail."""
    power = tree["spectra/radiated_power_level"].sel(radiator="rail")
    exposed = tree["pass_by/sound_exposure_level"].sel(radiator="rail")
    away = 413.0 * 1e-12 / (2.0 * np.hypot(7.5, 1.2) * tree["rolling"].attrs["speed"]) / 4e-10
    np.testing.assert_allclose(exposed.values, power.values + 10.0 * np.log10(away), atol=1e-6)


def test_axles_are_marked_where_they_pass(tree, folder):
    assert rules_of(tree, "pass_by_level", short=True) == [0.0]
    table = read_csv(folder / "pass_by_level.csv")
    level = tree["pass_by/pass_by_level"].sel(law="areal", radiator="total").values
    assert np.array_equal(table["total, areal [dB(A) re 20 µPa]"], level)
    assert not any("wheel" in head for head in table)  # it is rigid


@pytest.fixture
def study(tree):
    """Table of a study of two speeds, which gave the same."""
    table = kept(tree).expand_dims(speed=2).assign_attrs(sweep='{"speed": [56, 60]}')
    table["speed"] = ("speed", [56.0, 60.0], {"units": "m/s", "long_name": "speed"})
    return table.isel(speed=[0]), table


def test_a_study_shows_the_sound_of_rail_sleepers_and_wheel_and_the_pass_by(study, capsys):
    """In the terminal; what is missing throughout, as the sound of a rigid wheel, only if it is asked for."""
    print_table(study[0], USUAL, asked=False)
    said = " ".join(capsys.readouterr().out.replace("┃", " ").replace("│", " ").split())
    for words in ("rail", "sleepers", "total", "pass by", "maximum level"):
        assert words in said
    assert "wheel" not in said
    print_table(study[0], ("radiated_power_level_a",), asked=True)
    assert "wheel" in capsys.readouterr().out


def test_the_figure_of_a_study_draws_sound_and_nothing_that_is_zero_throughout(study):
    table = study[1]
    assert not table["contact_loss_share"].values.any()
    chart = key_chart(table, None, "speed", {}, USUAL_IN_FIGURES)
    panels = {panel.title: panel for panel in chart.panels}
    assert panels["L_pAFmax"].y.label == "dB(A) re 20 µPa"
    assert not any("without contact" in title for title in panels)
    sound = panels["sound power level from the vibration itself, areal"]
    power = table["radiated_power_level_a"].isel(law=0)
    for line in sound.marks:
        np.testing.assert_array_equal(line.y, power.sel(radiator=line.label))
    assert [line.label for line in sound.marks] == ["rail", "sleepers", "total"]  # the wheel is rigid


def test_what_a_study_of_wheels_may_be_asked_to_show_is_what_it_keeps(tree):
    found = {str(name) for name in kept(tree).data_vars}
    known = names_kept()
    assert found - {"point_position", "force_level_difference_to_reference_a"} <= set(known)
    assert set(USUAL) <= set(known)
    assert chosen(["peak_force, pass by maximum level"]) == (
        "peak_force",
        "pass_by_maximum_level",
    )


def test_a_study_keeps_noise_by_source_and_the_pass_by(tree, study):
    heading, rows = columns_of(study[0], bands=False)
    for name in ("rail", "sleepers", "wheel", "total"):
        assert f"radiated_power_level_a {name} [dB(A) re 1 pW]" in heading
    column = heading.index("pass_by_maximum_level [dB(A) re 20 uPa]")
    expected = tree["pass_by/pass_by_maximum_level"].sel(radiator="total").values
    assert [row[column] for row in rows] == list(expected)
