"""A rail whose web bends: against one that keeps its form, a strip of plate, quadrature, finite elements."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import interpolate, linalg

from asperity import Track
from asperity.case.bodies import WheelOnRail
from asperity.fitting.tried import TriedCase
from asperity.observables import observable
from asperity.observables.observable import Measured
from asperity.scenes.measured import lateral_hammer_test
from asperity.scenes.sideways import Sideways
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.rail_web import webbed_waves
from refusals import refusals
from small_cases import HEARD

UIC60 = Track.named("uic60")
RAIL = LateralTrack(UIC60)
KEEPS = LateralTrack(UIC60, web_thickness=math.inf)
SECTION = RAIL.section
OMEGA = 2.0 * np.pi * np.array([40.0, 250.0, 700.0, 2000.0, 5000.0])


def test_head_foot_and_web_together_are_the_rail():
    """Mass, its moment, inertia and stiffness; and a force through the centre of twist does not twist."""
    beams, (_, foot, low, high, head, _) = SECTION.beams, SECTION.heights
    moved = np.array(
        [[1.0, 0.0, 1.0, 0.0], [head, 1.0, foot, 1.0]]
    )  # as a whole, and about the centre of twist
    whole = moved @ SECTION.mass @ moved.T
    mass, e = UIC60.mass_per_length, RAIL.centroid_height
    turning = RAIL.polar_inertia + mass * e**2
    assert_allclose(whole, [[mass, mass * e], [mass * e, turning]], rtol=1e-12)
    assert SECTION.web_mass == pytest.approx(7848.8 * 16.5e-3 * (high - low), rel=1e-4)
    for name in ("rotary_inertia", "bending_stiffness", "torsional_stiffness", "shear_stiffness"):
        assert getattr(beams, name).sum() == pytest.approx(getattr(RAIL, name), rel=1e-12)
    assert beams.bending_stiffness @ [head, foot] == pytest.approx(0.0, abs=1e-9 * RAIL.bending_stiffness)
    assert_allclose(moved @ SECTION.bent_web, 0.0, atol=1e-9 * np.abs(SECTION.bent_web).max())


def test_a_stiff_web_leaves_the_rail_that_keeps_its_form():
    """Where warping is free: all that bends is at the centre of twist, and the head shears for nothing."""
    flat = {"foot_centroid": 1e-8, "web_depth": 0.0, "head_centroid": 0.1, "polar_inertia": 0.4}
    track = LateralTrack(replace(UIC60, rail_loss_factor=0.05), web_thickness=16.5e-3, **flat)
    stiff = replace(track.section, web_stiffness=1e7 * track.section.web_stiffness)
    own = {"shear_stiffness": track.section.beams.shear_stiffness[1], "web_thickness": math.inf}
    usual = dict.fromkeys(("foot_centroid", "web_depth", "head_centroid"))
    keeps = replace(track, **own, **{name: getattr(LateralTrack, name) for name in usual})
    expected = keeps.free_waves(OMEGA)
    k, shapes, amplitudes = webbed_waves(stiff, OMEGA, keeps.track.rail.losses.at(OMEGA))
    _, foot, _, _, head, top = stiff.heights
    heard = shapes[0] + (top - head) * shapes[1], shapes[2] - foot * shapes[3]
    for x in (0.05, 0.7):
        run = np.exp(-1j * expected.wavenumbers * x)
        both = np.einsum("if,aif,bif,if->abf", expected.amplitudes, expected.shapes, expected.shapes, run)
        there = np.array([[1.0, keeps.head_height], [1.0, 0.0]])  # top, and centre of twist
        found = np.einsum("if,aif,bif,if->abf", amplitudes, heard, heard, np.exp(-1j * k * x))
        miss = np.abs(found / np.einsum("ma,abf,nb->mnf", there, both, there) - 1.0).max(axis=(0, 1))
        assert np.all(
            miss < [3e-5, 3e-6, 3e-6, 1e-4, 1e-3]
        )  # rounding at first, then what a web still gives way


def test_waves_are_those_of_two_timoshenko_beams_on_the_web():
    """Answer to a point force by quadrature over wavenumbers of 4 by 4 answers, slopes eliminated by hand."""
    losses, omega = 1.0 + 0.2j, OMEGA[2:4]
    foundation = np.zeros((4, 4, 2), complex)
    foundation[2, 2], foundation[3, 3], foundation[2, 3] = 9e7 + 2e7j, 7e5, 3e5
    foundation[3, 2] = foundation[2, 3]
    k, shapes, amplitudes = webbed_waves(SECTION, omega, losses, foundation)
    beams, at = SECTION.beams, np.linspace(0.0, 600.0, 30001)
    for line, each in enumerate(omega):
        answer = np.broadcast_to(losses * SECTION.bent_web - each**2 * SECTION.mass, (len(at), 4, 4)).copy()
        answer += foundation[..., line]
        for beam in (0, 1):
            shear = losses * beams.shear_stiffness[beam]
            turn = losses * beams.bending_stiffness[beam] * at**2 - beams.rotary_inertia[beam] * each**2
            answer[:, 2 * beam, 2 * beam] += shear * at**2 * turn / (shear + turn)
            answer[:, 2 * beam + 1, 2 * beam + 1] += losses * beams.torsional_stiffness[beam] * at**2
        answer = np.linalg.inv(answer)
        for x in (0.1, 0.8):
            expected = np.trapezoid(answer * np.cos(at * x)[:, None, None], at, axis=0) / np.pi
            run = amplitudes[:, line] * np.exp(-1j * k[:, line] * x)
            found = np.einsum("i,ai,bi->ab", run, shapes[..., line], shapes[..., line])
            assert np.all(np.abs(found - expected) < 2e-3 * np.abs(expected).max(axis=1, keepdims=True))


def test_a_web_that_is_held_below_is_a_strip_of_plate():
    """Its first natural frequency, clamped and free: 3.516 √(D/(ρt))/h², and what a force moves."""
    h, mass = SECTION.web_height, SECTION.web_mass / SECTION.web_height
    plate = 210e9 * 16.5e-3**3 / (12.0 * (1.0 - 0.3**2))
    upper = np.linalg.inv(SECTION.ends)[:, 2:]
    stiffness, inertia = (upper.T @ each @ upper for each in (SECTION.bent_web, SECTION.web_squares))
    first, _ = linalg.eigh(stiffness, SECTION.web_mass * inertia, eigvals_only=True)
    assert math.sqrt(first) == pytest.approx(3.51602 * math.sqrt(plate / mass) / h**2, rel=5e-3)
    sideways = np.linalg.inv(stiffness)[0, 0]  # by a force at the upper end
    assert sideways == pytest.approx(h**3 / (3.0 * plate), rel=1e-9)


def test_motion_over_the_height_is_squared_and_averaged():
    """Of head and foot as rigid bodies, of the web as the cubic between their ends."""
    bottom, foot, low, high, head, top = SECTION.heights
    motion = np.array([0.3, 4.0, -0.5, 7.0])
    lower, upper = motion[2] + (low - foot) * motion[3], motion[0] + (high - head) * motion[1]
    web = interpolate.CubicHermiteSpline([low, high], [lower, upper], motion[[3, 1]])
    z = np.linspace(bottom, top, 40001)
    moved = np.select([z < low, z <= high], [motion[2] + (z - foot) * motion[3], web(z)], motion[0])
    moved += np.where(z > high, (z - head) * motion[1], 0.0)
    assert motion @ SECTION.squares @ motion == pytest.approx(np.mean(moved**2), rel=1e-3)
    assert SECTION.top @ motion == pytest.approx(moved[-1])
    assert SECTION.bottom @ motion == pytest.approx(moved[0])
    assert_allclose(RAIL.mean_squares, SECTION.squares)
    assert_allclose(RAIL.contact_shapes(0.01) @ motion, [0.04, moved[-1]])
    depth, height = KEEPS.foot_depth, KEEPS.head_height
    whole = 0.3 + 4.0 * np.linspace(-depth, height, 40001)  # of a section that keeps its form
    found = motion[:2] @ KEEPS.mean_squares @ motion[:2]
    assert found == pytest.approx(np.mean(whole**2), rel=1e-4)


def test_supports_hold_the_foot():
    """Its bottom sideways and its own twist, as stiff as those of a rail that keeps its form."""
    plain, found = KEEPS.support(OMEGA), RAIL.support(OMEGA)
    below = SECTION.heights[1] - SECTION.heights[0]
    sideways = plain[0, 0]
    roll = plain[1, 1] - KEEPS.foot_depth**2 * sideways
    assert np.all(found[:2] == 0.0)
    expected = [[sideways, -below * sideways], [-below * sideways, below**2 * sideways + roll]]
    assert_allclose(found[2:, 2:], expected, rtol=1e-9)


PRINTED = {  # mean of the bounds of stop bands, Hz, at multiples of π/(0.65 m): waves sideways
    1: (452.5, 795.4, 1835.2, 4375.1),
    2: (1427.4, 2170.3, 2733.3, 5296.6),
    3: (2748.7, 3444.1, 4288.0),
    4: (4005.3, 4755.2),
    5: (4993.8,),
    6: (5978.4,),
}
"""J. Adv. Transp. 2021, doi 10.1155/2021/6635198, table 2: finite elements of the section of a rail."""


def waves_at_printed(rail):
    """Frequencies at which a rail has waves of each printed wavenumber over the printed ones, in order."""
    at = np.arange(300.0, 6500.0, 4.0)
    k = rail.free_waves(2.0 * np.pi * at + 0j).wavenumbers
    runs = np.abs(k.imag) < 1e-3 * np.abs(k)
    found = []
    for number, printed in PRINTED.items():
        shorter = np.sum(runs & (np.abs(k.real) > number * np.pi / 0.65), axis=0)
        own = at[np.flatnonzero(np.diff(shorter))][: len(printed)]
        found.append(own / printed[: len(own)])
    return found


def test_free_waves_are_those_of_printed_finite_elements():
    """Bending, torsion, and the web once and twice bent; one that keeps its form bends a third too slowly."""
    lossless = replace(UIC60, rail_loss_factor=0.0)
    found = np.concatenate(waves_at_printed(replace(RAIL, track=lossless)))
    assert found == pytest.approx(1.0, abs=0.08)
    assert np.median(np.abs(found - 1.0)) < 0.025
    bends = [each[0] for each in waves_at_printed(replace(KEEPS, track=lossless))]
    assert max(bends[1:]) < 0.75


def test_a_case_whose_web_bends_finds_its_rates_and_its_force():
    """What a fit predicts, and what a scene rolls over, are those of the rail with this web."""
    keys = {"contact_place": "5 mm", "web_thickness": "15 mm", "pad_stiffness": "60 MN/m"}
    case = WheelOnRail(**HEARD | {"sideways": keys})
    rail = LateralTrack(case.track.model(), pad_stiffness=60e6, web_thickness=0.015)
    at = np.array([1000.0, 1250.0])
    asked = Measured("lateral decay rate", at, at)
    predicted = observable("lateral decay rate").predict(TriedCase(case, {}), asked)
    assert_allclose(predicted, lateral_hammer_test(rail, at), rtol=1e-12)
    stiff = case.with_(sideways={"web_thickness": "inf"})
    assert stiff.sideways.model(stiff.track.model(), 0.15).section is None
    thicker = TriedCase(case, {"sideways.web_thickness": 0.0165})
    assert np.all(np.abs(observable("lateral decay rate").predict(thicker, asked) / predicted - 1.0) > 1e-3)
    rolled = SimpleNamespace(case=case, track=SimpleNamespace(nominal=case.track.model()))
    found = Sideways(rolled).rail(at, 0.2)
    assert_allclose(found, rail.answers(2.0 * np.pi * at, 0.2, 0.2, 0.005), rtol=1e-12)


def test_a_lateral_hammer_test_sums_the_responses_of_a_band():
    """1/rate = sum |A|²/|A_0|² Δx/4.343 in each line, meant by the squares of the mobility at the hammer."""
    lines = 1000.0 * 10.0 ** (0.1 * (np.array([1.0, 3.0, 5.0]) / 6.0 - 0.5))
    distances, motion = RAIL.hammered(lines)
    reached = np.diff(0.5 * (distances[1:] + distances[:-1]), prepend=0.0)
    reached = np.append(reached, 2.0 * (distances[-1] - np.sum(reached)))
    length = np.log(10.0) / 10.0 * reached @ np.abs(motion / motion[0]) ** 2
    expected = 1.0 / np.average(length, weights=np.abs(lines * motion[0]) ** 2)
    assert lateral_hammer_test(RAIL, [1000.0], 3) == pytest.approx([expected], rel=1e-9)


SECTION_KEYS = (
    *("bending_stiffness", "rotary_inertia", "torsional_stiffness", "polar_inertia"),
    *("head_height", "foot_depth", "centroid_height"),
)
OTHERS = (
    *({name: 1.1 * getattr(LateralTrack, name)} for name in SECTION_KEYS),
    {"shear_stiffness": math.inf},
)


def test_the_web_of_a_rail_that_is_a_uic_60_bends():
    """16.5 mm, as printed of 60E1; a rail of another mass or of another section keeps its form."""
    heavier, own = (
        replace(UIC60, mass_per_length=68.0),
        replace(UIC60, mass_per_length=60.0, pad_stiffness=9e8),
    )
    assert RAIL.web == LateralTrack(own, pad_stiffness=6e7, ballast_stiffness=1e8).web == 16.5e-3
    assert LateralTrack(heavier, web_thickness=14e-3, polar_inertia=0.5).web == 14e-3
    others = LateralTrack(heavier), KEEPS, *(LateralTrack(own, **each) for each in OTHERS)
    assert [each.section for each in others] == [None] * len(others)


def refused(**changes):
    return lambda: LateralTrack(UIC60, **changes)


test_sections_that_cannot_be_are_refused = refusals(
    (refused(web_height=0.08), r"web_height: received 0.08 m; allowed: only together with web_thickness"),
    (
        refused(web_thickness=math.inf, head_centroid=0.09),
        "head_centroid: received 0.09 m; allowed: only together with web_thickness",
    ),
    (refused(web_thickness=-1e-3), 'web_thickness of the lateral track: received -0.001; .* or "inf"'),
    (
        refused(web_thickness=0.0165, head_centroid=0.06),
        r"web bends: received heights above the centre of twist of -48, -37, -16.5, 73, 60, 124 mm; "
        "allowed: such that rise: bottom, centroid of the foot",
    ),
    (
        refused(web_thickness=0.0165, shear_stiffness=math.inf),
        "one without shear; allowed: a shear_stiffness",
    ),
    (
        refused(web_thickness=0.09),
        r"a head of \S+ and a foot of \S+ kg/m beside a web of 63.2 kg/m; allowed: masses",
    ),
    (refused(web_thickness=0.0165, polar_inertia=0.2), r"of the polar inertia left .* allowed: more than 0"),
    (
        refused(web_thickness=0.0165, foot_torsion_share=1.0),
        "foot_torsion_share of the lateral track: received",
    ),
)
