"""Runs over an embedded rail, and over blocks with a measured pad and rail dampers: numbers and figures."""

from pathlib import Path

import numpy as np
import pytest

import asperity
from asperity.reporting import data
from asperity.scenes import schema
from asperity.scenes.report import figures_of
from small_cases import WHEEL

PAD = Path(__file__).parents[2] / "examples" / "pad_stiffness.csv"
DAMPERS = {"rail_damper_mass": "15 kg", "rail_damper_frequency": "900 Hz", "rail_damper_loss_factor": 0.35}
TRACKS = {
    "embedded": {"name": "embedded"},
    "blocks": {"name": "slab-blocks", "pad_table": str(PAD), **DAMPERS},
}


@pytest.fixture(scope="module", params=TRACKS)
def run(request):
    case = {**WHEEL, "laws": ["linear"], "duration": "0.1 s", "track": TRACKS[request.param]}
    return request.param, asperity.run(case)


def test_the_linear_law_is_its_reference_in_frequency(run):
    """Above 500 Hz, where 0.1 s are long; there neither motion nor what stands for losses changes much."""
    spectra = run[1]["spectra"]
    level, reference = spectra["force_level"].sel(law="linear"), spectra["linear_reference_level"]
    high = (level["band"] > 1200.0).values
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
