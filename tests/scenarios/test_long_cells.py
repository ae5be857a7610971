"""Cells that are two rows of the grid long, on which paths of tracks are scanned."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import polynomial

from asperity.running import prepare_case
from asperity.scenarios.laws import reduced_case
from asperity.scenarios.long_cells import long_cells_fit
from asperity.scenarios.preparing import scans_of
from asperity.surfaces.second_rows import REACH, SecondRows, every_second
from asperity.surfaces.strip import Rows
from small_cases import changed


def wheel(**keys):
    surface = {"spectrum": "iso3095", "lateral": 1.0}
    contact = {"samples": 2, "spacing": "0.5 mm", "window": "20 mm"} | keys.pop("contact", {})
    given = {"laws": ["table"], "duration": "5 ms", "settling": "0.1 s", "surface": surface}
    return prepare_case(changed("wheel-on-rail", wheel={"load": "65 kN"}, contact=contact, **(given | keys)))


@pytest.fixture(scope="module")
def reduced():
    return reduced_case(wheel(), lambda *_: None)


def test_thinning_keeps_polynomials_and_long_waves_and_takes_short_ones_off():
    """Rows beside each other are half a sample apart: (1 + interpolation from odd rows) / 2 of a wave."""
    rows = np.arange(60.0)
    quintic = polynomial.polyval(rows / 60.0, [0.3, -2.0, 1.0, 4.0, -1.5, 2.5])[:, None]
    np.testing.assert_allclose(every_second(quintic, REACH, 25), quintic[REACH : REACH + 50 : 2], atol=1e-13)
    for waves, left in ((16.0, 0.9994), (10.0, 0.9924), (4.0, 0.5), (2.5, 0.0076), (2.0, 0.0)):
        found = every_second(np.cos(2.0 * np.pi * rows / waves)[:, None], REACH, 25)[:, 0]
        expected = left * np.cos(2.0 * np.pi * (REACH + 2.0 * np.arange(25)) / waves)
        np.testing.assert_allclose(found, expected, atol=1e-4)


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("count", [40, 41])
def test_pieces_of_a_thinned_strip_are_those_of_the_whole(first, count):
    heights = np.random.default_rng(3).standard_normal((count, 3))
    strip = SecondRows(Rows(heights, (0.5, 0.25)), first)
    assert strip.shape == (len(heights[first::2]), 3)
    assert strip.spacing == (1.0, 0.25)
    every = strip.rows(0, strip.shape[0])
    inside = heights[first + 6 - REACH : first + 6 + 2 * 8 + REACH]
    np.testing.assert_allclose(every[3:11], every_second(inside, REACH, 8), atol=1e-15)
    for begin, stop in ((0, 1), (2, 9), (strip.shape[0] - 3, strip.shape[0])):
        np.testing.assert_allclose(strip.rows(begin, stop), every[begin:stop], atol=1e-15)


def test_long_cells_of_a_smooth_wheel_have_the_stiffness_of_hertz(reduced):
    """Cells along are half as many, across as they were, and the middle of the gap stays one."""
    shape = reduced.scanning.shape
    assert shape.cells == "covered"
    assert shape.spacing == (2.0 * reduced.shape.spacing[0], reduced.shape.spacing[1])
    assert np.unravel_index(np.argmin(shape.body), shape.body.shape) == tuple(
        n // 2 for n in shape.body.shape
    )
    narrower = replace(reduced.shape, body=reduced.shape.body[1:-1]).on_long_cells().body
    assert np.argmin(narrower.min(axis=1)) == len(narrower) // 2 != len(reduced.shape.body) // 4
    space, hertz = shape.half_space(None), shape.hertz
    for approach in hertz.approach(shape.load) * np.linspace(0.9, 1.1, 15):
        solved = space.solve(shape.body, approach, rtol=1e-8)
        assert solved.force == pytest.approx(hertz.force(approach), rel=6e-4)
        stiffness = space.tangent_stiffness(solved.pressure)
        assert stiffness == pytest.approx(hertz.tangent_stiffness(approach), rel=4e-3)


def test_a_path_scanned_on_long_cells_has_the_forces_of_cells_of_one_row(reduced):
    """At the same places, under the same planes: the waves that are lost lift the bodies alike all along."""
    scanning = reduced.scanning
    state = reduced.to_look_up[reduced.scanned][1]
    rows = scanning._scanned_rows
    assert rows.step == 2
    found = scanning._scan_of(state, None).forces[0]
    half = len(scanning.shape.body) // 2
    middles = reduced.textures.before % 2 + 2 * (rows.start + half + rows.step * np.arange(60))
    count = len(reduced.shape.body)
    space = reduced.seeing.shape.half_space(None)
    expected = []
    for middle in middles:
        window = middle - count // 2
        gap = reduced.seeing.shape.body - reduced.seeing.textures.path.rows(window, window + count)
        approach = reduced.reduction.approaches[state] + reduced.plane.heights[0][middle]
        expected.append(space.solve(gap, approach, rtol=1e-8).force)
    places = reduced.textures.start + reduced.shape.spacing[0] * middles
    for table in (scanning._table(), reduced.build("table").table):
        assert table.start == pytest.approx(places[0], abs=1e-9)
        assert table.spacing == pytest.approx(places[1] - places[0])
        np.testing.assert_array_equal(table.forces[1], found)
    off = found[:60] / np.array(expected) - 1.0
    assert -2e-3 < off.mean() < 1e-4
    assert off.std() < 4e-4


def test_long_cells_are_for_what_is_smooth_and_long_against_them():
    made = wheel()
    assert made.has_long_cells
    assert made.rim_cells == "covered for table, two rows long where the path is scanned"
    assert wheel(laws=["direct"]).rim_cells == "covered for direct"
    job = scans_of(made, np.linspace(0.0, 1e-4, 16))["path"][0]
    assert job.body.shape == (len(made.shape.body) // 2 // 2 * 2 + 1, made.shape.body.shape[1])
    wave = 16.0 * made.shape.spacing[0]
    assert long_cells_fit(made.shape, 0.05, wave)
    assert not long_cells_fit(made.shape, 0.051, wave)
    assert not long_cells_fit(made.shape, 0.05, 0.99 * wave)
    across = replace(made.shape, spacing=(made.shape.spacing[0], 2.0 * made.shape.spacing[1]))
    assert not long_cells_fit(across, 0.0, math.inf)
    for keys in (
        {"contact": {"rim_cells": "covered"}},
        {"contact": {"rim_cells": "whole"}},
        {"contact": {"hardness": "3 GPa"}},
        {"speed": "28 m/s"},
        {"surface": {"spectrum": "iso3095", "lateral": 1.0, "joint_depth": "1 mm", "joint_length": "0.1 m"}},
    ):
        other = wheel(**keys)
        assert not other.has_long_cells
        assert other.scanning.shape.spacing == other.shape.spacing
    ball = prepare_case(
        changed("ball-on-beam", laws=["table"], surface={"rms": "0.02 um", "longest": "0.4 mm"})
    )
    assert ball.cells_of_heights == "covered"
    assert not ball.has_long_cells
