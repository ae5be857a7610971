"""The example scripts: each asserts its own statement; here, that they run and what they find."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures("own_cache")

EXAMPLES = Path(__file__).parents[1] / "examples"


def run(name: str, folder: Path) -> dict[str, Any]:
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    numbers = module.main(folder)
    assert (folder / f"{name}.png").stat().st_size > 10_000
    return numbers


def test_rough_contact_is_softer_than_hertz(tmp_path):
    numbers = run("contact_stiffness", tmp_path)
    assert numbers["softening_at_working_load"] < 0.9
    # half of K_H √σ, of the ball of 25 mm over an rms height of 0.5 µm
    assert numbers["steepest_rise_rough"] < 0.5 * 4 / 3 * 115.4e9 * np.sqrt(25e-3 * 0.5e-6)


def test_filtering_grows_with_the_state(tmp_path):
    at_3_db = run("contact_filter", tmp_path)["wavenumber_at_3_db"]
    assert at_3_db[-1] < 0.5 * at_3_db[0]


def test_rough_beam_is_louder_and_rings_at_its_natural_frequencies(tmp_path):
    numbers = run("beam_acceleration", tmp_path)
    assert 10.0 < numbers["least_level_difference"] < 20.0
    # of a simply supported steel beam of 1 m and 10 mm height, 23.4 n² Hz lie below 5 kHz up to n = 14
    assert numbers["peaks_of_rough_beam"] == 14


def test_quick_start_carries_its_load_on_part_of_the_hertz_circle(tmp_path):
    numbers = run("quick_start", tmp_path)
    assert numbers["force"] == pytest.approx(30.0, rel=1e-5)
    assert 0.2 < numbers["share_of_hertz_circle"] < 1.0


def test_wheel_on_rail_filters_more_the_harder_it_is_pressed(tmp_path):
    numbers = run("wheel_contact", tmp_path)
    assert numbers["wavenumber_at_3_db"][-1] < 0.5 * numbers["wavenumber_at_3_db"][0]
    # half of K_H √σ with K_H of the wheel of 0.46 m on a rail head of 0.30 m, over 1 µm
    assert numbers["steepest_rise_rough"] < 0.5 * 9.413e10 * np.sqrt(1e-6)


def test_linear_contact_over_or_underestimates_by_its_stiffness(tmp_path):
    numbers = run("wheel_on_rail", tmp_path)
    # Hertz's k_t and approach of 78.1 µm at 65 kN; peaks of the samples stand up to 10 µm above their planes
    assert numbers["tangent_stiffness"] == pytest.approx(1.248e9, rel=0.02)
    assert 65e3 / 88e-6 < numbers["secant_stiffness"] < 65e3 / 78.1e-6
    assert numbers["shifted_over_k_t_a_weighted"] < 0.0 < numbers["printed_unfiltered_over_k_c_a_weighted"]
