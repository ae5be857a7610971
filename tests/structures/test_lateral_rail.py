"""The rail sideways: against superposed supports, the vertical rail, elastic layers; with a wheel on it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity import Track
from asperity.structures.lateral_rail import (
    LateralTrack,
    at_springs,
    lateral_force,
    vertical_change,
    wheel_receptances,
)
from asperity.structures.wheel_modes import WheelModes
from refusals import refusals

UIC60 = Track.named("uic60")
LOSSY = Track.named("nordborg-loss-factor", rail_loss_factor=0.1)
KEEPS = {"web_thickness": math.inf}  # its form
RAIL = LateralTrack(UIC60, **KEEPS)
FREQUENCIES = np.array([40.0, 250.0, 700.0, 2000.0, 5000.0])
OMEGA = 2.0 * np.pi * FREQUENCIES
STRAIGHT = {"centroid_height": 0.0, "foot_depth": 0.0}  # bends and twists by itself


def free_receptance(track, omega, x):
    """Of the rail without supports at distances (n,), (n, m, m, f)."""
    free = track.free_waves(omega)
    run = np.exp(-1j * free.wavenumbers * np.abs(x)[:, None, None])
    return np.einsum("if,aif,bif,nif->nabf", free.amplitudes, free.shapes, free.shapes, run)


WEB = {}  # that of UIC 60 bends


@pytest.mark.parametrize(
    ("place", "web"), [((0.1, 0.1), KEEPS), ((0.35, 1.9), KEEPS), ((1.5, 0.05), KEEPS), ((1.5, 0.05), WEB)]
)
def test_the_waves_are_the_superposition_of_many_supports(place, web):
    """A linear system of the reactions of 121 supports, the last of them where the rail is at rest."""
    track, (x, x0), reach = LateralTrack(LOSSY, **web), place, 60
    omega, bay = 2.0 * np.pi * FREQUENCIES[1:] + 0j, LOSSY.sleeper_spacing
    at = bay * np.arange(-reach, reach + 1)
    stiffness = track.support(omega)
    between = free_receptance(track, omega, (at[:, None] - at).ravel())
    count, moves = len(at), len(stiffness)
    expected = np.empty((moves, moves, len(omega)), complex)
    sent, heard = (free_receptance(track, omega, at - each) for each in (x0, x))
    for line in range(len(omega)):
        answer = between[..., line].reshape(count, count, moves, moves) @ stiffness[..., line]
        size = moves * count
        system = np.eye(size) + answer.transpose(0, 2, 1, 3).reshape(size, -1)
        moved = np.linalg.solve(system, sent[..., line].reshape(-1, moves)).reshape(count, moves, moves)
        reaction = stiffness[..., line] @ moved
        direct = free_receptance(track, omega[[line]], np.array([x - x0]))[0, ..., 0]
        expected[..., line] = direct - np.sum(heard[..., line] @ reaction, axis=0)
    found = track.waves(omega).receptance(x, x0)
    assert np.all(np.abs(found - expected).max(axis=(0, 1)) < 2e-6 * np.abs(expected).max(axis=(0, 1)))


def test_rail_dampers_damp_no_lateral_wave():
    """A track that nothing else damps answers sideways as without them, by the wave that runs outwards."""
    still = replace(UIC60, pad_damping=None, ballast_damping=None, rail_loss_factor=0.0)
    dampers = {"rail_damper_mass": 15.0, "rail_damper_frequency": 800.0, "rail_damper_loss_factor": 0.35}
    without, beside = (
        LateralTrack(each).receptance(FREQUENCIES, 0.1, 0.1) for each in (still, replace(still, **dampers))
    )
    assert_allclose(beside, without, rtol=1e-12)
    assert (without.imag < 0.0).any()  # energy leaves along the rail


@pytest.mark.parametrize(("shear", "rotary"), [(math.inf, 0.0), (3e8, 0.04)], ids=["Euler", "Timoshenko"])
def test_bending_alone_is_that_of_the_vertical_rail(shear, rotary):
    rail = STRAIGHT | {"shear_stiffness": shear, "rotary_inertia": rotary}
    sideways = LateralTrack(UIC60, pad_stiffness=60e6, ballast_stiffness=50e6, **rail)
    softer, below = 60e6 / UIC60.pad_stiffness, 50e6 / UIC60.ballast_stiffness
    rail = {"shear_stiffness": shear if rotary else None, "rotary_inertia": rotary or None}
    pads = {"pad_stiffness": 60e6, "pad_damping": softer * UIC60.pad_damping}
    ballast = {"ballast_stiffness": 50e6, "ballast_damping": below * UIC60.ballast_damping}
    vertical = replace(UIC60, bending_stiffness=RAIL.bending_stiffness, **rail, **pads, **ballast)
    for x, x0 in ((0.2, 0.2), (0.3, 1.3), (7.0, 0.1)):
        motion = sideways.waves(OMEGA).receptance(x, x0)
        assert_allclose(motion[0, 0], vertical.receptance(FREQUENCIES, x, x0), rtol=1e-11)
        assert_allclose(motion[0, 1], 0.0, atol=1e-30)


def test_torsion_alone_is_that_of_a_bar_on_springs():
    """(λ + 1/λ)/2 of the change over one bay, cos kL + K/(2 GJ k) sin kL."""
    track = LateralTrack(UIC60, pad_roll_stiffness=4e5, **STRAIGHT)
    omega, bay = OMEGA, UIC60.sleeper_spacing
    torsion = RAIL.torsional_stiffness * (1.0 + 1j * UIC60.rail_loss_factor)
    k = omega * np.sqrt(RAIL.polar_inertia / torsion)
    roll = 4e5 * (1.0 + 1j * omega * UIC60.pad_damping / UIC60.pad_stiffness)
    expected = np.cos(k * bay) + roll / (2.0 * torsion * k) * np.sin(k * bay)
    multipliers = track.waves(omega).multipliers
    found = 0.5 * (multipliers + 1.0 / multipliers)
    assert_allclose(np.abs(found / expected - 1.0).min(axis=0), 0.0, atol=1e-11)


SIDE_OF_KEEPS = [1.0, 0.104]  # 20 mm below the top of a head that turns about the centre of twist
SIDE_OF_WEB = [1.0, 5e-3, 0.0, 0.0]  # 5 mm above the centroid of the head


@pytest.mark.parametrize(("web", "side"), [(KEEPS, SIDE_OF_KEEPS), (WEB, SIDE_OF_WEB)])
def test_a_hammer_strikes_the_side_of_the_head(web, side):
    track = LateralTrack(UIC60, **web)
    distances, found = track.hammered(FREQUENCIES)
    moved = [track.waves(OMEGA).receptance(0.3 + each, 0.3) for each in distances]
    assert_allclose(found, np.einsum("a,xabf,b->xf", side, moved, side), rtol=1e-10)
    assert_allclose(distances[[0, 1, -1]], [0.0, 0.15, 39.6])


def test_a_hammer_finds_the_sum_along_the_rail():
    """4.343 over the integral of the squares over one side; the distances of EN 15461 see it so."""
    track, at = RAIL, np.array([200.0, 500.0, 1600.0])
    x = np.linspace(0.0, 60.0, 601)
    waves = track.waves(2.0 * np.pi * at)
    moved = [waves.receptance(0.3 + each, 0.3) for each in x]
    squares = np.abs(np.einsum("a,xabf,b->xf", SIDE_OF_KEEPS, moved, SIDE_OF_KEEPS)) ** 2
    exact = 10.0 / np.log(10.0) / (np.trapezoid(squares, x, axis=0) / squares[0])
    assert_allclose(track.decay_rate_en15461(at), exact, rtol=0.1)


def test_decay_rates_are_those_of_a_beam_on_an_elastic_layer():
    """Of a short bay: det(K(k) + K_s/L) = 0, by the polynomial of its dispersion relation."""
    short = replace(LOSSY, sleeper_spacing=0.02, sleeper_mass=150.0 / 30.0, rail_loss_factor=0.02)
    softer = {"pad_stiffness": 100e6 / 30, "pad_roll_stiffness": 5e5 / 30, "ballast_stiffness": 1e7}
    track = LateralTrack(short, **softer, **KEEPS)
    for f in (100.0, 400.0, 1500.0):
        omega = 2.0 * np.pi * f
        layer = track.support(np.array([omega]))[..., 0] / short.sleeper_spacing
        loss, mass, e = 1.0 + 0.02j, short.mass_per_length, RAIL.centroid_height
        shear, poly = RAIL.shear_stiffness * loss, np.polynomial.polynomial.Polynomial
        turn = poly([shear - RAIL.rotary_inertia * omega**2, 0, RAIL.bending_stiffness * loss])  # of slopes
        side = poly([layer[0, 0] - mass * omega**2, 0, shear])
        twist = poly(
            [layer[1, 1] - (RAIL.polar_inertia + mass * e**2) * omega**2, 0, RAIL.torsional_stiffness * loss]
        )
        cross = layer[0, 1] - mass * e * omega**2
        dispersion = (side * turn - poly([0, 0, shear**2])) * twist - cross**2 * turn
        least = np.abs(dispersion.roots().imag).min()
        assert track.decay_rate(f)[0] == pytest.approx(8.685889638 * least, rel=2e-3)


@pytest.mark.parametrize("web", [KEEPS, WEB], ids=["keeps its form", "web bends"])
def test_a_rail_that_lies_all_along_is_the_limit_of_short_bays(web):
    even = replace(LOSSY, continuous=True)
    short = replace(LOSSY, sleeper_spacing=LOSSY.sleeper_spacing / 40)
    softer = {f"{part}_stiffness": getattr(LOSSY, f"{part}_stiffness") / 40 for part in ("pad", "ballast")}
    short = replace(short, sleeper_mass=LOSSY.sleeper_mass / 40, **softer)
    omega = 2.0 * np.pi * np.array([60.0, 300.0, 1200.0, 4000.0])
    found, limit = (LateralTrack(each, **web).answers(omega, 0.0, 0.9, 0.01) for each in (even, short))
    assert_allclose(found, limit, rtol=2e-3)


def test_layers_below_the_sleeper_and_what_bends_count_sideways_too():
    """A chain by hand: ballast and under-sleeper pad in line below a mass, and a pad as on rigid ground."""
    bending = {"sleeper_bending_stiffness": 5e6, "sleeper_length": 2.6, "seat_distance": 1.5}
    under = {"under_sleeper_pad_stiffness": 5e7, "under_sleeper_pad_loss_factor": 0.3}
    softer = {"pad_stiffness": 8e7, "ballast_stiffness": 6e7}
    track = LateralTrack(replace(LOSSY, **bending, **under), **softer, **KEEPS)
    pad, soft, ballast = 8e7 * (1 + 0.15j), 5e7 * (1 + 0.3j), 6e7 * (1 + 0.4j)
    below = soft * ballast / (soft + ballast) - LOSSY.sleeper_mass * OMEGA**2
    expected = pad * below / (pad + below)
    stiffness = track.support(OMEGA)
    assert_allclose(stiffness[0, 0], expected, rtol=1e-12)
    assert_allclose(stiffness[0, 1], -RAIL.foot_depth * expected, rtol=1e-12)
    roll = LOSSY.pad_stiffness * (1 + 0.15j) * 0.15**2 / 12.0
    assert_allclose(stiffness[1, 1], RAIL.foot_depth**2 * expected + roll, rtol=1e-12)
    rigid = {"ballast_stiffness": math.inf, "ballast_loss_factor": None}
    slab = LateralTrack(replace(LOSSY, sleeper_mass=10.0, **rigid), **KEEPS)
    assert_allclose(slab.support(OMEGA)[0, 0], LOSSY.pad_stiffness / 3.0 * (1 + 0.15j), rtol=1e-12)


def test_answers_at_several_places_are_those_of_each():
    x, x0 = np.array([0.1, 0.3, 0.9]), np.array([0.3, 0.1, 0.0])
    found, middle = (RAIL.answers(OMEGA, x, x0, place) for place in (0.01, 0.0))
    assert_allclose(middle[0, 0], UIC60.receptance(FREQUENCIES, x, x0), rtol=1e-12)
    for n, pair in enumerate(zip(x, x0, strict=True)):
        assert_array_equal(found[:, :, n], RAIL.answers(OMEGA, *pair, 0.01))


def test_a_vertical_force_in_the_middle_does_not_move_the_rail_sideways():
    middle, off = (RAIL.answers(OMEGA, 0.3, 0.3, place) for place in (0.0, 0.01))
    assert np.all(middle[[0, 1], [1, 0]] == 0.0)
    assert_allclose(middle[0, 0], UIC60.receptance(FREQUENCIES, 0.3, 0.3), rtol=1e-12)
    twist = RAIL.waves(OMEGA).receptance(0.3, 0.3)
    assert_allclose(off[0, 0] - middle[0, 0], 1e-4 * twist[1, 1], rtol=1e-12)
    assert_allclose(off[1, 0], 0.01 * (twist[0, 1] + RAIL.head_height * twist[1, 1]), rtol=1e-12)


# --- wheel and rail at a contact off the middle

RUNG = np.array([90.0, 431.0, 1500.0, 2703.0])
ACROSS = np.linspace(-0.06, 0.06, 13)
RINGING = np.array([500.0, 1600.0, 2500.0, 3100.0])


def plane_wheel(**changes):
    """Modes of a plane web: radial ones are even across the tread, axial ones tilt it."""
    even, tilt = np.ones(13), ACROSS / 0.46
    radial = 0.06 * np.stack([tilt, even, tilt, even])
    axial = 0.06 * np.stack([even, 0.0 * even, even, 0.0 * even])
    numbers, none = np.array([0, 2, 3, 4]), np.full(4, 0.01)
    fields = {"radial": radial, "axial": axial} | changes
    return WheelModes(RINGING, np.full(4, 2e-4), numbers, ACROSS, disc=none, tread=none, **fields)


def test_in_the_middle_of_a_plane_wheel_nothing_moves_sideways():
    for place, tilted in ((0.0, False), (0.01, False), (0.0, True)):
        changes = {"axial": np.full((4, 13), 0.03)} if tilted else {}
        wheel = wheel_receptances(plane_wheel(**changes), 600.0, RUNG, place)
        assert_allclose(wheel[0, 1], wheel[1, 0], rtol=1e-12)
        answer = at_springs(wheel + RAIL.answers(2.0 * np.pi * RUNG, 0.1, 0.1, place), 1.1e9, 9e8)
        moved = np.abs(lateral_force(answer))
        assert np.all(moved > 1e-4 if place or tilted else moved == 0.0)
    assert np.all(vertical_change(wheel_receptances(None, 600.0, RUNG, 0.023)) == 1.0)


def test_axial_modes_ring_under_a_vertical_force_off_the_middle_only():
    """At resonance of a mode with three nodal diameters: (φ_r(y) φ_a)/(2iζω₀²), none of it in the middle."""
    modes, at = plane_wheel(), RINGING[[2]]
    for place in (0.0, 0.01, -0.02):
        cross = wheel_receptances(modes, 1e9, at, place)[1, 0]
        expected = 0.06**2 * place / 0.46 / (4e-4j * (2.0 * np.pi * 2500.0) ** 2)
        assert_allclose(cross, expected, rtol=2e-2, atol=1e-22)


def test_the_lateral_force_satisfies_compatibility():
    """Both forces at once; displacements of each body by itself differ by what the springs take up."""
    place, k_n, k_t = 0.012, 1.1e9, 9e8
    wheel = wheel_receptances(plane_wheel(), 600.0, RUNG, place)
    rail = RAIL.answers(2.0 * np.pi * RUNG, 0.1, 0.1, place)
    whole = at_springs(wheel + rail, k_n, k_t)
    forces = np.moveaxis(np.linalg.solve(np.moveaxis(whole, -1, 0), np.array([[1.0], [0.0]]))[..., 0], -1, 0)
    assert_allclose(lateral_force(whole), forces[1] / forces[0], rtol=1e-12)
    assert_allclose(vertical_change(whole), forces[0] * whole[0, 0], rtol=1e-12)
    on_rail = np.einsum("abf,bf->af", rail, forces)
    on_wheel = np.einsum("abf,bf->af", wheel, -forces)
    assert_allclose(on_wheel[1] - on_rail[1], forces[1] / k_t, rtol=1e-9)  # the wheel drags the rail
    assert_allclose(on_rail[0] - on_wheel[0], 1.0 - forces[0] / k_n, rtol=1e-9)


test_bad_questions_are_refused = refusals(
    (
        lambda: wheel_receptances(plane_wheel(), 600.0, RUNG, 0.07),
        r"place of the contact \(m\): received 0.07; allowed: -60 mm to 60",
    ),
    (lambda: replace(RAIL, rotary_inertia=-1.0), "rotary_inertia of the lateral track: received -1"),
    (lambda: replace(RAIL, pad_stiffness=0.0), "pad_stiffness of the lateral track: received 0"),
    (lambda: LateralTrack(UIC60, foot_width=-0.1), "width of the rail's foot"),
    (lambda: LateralTrack(UIC60).decay_rate(0.0), r"frequency \(Hz\): received 0.0; allowed: finite pos"),
    (
        lambda: LateralTrack(replace(UIC60, sleeper_spacing=30.0), shear_stiffness=math.inf).decay_rate(9e3),
        "decay of a rail wave over",
    ),
)


def test_waves_that_are_kept_are_those_that_are_asked_for():
    """Of frequencies that begin alike, and of those that were asked for before."""
    track = LateralTrack(Track.named("uic60"))
    for frequency in ([100.0, 500.0], [100.0, 700.0], [100.0, 500.0, 900.0], [100.0, 500.0]):
        alone = LateralTrack(Track.named("uic60")).receptance(frequency, 0.3, 0.3)
        assert_array_equal(track.receptance(frequency, 0.3, 0.3), alone)
