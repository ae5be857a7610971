"""Runs over bays that differ, an embedded rail, and blocks with measured pads and rail dampers."""

from pathlib import Path

import numpy as np
import pytest

import asperity
from asperity.case.bodies import WheelOnRail
from asperity.case.cases import read_case
from asperity.errors import CaseError
from asperity.reporting import chart, data
from asperity.running import prepare_case
from asperity.scenarios.preparing import expect
from asperity.scenarios.run_time import SOUND_OF_BAY, pace
from asperity.scenes import schema
from asperity.scenes.figures.track import receptance, sleeper_times, sleepers_between
from asperity.scenes.report import figures_of
from asperity.scenes.track import planned_track
from refusals import refusals
from small_cases import HEARD, WHEEL

COARSE = {"highest_frequency": "2 kHz", "kernel": "scatter"}
CASE = HEARD | {"speed": "30 m/s", "duration": "0.12 s", "numerics": COARSE}
BAYS = np.array([[0.5, 2e8, 4e7], [0.65, 1.6e8, 1e3], [0.62, 1.8e8, 5e7]])  # the second sleeper hangs


def over(**track):
    return WheelOnRail(**CASE | {"track": {"name": "uic60"} | track})


@pytest.fixture(scope="module")
def varied(runs):
    return runs(over(bay_table=BAYS))


def test_equal_bays_give_the_run_of_one(runs):
    one, cell = runs(over()), runs(over(bays=2))
    for name in ("contact_force", "rail_displacement"):
        expected = one["rolling"][name].values
        assert np.abs(cell["rolling"][name].values - expected).max() < 1e-9 * np.abs(expected).max()
    for name in ("radiated_power_level", "linear_reference_level", "sound_power_level"):
        np.testing.assert_allclose(cell["spectra"][name], one["spectra"][name], rtol=1e-6)
    moved, expected = (tree["rolling/point_displacement"].values for tree in (cell, one))
    assert np.abs(moved - expected).max() < 1e-5 * np.abs(expected).max()  # far bays in single precision


def test_bays_are_told_and_drawn(varied):
    track = varied["track"].to_dataset()
    np.testing.assert_allclose(track["bay_length"], BAYS[:, 0])
    np.testing.assert_allclose(track["bay_pad_stiffness"], BAYS[:, 1])
    np.testing.assert_allclose(track["bay_ballast_stiffness"], BAYS[:, 2])
    assert track.attrs["sleeper_spacing"] == pytest.approx(0.59)
    assert "scattered from the moving kernel" in varied["scenario"].attrs["numerics"]
    assert "first of 3 bays" in receptance.drawn(varied).caption
    assert sleepers_between(varied, -1.5, 2.0, 0.59) == pytest.approx([-1.27, -0.62, 0.0, 0.5, 1.15, 1.77])
    (rules,) = sleeper_times(varied, 0.0, 0.05, 1.0)
    assert isinstance(rules, chart.Rules)
    assert rules.at == pytest.approx([0.0, 0.5 / 30.0, 1.15 / 30.0], abs=1e-9)


def test_the_wheel_falls_where_a_sleeper_hangs(varied):
    """The points are over the sleeper nearest to the middle of the record, 1.8 m on, and behind it."""
    assert varied["rolling"]["point"].values == pytest.approx([1.77, 2.02])
    down, place = (varied["rolling"][name].values.squeeze() for name in ("rail_displacement", "position"))
    phase = np.mod(place, 1.77)
    hanging, firm = (down[np.abs(phase - at) < 0.05].mean() for at in (0.5, 1.15))
    assert hanging > 1.1 * firm


def test_a_table_of_bays_is_read_in_its_units(tmp_path):
    rows = "\n".join(f"{length}, {pad / 1e6}, {ballast / 1e6}" for length, pad, ballast in BAYS.tolist())
    heading = "spacing (m), pad stiffness (MN/m), ballast stiffness (MN/m)"
    (tmp_path / "bays.csv").write_text(f"{heading}\n{rows}\n")
    text = 'kind = "wheel-on-rail"\n[surface]\nspectrum = "iso3095"\n'
    text += '[track]\nname = "uic60"\nbay_table = "bays.csv"\n'
    (tmp_path / "case.toml").write_text(text)
    case = read_case(tmp_path / "case.toml")
    track, same = case.track.model(), over(bay_table=BAYS).track.model()
    assert track.bays.ballast == pytest.approx(same.bays.ballast)
    assert (track.period, track.cell_bays) == pytest.approx((1.77, 3))
    told = {each["key"]: each["value"] for each in case.parameters()}
    assert told["track.sleeper_spacing"] == "0.59 m"


test_bays_that_cannot_be_are_refused = refusals(
    ({"spacing_scatter": 0.1}, "spacing_scatter.*only together with bays"),
    ({"bays": 1}, "track.bays.*at least 2"),
    ({"bays": 101}, "track.bays.*at most 100"),
    ({"bays": 20, "spacing_scatter": 0.4}, "spacing_scatter.*at most 0.3"),
    ({"bays": 100, "ballast_scatter": 0.9}, "track.ballast_scatter: received -.*in bay.*Lower its scatter"),
    ({"bays": 20, "bay_table": BAYS}, "both bay_table and bays"),
    ({"sleeper_spacing": 0.6, "bay_table": BAYS}, "both bay_table and sleeper_spacing"),
    ({"bay_table": BAYS * [1, 1, 0]}, "ballast stiffness of 0 N/m in bay 1.*hangs"),
    ({"bay_table": BAYS * [[1], [-1], [1]]}, "spacing of -0.65 m in bay 2"),
    ({"bay_table": BAYS * np.nan}, "not finite"),
    ({"bay_table": np.tile(BAYS, (34, 1))}, "102 bays.*at most 100"),
    ({"bay_table": BAYS[:, :2]}, "shape"),
    ({"bays": 4, "continuous": True}, "equal bays"),
    of=lambda keys: over(**keys),
    error=CaseError,
)


def test_the_plan_counts_bays_and_time():
    case = over(bays=8, spacing_scatter=0.05)
    prepared, regular = prepare_case(case), prepare_case(over())
    rows = dict(planned_track(prepared))
    assert "8 in 4.8 m, then they repeat" in rows["bays that differ"]
    assert "bays that differ" not in dict(planned_track(regular))
    work = [expect(each, lambda *_: None).time for each in (prepared, regular)]
    kernels = [each.parts["the moving kernel"] for each in work]
    assert kernels[0] == pytest.approx(8 * kernels[1])
    of_bays = (work[0].parts["the track"] - work[1].parts["the track"]) / pace()
    assert of_bays == pytest.approx(8 * SOUND_OF_BAY, rel=1e-9)


PAD = Path(__file__).parents[2] / "examples" / "pad_stiffness.csv"
DAMPERS = {"rail_damper_mass": "15 kg", "rail_damper_frequency": "900 Hz", "rail_damper_loss_factor": 0.35}
TRACKS = {
    "embedded": {"name": "embedded"},
    "blocks": {"name": "slab-blocks", "pad_table": str(PAD), **DAMPERS},
}


@pytest.fixture(scope="module", params=TRACKS)
def run(request):
    fine = {"highest_frequency": "4 kHz", "kernel": "scatter"}
    case = {
        **WHEEL,
        "laws": ["linear"],
        "duration": "0.1 s",
        "track": TRACKS[request.param],
        "numerics": fine,
    }
    return request.param, asperity.run(case)


def test_the_linear_law_is_its_reference_in_frequency(run):
    """Above 2 kHz, where 0.1 s are long and bays ring no more; motion and losses change little there."""
    spectra = run[1]["spectra"]
    level, reference = spectra["force_level"].sel(law="linear"), spectra["linear_reference_level"]
    high = (level["band"] > 1900.0).values
    assert np.abs((level - reference).values[high]).max() < 0.35


def test_what_there_is_not_is_left_out(run):
    name, tree = run
    facts = (
        schema.PINNED_PINNED_FREQUENCY,
        schema.SLEEPER_PASSING_FREQUENCY,
        schema.PINNED_PINNED_LOW,
        schema.ANTIRESONANCE_FREQUENCY,
    )
    assert all((data.number(tree, fact) is None) == (name == "embedded") for fact in facts)
    sleepers = tree["spectra/radiated_power_level"].sel(radiator="sleepers").values
    assert np.isnan(sleepers).all() == (name == "embedded")
    why = tree["spectra/radiated_power_level"].attrs["missing"]
    assert why.startswith("no sleeper moves" if name == "embedded" else "of this wheel it is not known")
    assert np.isfinite(tree["spectra/radiated_power_level_a"].sel(radiator="rail").values).all()


def test_losses_and_pads_are_drawn(run):
    name, tree = run
    drawn = {figure.name: figure for figure in figures_of(tree)}
    assert drawn["loss_factors"].chart.panels
    scene = drawn["scene"].chart.panels[0]
    pads = [mark for mark in scene.marks if getattr(mark, "fill", "") == "#5b6670"]
    assert len(pads) == (1 if name == "embedded" else 5)
