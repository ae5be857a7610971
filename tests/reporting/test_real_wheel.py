"""The figures and tables that only a wheel on a rail has, on a real run."""

import json

import numpy as np
import pytest
import xarray
from report_reading import read_csv
from report_tree import PARTS

from asperity.cli.studying import print_table
from asperity.reporting.chart import Boxes, Line, Note, Rules
from asperity.reporting.data import typed_words
from asperity.reporting.study_figures import ends_in_words, key_figures
from asperity.scenes.figures.force import AROUND_PEAK, around_peak
from asperity.scenes.figures.motion import point_labels
from asperity.scenes.figures.noise import sound_power_table
from asperity.scenes.report import figures_of
from asperity.studies.member import kept, names_kept
from asperity.studies.table import LOUDNESS, USUAL, USUAL_IN_FIGURES, chosen, columns_of


@pytest.fixture
def tree(real_runs):
    return real_runs["wheel-on-rail"]


@pytest.fixture
def other(tree):
    """A copy to be changed."""
    return tree.copy(deep=True)


def marks_of(tree, name, kind, panel=0):
    """Marks of a kind in a panel of a figure."""
    return [mark for mark in panels_of(tree, name)[panel].marks if isinstance(mark, kind)]


def panels_of(tree, name):
    return PARTS[name].drawn(tree).chart.panels


def rules_of(tree, name, *, short=False, panel=0):
    """Places of the rules of a panel, short or long."""
    return [at for mark in marks_of(tree, name, Rules, panel) if mark.short == short for at in mark.at]


LINEAR = "linear, frequency domain"


@pytest.mark.parametrize(
    ("file", "column", "variable", "places"),
    [
        ("force_psd", f"{LINEAR} [N^2/Hz]", "spectra/linear_reference_psd", {}),
        ("force_bands", f"{LINEAR} [dB re 1 N]", "spectra/linear_reference_level", {}),
        ("contact_force", "stiffness [N/m]", "contact/stiffness", {}),
        ("roughness", "wheel [dB re 1 µm]", "spectra/roughness_level", {"part": "wheel"}),
        ("receptance", "receptance_midspan [m/N]", "track/receptance_midspan", {}),
        ("receptance", "receptance_support phase [rad]", "track/receptance_support_phase", {}),
        ("radiated_power_bands", "rail, areal [dB re 1 pW]", "spectra/radiated_power_level",
         {"law": "areal", "radiator": "rail"}),
        ("pass_by_level", "total, areal [dB(A) re 20 µPa]", "pass_by/pass_by_level",
         {"law": "areal", "radiator": "total"}),
    ],
)  # fmt: skip
def test_numbers_survive_the_csv_files_to_the_last_bit(tree, reports, file, column, variable, places):
    found = read_csv(reports["wheel-on-rail"] / f"{file}.csv")
    assert np.array_equal(found[column], tree[variable].sel(places).values, equal_nan=True)
    assert file != "pass_by_level" or not any("wheel" in head for head in found)  # it is rigid


def test_force_spectrum_carries_the_marks_of_the_track(tree):
    bay = tree["rolling"].attrs["speed"] / tree["track"].attrs["sleeper_spacing"]
    split = tree["track"].attrs["pinned_pinned_frequency"] + bay / 2 * np.array([-1, 1])
    assert rules_of(tree, "force_psd") == pytest.approx(split.tolist())
    tones = rules_of(tree, "force_psd", short=True)
    axis = panels_of(tree, "force_psd")[0].x
    first, last = np.ceil(axis.low / bay), min(np.floor(axis.high / bay), 12)  # further ones would crowd
    assert list(tones) == pytest.approx(bay * np.arange(first, last + 1))
    caption = PARTS["force_psd"].drawn(tree).caption
    assert f"every {bay:.1f} Hz" in caption
    assert f"{split[0]:.0f} and {split[1]:.0f} Hz" in caption
    assert rules_of(tree, "pass_by_level", short=True) == [0.0]


@pytest.mark.parametrize("name", ["receptance", "decay_rate"])
def test_track_frequencies_are_marked_and_named(tree, name):
    named = {"antiresonance": "anti-resonance", "cut_on": "cut-on", "pinned_pinned": "pinned–pinned"}
    marks = {tree["track"].attrs[f"{key}_frequency"]: label for key, label in named.items()}
    assert rules_of(tree, name) == sorted(marks)
    told = {f"{label}, {frequency:.0f} Hz" for frequency, label in marks.items()}
    assert {note.text for note in marks_of(tree, name, Note)} == told


def test_sleepers_are_marked_where_the_wheel_passes_them(other):
    rolling, sleepers = other["rolling"].to_dataset(), other["track"].attrs["sleeper_spacing"]
    rolling["position"] = rolling["position"] + 0.2
    other["rolling"] = rolling
    for panel in range(len(panels_of(other, "displacement"))):
        seconds = 1e-3 * np.array(rules_of(other, "displacement", short=True, panel=panel))  # drawn in ms
        places = np.interp(seconds, rolling["time"].values, rolling["position"].values) / sleepers
        assert len(places) >= 3
        assert places == pytest.approx(np.round(places), abs=1e-6)


def test_sound_power_is_tabulated(tree):
    table, levels = sound_power_table(tree), tree["spectra"].to_dataset()["sound_power_level_a"]
    names = ["law", "model", "rail", "rail sideways", "sleepers", "rail and sleepers", "wheel", "total"]
    assert table.head[:8] == names
    assert table.head[-2:] == ["over linear-filtered", "over linear"]
    rows = [[cell.text.replace("−", "-") for cell in row] for row in table.rows if "CNOSSOS" in row[1].text]
    for law, _, *cells in rows:
        expected = levels.sel(law=law).values
        np.testing.assert_allclose([float(cell) for cell in cells[3:6]], expected, atol=0.051)
        for baseline, cell in zip(("linear-filtered", "linear"), cells[-2:], strict=True):
            over = expected[-1] - float(levels.sel(law=baseline)[-1])
            assert cell == "–" if law == baseline else float(cell) == pytest.approx(over, abs=0.051)
    standard = tree["spectra"].to_dataset()["cnossos_sound_power_level_a"]
    assert [row[0] for row in rows] == list(levels["law"].values)
    last = [cell.text for cell in table.rows[-1]]
    assert last[:2] == ["CNOSSOS-EU", f"its contact filter, {standard.attrs['contact_filter']}"]
    assert last[5:8] == [f"{level:.1f}" for level in standard.values]


def test_contact_of_wheel_and_rail_is_outlined_by_its_ellipse(tree):
    sides = [2e3 * tree["contact"].attrs[f"hertz_radius{end}"] for end in ("", "_across")]
    outlines = marks_of(tree, "contact_pressure", Line)
    assert len(outlines) == 2  # dark on light: seen on every colour
    for outline in outlines:
        assert [np.ptp(outline.x), np.ptp(outline.y)] == pytest.approx(sides, rel=1e-3)
    assert "Hertz's contact (dashed)" in PARTS["contact_pressure"].drawn(tree).caption
    for name in ("force_envelope", "force_peak", "contact_force"):
        assert any(panel.y.label.endswith("/ kN") for panel in panels_of(tree, name))


def test_what_is_smooth_has_no_map_and_no_spectrum_and_bands_without_roughness_are_not_drawn(tree, other):
    for name in ("sample_heights", "psd_sample", "psd_path"):
        other["surface"][name].values[:] = 0.0
    names = ({part.name for part in figures_of(each)} for each in (tree, other))
    assert next(names) - next(names) == {"texture_sample", "texture_psd"}
    level = other["spectra"]["roughness_level"].values
    level[:] = np.linspace(20.0, 0.0, level.shape[1])
    level[:, :5] = -130.0
    level[1, 12] = -100.0
    lines = {line.label: line.y for line in marks_of(other, "roughness", Line)}
    assert np.array_equal(lines["rail"], level[0, 5:])
    assert np.isnan(lines["wheel"][7])
    assert len(PARTS["roughness"].collect(other).at) == level.shape[1]


@pytest.mark.parametrize("end", [None, 0, -1])
def test_piece_around_the_peak_holds_it_and_stays_inside(other, end):
    rolling = other["rolling"].to_dataset()
    middle = rolling.sizes["time"] // 2
    rolling["contact_force"].values[..., middle if end is None else end] = 1e6
    other["rolling"] = rolling
    part, peak = around_peak(other), int(np.argmax(rolling["contact_force"].sel(law="areal").values))
    assert part.start <= peak < part.stop <= rolling.sizes["time"]
    assert (part.start == 0) == (end == 0)
    assert (part.stop == rolling.sizes["time"]) == (end == -1)
    step = float(rolling["time"][1])
    assert (part.stop - part.start) * step == pytest.approx(AROUND_PEAK, abs=step)
    assert f"{rolling['time'].values[peak]:.4f} s" in PARTS["force_peak"].drawn(other).caption


def test_passed_points_are_named_by_their_place_in_the_bay(other):
    rolling = other["rolling"].to_dataset().drop_dims("point")
    other["rolling"] = rolling.assign_coords({"point": [1.2, 1.5, 1.65]})
    assert point_labels(other) == ["x = 1.2 m, over a sleeper", "x = 1.5 m, mid-span", "x = 1.65 m"]


def test_wavelengths_that_say_little_are_shaded_and_in_the_csv_file(other):
    product = other["spectra/surface_band_length_product"].values
    product[:] = 100.0
    assert not marks_of(other, "roughness", Boxes)
    product[:4] = 9.9
    (box,) = marks_of(other, "roughness", Boxes)
    drawn, lines = PARTS["roughness"].drawn(other), PARTS["roughness"].collect(other)
    assert "Shaded" in drawn.caption
    assert box.left < lines.at[:4].min() < lines.at[:4].max() < box.right
    assert drawn.columns["level says something [1]"].tolist() == [0.0] * 4 + [1.0] * (len(product) - 4)


def test_the_passage_follows_from_the_sound_power(tree):
    """SEL of an axle in each band: L_W + 10 lg(ρc/(2 d v)/(4e-10 Pa² s/W)), d² = 7.5² + 1.2² for the rail."""
    power = tree["spectra/radiated_power_level"].sel(radiator="rail")
    exposed = tree["pass_by/sound_exposure_level"].sel(radiator="rail")
    away = 413.0 * 1e-12 / (2.0 * np.hypot(7.5, 1.2) * tree["rolling"].attrs["speed"]) / 4e-10
    np.testing.assert_allclose(exposed.values, power.values + 10.0 * np.log10(away), atol=1e-6)


def test_motion_of_passed_points_is_marked_when_the_wheel_passes(tree):
    rolling = tree["rolling"].to_dataset()
    for n, point in enumerate(rolling["point"].values[: len(panels_of(tree, "rail_velocity"))]):
        passed = 1e3 * np.interp(point, rolling["position"], rolling["time"])
        assert rules_of(tree, "rail_velocity", panel=n) == pytest.approx([passed])
        at = marks_of(tree, "rail_velocity", Line, n)[0].x
        assert at[0] <= passed <= at[-1]


# --- studies of wheels


@pytest.fixture
def study(tree):
    """Table of a study of two speeds, which gave the same."""
    return study_over(tree, speed=[56.0, 60.0])


def study_over(tree, **axes):
    """Table of a study whose members all gave the same."""
    table = kept(tree).expand_dims({key: len(values) for key, values in axes.items()})
    for key, values in axes.items():
        table[key] = (key, values, {"units": "m/s", "long_name": key})
    return table.assign_attrs(sweep=json.dumps(axes))


def test_a_study_shows_the_sound_of_rail_sleepers_and_wheel_and_the_pass_by(tree, study, capsys):
    """In the terminal; what is missing throughout, as the sound of a rigid wheel, only if it is asked for."""
    one = study.isel(speed=[0])
    print_table(one, USUAL, asked=False)
    said = " ".join(capsys.readouterr().out.replace("┃", " ").replace("│", " ").split())
    for words in ("rail", "sleepers", "total", "pass by", "maximum level"):
        assert words in said
    assert "wheel" not in said
    print_table(one, ("radiated_power_level_a",), asked=True)
    assert "wheel" in capsys.readouterr().out
    heading, rows = columns_of(one, bands=False)
    for name in ("rail", "sleepers", "wheel", "total"):
        assert f"radiated_power_level_a {name} [dB(A) re 1 pW]" in heading
    column = heading.index("pass_by_maximum_level [dB(A) re 20 uPa]")
    expected = tree["pass_by/pass_by_maximum_level"].sel(radiator="total").values
    assert [row[column] for row in rows] == list(expected)


@pytest.mark.parametrize(("count", "shown"), [(6, 6), (7, 6), (11, 6)])
def test_lines_of_a_study_reach_from_first_to_last_and_captions_say_what_is_left_out(tree, count, shown):
    """Seven speeds had a line each for the first six, below "a line for each speed"."""
    speeds = np.linspace(20.0, 80.0, count).tolist()
    table = study_over(tree, speed=speeds, load=[1.0, 2.0])
    left = f"{shown} of {count} values of speed are shown; the CSV file has all." if shown < count else None
    drawn = {
        name: list(parts)
        for key in ("load", "speed")
        for name, _, parts in key_figures(table, None, key, {}, ["rms_force"])
    }
    for name in ("key-load", "bands-speed"):
        panel, *words = drawn[name]
        labels = [mark.label for mark in panel.marks if getattr(mark, "label", "")]
        assert len(labels) == shown
        assert [label.split()[-2] for label in (labels[0], labels[-1])] == ["20", "80"]
        assert [each for each in words if " are shown" in each] == [*filter(None, [left])]
    for name in ("key-speed", "bands-load"):
        assert not any(isinstance(part, str) and " are shown" in part for part in drawn[name])


def test_quantities_that_a_figure_leaves_out_are_counted(study):
    names = [name for name in study if "band" not in study[name].dims and study[name].dtype.kind == "f"]
    told = [part for _, _, parts in key_figures(study, None, "speed", {}, names) for part in parts]
    panels = [part for part in told if not isinstance(part, str)]
    (words,) = [part for part in told if isinstance(part, str) and "quantities" in part]
    assert words.startswith("6 of ")
    assert len(panels) == 6 + 1  # and levels by band


def test_the_figure_of_a_study_draws_sound_and_nothing_that_is_zero_throughout(study):
    assert not study["contact_loss_share"].values.any()
    figures = {
        name: [part for part in parts if not isinstance(part, str)]
        for name, _, parts in key_figures(study, None, "speed", {}, USUAL_IN_FIGURES)
    }
    panels = {panel.title: panel for shown in figures.values() for panel in shown}
    for shown in figures.values():  # no legend mixes laws, what radiates, and values of keys
        told = [
            tuple(sorted(line.label for line in panel.marks if getattr(line, "label", ""))) for panel in shown
        ]
        assert len({bool({"rail", "total"} & {*labels}) for labels in told}) == 1
    assert "bands-speed" in figures
    assert panels["L_pAFmax"].y.label == "dB(A) re 20 µPa"
    assert not any("without contact" in title for title in panels)
    sound = panels["sound power level from the vibration itself, areal"]
    for line in sound.marks:
        power = study["radiated_power_level_a"].isel(law=0).sel(radiator=line.label)
        np.testing.assert_array_equal(line.y, power)
    assert [line.label for line in sound.marks] == [
        "rail",
        "rail sideways",
        "sleepers",
        "total",
    ]  # the wheel is rigid


def test_a_sentence_says_where_a_study_is_quietest_and_loudest(study):
    level = study["radiated_power_level_a"].isel(law=0).sel(radiator="total").values
    assert level[0] == level[1]
    low, high = (
        f"{level[0] - n:.1f} dB(A) re 1 pW at speed {typed_words(study['speed'])[n]}" for n in (0, 1)
    )
    told = "A-weighted sound power level from the vibration itself, areal, total"
    assert ends_in_words(study, LOUDNESS) == f"{told}: {low}."  # nowhere else it is another one
    less = xarray.DataArray([0.0, 1.0], dims="speed")
    quieter = study.assign(radiated_power_level_a=study["radiated_power_level_a"] - less)
    assert ends_in_words(quieter, LOUDNESS) == f"{told}: from {high} to {low}."
    assert ends_in_words(study, ["nothing"]) == ""
    beside = ends_in_words(study.drop_vars("radiated_power_level_a"), LOUDNESS)
    assert " re 20 µPa" in beside  # what is heard is told before the force


def test_the_numbers_of_a_figure_begin_with_the_main_law(tree):
    """12 of 54 columns of the sound power were without its total."""
    drawn = PARTS["radiated_power_bands"].drawn(tree)
    (table,) = drawn.numbers
    assert "total, areal [dB re 1 pW]" in table.head
    assert len(table.head) < len(drawn.columns)


def test_what_a_study_of_wheels_may_be_asked_to_show_is_what_it_keeps(tree):
    found, known = {str(name) for name in kept(tree).data_vars}, names_kept()
    assert found - {"point_position", "force_level_difference_to_reference_a"} <= known
    assert set(USUAL) <= known
    asked = chosen(["peak_force, pass by maximum level"])
    assert asked == ("peak_force", "pass_by_maximum_level")


def test_the_caption_says_which_bands_roughness_covers_at_the_speed(other):
    level = other["spectra"]["roughness_level"].values
    level[:] = -130.0
    wavelength = other["spectra"]["surface_band"].values
    shown = (wavelength < 0.32) & (wavelength > 0.09)
    level[:, shown] = 0.0
    frequency = other["rolling"].attrs["speed"] / wavelength[shown]
    bands = 10.0 ** (np.arange(20, 38) / 10.0)
    covered = int(np.sum((bands > frequency.min() * 0.89) & (bands < frequency.max() * 1.123)))
    caption = PARTS["roughness"].drawn(other).caption
    assert f"{covered} of the 18 one-third octaves from 100 Hz to 5 kHz; in the others" in caption
