"""The report of a wheel on a rail: its figures, marks, tables and numbers."""

from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib.text import Text

from asperity.kinds.ball_on_beam.chapters import CHAPTERS as BALL_ON_BEAM
from asperity.kinds.report import chapters_of, page_of, parts_of, report
from asperity.kinds.wheel_on_rail.chapters import CHAPTERS as WHEEL_ON_RAIL
from asperity.kinds.wheel_on_rail.figures.force import AROUND_PEAK, around_peak
from asperity.kinds.wheel_on_rail.figures.motion import point_labels
from asperity.kinds.wheel_on_rail.figures.noise import sound_power_table
from asperity.reporting import style
from report_reading import HOSTILE, Reader, read_csv
from report_tree import report_tree
from report_wheel_tree import LAWS, PINNED, SLEEPERS, SPEED, wheel_tree

PARTS = {part.name: part for chapter in WHEEL_ON_RAIL for part in chapter.parts}
OWN = ("track", "noise", "motion")  # chapters that a ball has not


@pytest.fixture(scope="module")
def tree():
    return wheel_tree()


@pytest.fixture(scope="module")
def folder(tree, tmp_path_factory):
    return report(tree, tmp_path_factory.mktemp("wheel")).parent


@pytest.fixture(scope="module")
def text(folder):
    return (folder / "report.html").read_text(encoding="utf-8")


def small(laws=("areal", "linear"), **changes):
    """Tree of a short run; `changes` map a group to the variables dropped from it."""
    tree = wheel_tree(list(laws), steps=4000)
    for group, names in changes.items():
        tree[group] = tree[group].to_dataset().drop_vars(names)
    return tree


def without_attrs():
    """Tree of a short run that states nothing beside its variables, but for its kind."""
    tree = small()
    for group in tree.children:
        tree[group].attrs = {}
    tree["scenario"].attrs = {"kind": "wheel-on-rail"}
    return tree


def lines_at(axes):
    """Places of the vertical lines of a panel."""
    found = [line.get_xdata() for line in axes.lines if len(line.get_xdata()) == 2]
    return [x[0] for x in found if x[0] == x[1]]


def ticks_of(axes):
    (ticks,) = [line.get_xdata() for line in axes.lines if line.get_label() == "_ticks"]
    return ticks


def test_kind_of_case_chooses_the_chapters(tree):
    assert chapters_of(tree) == WHEEL_ON_RAIL
    assert chapters_of(report_tree(["areal"], steps=500)) == BALL_ON_BEAM
    ball = {part.name for chapter in BALL_ON_BEAM for part in chapter.parts}
    assert not {"receptance", "roughness", "sound_power", "displacement"} & ball


def test_result_without_a_kind_is_known_by_its_track():
    tree = without_attrs()
    tree["scenario"].attrs = {}
    assert chapters_of(tree) == WHEEL_ON_RAIL


@pytest.mark.parametrize("laws", [["linear"], ["table"], ["direct", "hertz-filtered", "linear"]])
def test_any_set_of_laws(laws):
    tree = small(laws)
    for name in ("force_envelope", "force_peak", "force_psd", "force_bands", "sound_power", "displacement"):
        labels = [label.get_text() for label in PARTS[name].draw(tree).findobj(Text)]
        assert all(any(law in label for label in labels) for law in laws)
    assert sound_power_table(tree) is not None


def test_hostile_names_stay_text():
    tree = small()
    tree["rolling"] = tree["rolling"].to_dataset().assign_coords(law=[HOSTILE, "linear"])
    names = {"law": [HOSTILE, "linear"], "part": [HOSTILE, "b", "c"], "source": [HOSTILE, "b", "total"]}
    tree["spectra"] = tree["spectra"].to_dataset().assign_coords(names)
    tree["track"].attrs["kernel_method"] = HOSTILE
    del tree["surface"], tree["contact"]
    reader = Reader(page_of(tree))
    assert not reader.open
    assert not {"script", "img"} & {tag for tag, _ in reader.tags}
    assert "".join(reader.text).count(HOSTILE) > 10


def test_numbers_survive_the_csv_files_to_the_last_bit(tree, folder):
    spectra, track = tree["spectra"].to_dataset(), tree["track"].to_dataset()
    psd, bands = read_csv(folder / "force_psd.csv"), read_csv(folder / "force_bands.csv")
    for law in LAWS:
        assert np.array_equal(psd[f"{law} [N^2/Hz]"], spectra["force_psd"].sel(law=law).values)
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
    kernel = read_csv(folder / "moving_kernel.csv")["kernel(start=0.3 m) [m/(N s)]"]
    assert np.array_equal(kernel, track["moving_kernel"].sel(start_position=0.3).values)


UNITS = r"m|1/m|m\^3|m/N|rad|m/\(N s\)|Pa|N|N/m|1|s|Hz|m/s|N\^2/Hz|\(m/s\)\^2/Hz"
LEVELS = r"dB|dB/m|dB re 1 N|dB re 1 µm|dB re 1 pW|dB\(A\) re 1 pW"


def test_smooth_surface_has_no_map_and_no_spectrum():
    tree = small()
    for name in ("sample_heights", "psd_sample", "psd_path"):
        tree["surface"][name].values[:] = 0.0
    drawn = {part.name for part in parts_of(tree)}
    assert set(PARTS) - drawn == {"texture_sample", "texture_psd"}


def test_bands_without_roughness_are_not_drawn():
    tree = small()
    level = tree["spectra"]["roughness_level"].values
    level[:, :5] = -130.0
    level[1, 12] = -100.0
    axes = PARTS["roughness"].draw(tree).axes[0]
    rail, wheel = (next(x for x in axes.lines if x.get_label() == name) for name in ("rail", "wheel"))
    assert np.array_equal(rail.get_ydata(), level[0, 5:])
    assert np.isnan(wheel.get_ydata()[7])
    assert len(PARTS["roughness"].columns(tree)["wavelength [m]"]) == level.shape[1]


def test_force_spectrum_carries_the_marks_of_the_track(tree):
    axes = PARTS["force_psd"].draw(tree).axes[0]
    assert lines_at(axes) == pytest.approx([PINNED - SPEED / 1.2, PINNED + SPEED / 1.2])
    tones = ticks_of(axes)
    assert tones == pytest.approx(SPEED / SLEEPERS * np.arange(1, len(tones) + 1))
    assert axes.get_xlim()[1] - tones[-1] < SPEED / SLEEPERS
    caption = PARTS["force_psd"].caption(tree)
    assert "every 93.3 Hz" in caption
    assert "1016 and 1110 Hz" in caption


def test_drawn_force_spectrum_keeps_the_power(tree):
    axes = PARTS["force_psd"].draw(tree).axes[0]
    line = next(line for line in axes.lines if line.get_label() == "areal")
    spectra = tree["spectra"].to_dataset()
    drawn = np.mean(10 ** (line.get_ydata() / 10))
    count = 4 * len(line.get_xdata())  # lines 5 Hz apart, drawn every 20 Hz
    assert drawn == pytest.approx(spectra["force_psd"].sel(law="areal").values[1 : count + 1].mean())


@pytest.mark.parametrize("name", ["receptance", "decay_rate"])
def test_track_frequencies_are_marked_and_named(tree, name):
    figure = PARTS[name].draw(tree)
    assert lines_at(figure.axes[0])[-3:] == [225.0, 283.0, PINNED]
    labels = [label.get_text() for label in figure.findobj(Text)]
    assert {"anti-resonance, 225 Hz", "cut-on, 283 Hz", "pinned–pinned, 1063 Hz"} <= set(labels)


def test_sleepers_are_marked_where_the_wheel_passes_them(tree):
    for axes in PARTS["displacement"].draw(tree).axes:
        places = (0.3 + SPEED * ticks_of(axes)) / SLEEPERS
        assert len(places) > 5
        assert places == pytest.approx(np.round(places), abs=1e-6)


def test_piece_around_the_peak_holds_it(tree):
    rolling = tree["rolling"].to_dataset()
    peak = int(np.argmax(rolling["contact_force"].sel(law="areal").values))
    part = around_peak(tree)
    assert part.start < peak < part.stop
    assert (part.stop - part.start) * 2.5e-5 == pytest.approx(AROUND_PEAK, rel=1e-3)
    assert f"{rolling['time'].values[peak]:.4f} s" in PARTS["force_peak"].caption(tree)


@pytest.mark.parametrize("flat", [True, False])
def test_bars_of_lost_contact_are_drawn_where_it_is_lost(flat):
    part, tree = PARTS["force_peak"], wheel_tree(["areal", "linear"], steps=4000, flat=flat)
    assert len(part.draw(tree).axes) == 1 + flat
    assert ("Bars below" in part.caption(tree)) == flat


@pytest.mark.parametrize("peak", [0, 3999])
def test_piece_around_a_peak_at_an_end_stays_inside(peak):
    tree = small()
    tree["rolling"]["contact_force"].values[:, peak] = 1e6
    part = around_peak(tree)
    assert (part.start, part.stop)[peak > 0] == (0, 4000)[peak > 0]
    assert part.stop - part.start == 960


def test_passed_points_are_named_by_their_place_in_the_bay():
    tree = small()
    points = {"point": [1.2, 1.5, 1.65]}
    rolling = tree["rolling"].to_dataset().drop_dims("point")
    tree["rolling"] = rolling.assign_coords(points)
    assert point_labels(tree) == ["x = 1.2 m, over a sleeper", "x = 1.5 m, mid-span", "x = 1.65 m"]


def test_table_of_sound_power_holds_levels_and_differences(tree, text):
    body = text[text.index('id="sound_power_table"') :]
    rows = re.findall(r"<tr><td>(.*?)</td>(.*?)</tr>", body[: body.index("</table>")])
    assert [law for law, _ in rows] == [*LAWS, "CNOSSOS-EU"]
    levels = tree["spectra"].to_dataset()["sound_power_level_a"]
    for law, cells in rows[:-1]:
        shown = [cell.replace("−", "-") for cell in re.findall(r">([^<]+)</td>", cells)]
        expected = levels.sel(law=law).values
        assert [float(cell) for cell in shown[:3]] == pytest.approx(expected, abs=0.051)
        for place, baseline in enumerate(("linear-filtered", "linear"), start=1):
            differences = shown[3 * place : 3 * place + 3]
            if law == baseline:
                assert differences == ["–"] * 3
                continue
            over = expected - levels.sel(law=baseline).values
            assert [float(cell) for cell in differences] == pytest.approx(over, abs=0.051)


def test_bars_end_at_their_levels(tree):
    axes = PARTS["sound_power"].draw(tree).axes[0]
    levels = tree["spectra"].to_dataset()["sound_power_level_a"].values
    assert [bar.get_x() + bar.get_width() for bar in axes.patches] == pytest.approx(levels.ravel())


def test_contact_of_wheel_and_rail_is_outlined_by_its_ellipse(tree):
    axes = PARTS["contact_pressure"].draw(tree).axes[0]
    for outline in axes.patches:
        assert (outline.get_width(), outline.get_height()) == pytest.approx((12.4, 9.34))
    assert len(axes.patches) == 2  # dark on light: seen on every colour
    assert "dashed ellipse" in PARTS["contact_pressure"].caption(tree)


def test_large_forces_are_shown_in_kilonewtons(tree):
    for name in ("force_envelope", "force_peak", "contact_force"):
        assert any(axes.get_ylabel().endswith("/ kN") for axes in PARTS[name].draw(tree).axes)


def test_the_standard_stands_beside_the_laws(tree):
    table = sound_power_table(tree)
    last = [cell.text for cell in table.rows[-1]]
    first = tree["spectra/sound_power_level_a"].values[0]
    assert last[0] == "CNOSSOS-EU"
    assert last[1] == f"{first[0] - 1.5:.1f}"
    assert "50 kN, 920 mm" in table.note


@pytest.mark.parametrize(
    ("name", "variable"),
    [
        ("force_bands", "band_time_product"),
        ("sound_power_bands", "noise_band_time_product"),
        ("roughness", "surface_band_length_product"),
    ],
)
def test_bands_that_say_little_are_shaded_and_in_the_csv_file(name, variable):
    part, tree = PARTS[name], small()
    product = tree[f"spectra/{variable}"].values
    product[:] = 100.0
    assert not part.draw(tree).axes[0].patches
    product[:4] = 9.9
    assert len(part.draw(tree).axes[0].patches) == 1
    assert "Shaded" in part.caption(tree)
    columns = part.columns(tree)
    assert columns["B T of 10 or more [1]"].tolist() == [0.0] * 4 + [1.0] * (len(product) - 4)


def test_motion_is_compared_with_practice():
    drawn = PARTS["rail_velocity"].draw(small(("areal", "linear-filtered", "linear"))).axes[0]
    assert {line.get_label() for line in drawn.lines} >= {"areal", "linear-filtered"}
    assert "linear" not in {line.get_label() for line in drawn.lines}


def test_spectra_are_shaded_where_their_bands_say_little():
    tree = small()
    tree["spectra/band_time_product"].values[:] = 100.0
    for name in ("force_psd", "rail_velocity_psd"):
        assert not any(axes.patches for axes in PARTS[name].draw(tree).axes)
    tree["spectra/band_time_product"].values[:6] = 9.9
    for name in ("force_psd", "rail_velocity_psd"):
        assert all(len(axes.patches) == 1 for axes in PARTS[name].draw(tree).axes)
        assert "B T is below 10" in PARTS[name].caption(tree)


@pytest.mark.parametrize(
    ("path", "short"),
    [
        ("M 1.5 2 \nL 3 -4 \nL 5 6 \nz\n", "M1.5 2 3 -4 5 6z"),
        ("M 1 2 \nL 3 4 \nM 5 6 \nL 7 8 \n", "M1 2 3 4M5 6 7 8"),
        ("M 0 3 \nC 0.8 3 1.5 2.6 2 2 \nL 3 0 \nz\n", "M0 3C0.8 3 1.5 2.6 2 2L3 0z"),
    ],
)
def test_paths_of_drawings_keep_their_points(path, short):
    assert style.tight(path) == short
