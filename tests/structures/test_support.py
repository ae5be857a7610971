"""Supports of a rail: chains by closed forms, sleepers by their receptance, against free and bedded beams."""

import numpy as np
import pytest

from asperity import Track
from asperity.structures import support
from asperity.structures.causal_track import causal_track
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.mobility import dissipated_power
from asperity.structures.support import BendingSleeper, Chain, ConstantLoss, Relaxation, RigidMass, Spring
from refusals import refusals

OMEGA = 2.0 * np.pi * np.array([1.0, 30.0, 90.0, 276.0, 600.0, 1500.0, 4000.0])
LOWER = OMEGA * (1.0 - 0.1j)  # in the lower half-plane
PAD = Spring(300e6, ConstantLoss(0.15), 0.0)
BALLAST = Spring(150e6, Relaxation(0.6, (0.2, 0.5), (30.0, 300.0)), 1e4)
SLEEPER = {"mass": 150.0, "length": 2.6, "bending_stiffness": 6e6, "seat_distance": 1.5}


def test_pad_sleeper_and_ballast_are_the_closed_form():
    pad, ballast = PAD.stiffness(LOWER), BALLAST.stiffness(LOWER)
    below = ballast - 150.0 * LOWER**2
    chain = Chain((PAD, RigidMass(150.0), BALLAST))
    np.testing.assert_allclose(chain.stiffness(LOWER), pad * below / (pad + below), rtol=1e-12)
    np.testing.assert_allclose(chain.sleeper_square(LOWER), np.abs(pad / (pad + below)) ** 2, rtol=1e-12)
    assert chain.static == pytest.approx(300e6 * 90e6 / 390e6, rel=1e-14)


def test_a_long_chain_is_its_equations_of_motion():
    """Pad, sleeper, pad under it, ballast with mass, subgrade: two equations for the two masses."""
    soft, ground = Spring(200e6, ConstantLoss(0.2), 0.0), Spring(90e6, ConstantLoss(0.3), 2e4)
    chain = Chain((PAD, RigidMass(150.0), soft, BALLAST, RigidMass(300.0), ground))
    for omega, found, squares in zip(
        OMEGA, chain.stiffness(OMEGA), np.transpose(chain.squares(OMEGA), (2, 0, 1)), strict=True
    ):
        pad, under, ballast, deep = (each.stiffness(omega) for each in (PAD, soft, BALLAST, ground))
        layer = 1.0 / (1.0 / under + 1.0 / ballast)
        matrix = [[pad + layer - 150.0 * omega**2, -layer], [-layer, layer + deep - 300.0 * omega**2]]
        sleeper, bed = np.linalg.solve(matrix, [pad, 0.0])
        assert found == pytest.approx(pad * (1.0 - sleeper), rel=1e-11)
        moved = np.abs([1.0, sleeper, sleeper, sleeper - layer / under * (sleeper - bed), bed, bed]) ** 2
        np.testing.assert_allclose(squares[:, 0], moved, rtol=1e-9)
        squeezed = np.abs([1.0 - sleeper, layer / ballast * (sleeper - bed), bed]) ** 2
        np.testing.assert_allclose(squares[[0, 3, 5], 1], squeezed, rtol=1e-8)


def test_nothing_moves_on_rigid_ground():
    for sleeper in (RigidMass(150.0), BendingSleeper(**SLEEPER)):
        chain = Chain((PAD, sleeper))
        np.testing.assert_array_equal(chain.stiffness(OMEGA), Chain((PAD,)).stiffness(OMEGA))
        np.testing.assert_array_equal(chain.sleeper_square(OMEGA), 0.0)
        assert chain.static == 300e6
    assert not Chain((PAD,)).sleeper_square(OMEGA).any()


def test_a_stiff_sleeper_is_a_point_mass():
    below, stiff = BALLAST.stiffness(LOWER), BendingSleeper(**(SLEEPER | {"bending_stiffness": 1e18}))
    np.testing.assert_allclose(stiff.on(LOWER, below), RigidMass(150.0).on(LOWER, below), rtol=1e-9)
    np.testing.assert_allclose(stiff.spread(LOWER, below), 1.0, rtol=1e-8)


def test_a_sleeper_is_right_at_any_complex_frequency():
    """Causal: the receptance is analytic, so that its mean on a circle is its value in the middle."""
    middle, sleeper = 4000.0 - 300.0j, BendingSleeper(**SLEEPER)
    ring = middle + 200.0 * np.exp(2j * np.pi * np.arange(64) / 64)
    assert (1.0 / sleeper.on(ring, BALLAST.stiffness(ring))).mean() == pytest.approx(
        1.0 / sleeper.on(middle, BALLAST.stiffness(middle)), rel=1e-12, abs=0.0
    )


def test_a_sleeper_with_losses_is_one_whose_stiffness_is_complex():
    """Against the free beam by its boundary conditions, at its resonances, where the losses decide."""
    sleeper = BendingSleeper(**SLEEPER, losses=ConstantLoss(0.05))
    exact = beam(BENDING * (1.0 + 0.05j))
    found = 1.0 / sleeper.on(2.0 * np.pi * FREQUENCY, NOTHING)
    np.testing.assert_allclose(found, exact, rtol=1e-7)
    plain = 1.0 / BendingSleeper(**SLEEPER).on(2.0 * np.pi * FREQUENCY, NOTHING)
    assert np.abs(plain / exact).max() > 2.0
    chain = Chain((PAD, BendingSleeper(**SLEEPER, losses=Relaxation(0.9, (0.2,), (300.0,))), BALLAST))
    ring = 4000.0 - 300.0j + 200.0 * np.exp(2j * np.pi * np.arange(64) / 64)
    middle = chain.stiffness(np.array(4000.0 - 300.0j))
    assert chain.stiffness(ring).mean() == pytest.approx(middle, rel=1e-11)
    soft = BendingSleeper(**(SLEEPER | {"bending_stiffness": 0.9 * SLEEPER["bending_stiffness"]}))
    assert chain.static == Chain((PAD, soft, BALLAST)).static


def test_an_opposed_sleeper_turns_and_bends_in_its_odd_modes():
    """Free: at low frequency by its moment of inertia, m (L/2)²/3, and loudest at kL = 7.8532 and on."""
    odd = BendingSleeper(**SLEEPER, losses=ConstantLoss(1e-4), opposed=True)
    omega, length, seat = 2.0 * np.pi * 2.0, SLEEPER["length"], 0.5 * SLEEPER["seat_distance"]
    turning = SLEEPER["mass"] * (0.5 * length) ** 2 / 3.0
    slow = 1.0 / odd.on(np.array([omega]), np.zeros(1, complex))[0]
    assert slow == pytest.approx(-(seat**2) / (turning * omega**2), rel=1e-3)
    wave = np.array([7.853205, 14.137165]) / length
    natural = wave**2 * np.sqrt(SLEEPER["bending_stiffness"] * 0.5 * length / SLEEPER["mass"])
    for resonance in natural:
        near = resonance * (1.0 + 1e-3 * np.arange(-5, 6))
        answer = np.abs(1.0 / odd.on(near, np.zeros(11, complex)))
        assert int(np.argmax(answer)) == 5
    below = BALLAST.stiffness(OMEGA)
    stiff = BendingSleeper(**(SLEEPER | {"bending_stiffness": 1e16}), opposed=True)
    held = turning / seat**2 / SLEEPER["mass"]  # both mass and bed, spread alike
    expected = held * (below - SLEEPER["mass"] * OMEGA**2)
    np.testing.assert_allclose(stiff.on(OMEGA, below), expected, rtol=1e-5)


def test_a_sleeper_keeps_its_loss_factor_in_time():
    lossy = {"sleeper_bending_stiffness": 6e6, "sleeper_loss_factor": 0.03}
    track = causal_track(Track.named("nordborg", **lossy, rail_loss_factor=0.0))
    ratio = track.elements["sleeper"].losses.at(2.0 * np.pi * np.array([20.0, 125.0, 724.0, 4000.0]))
    np.testing.assert_allclose(ratio.imag / ratio.real, 0.03, rtol=0.1)
    assert track.is_causal


MASS, LENGTH, BENDING, SEATS = 150.0, 2.6, 6e6, 1.5
FREQUENCY = np.geomspace(20.0, 6000.0, 250)
LOOKED = np.array([30.0, 121.0, 280.0, 650.0, 1063.0, 1600.0, 2900.0, 4500.0])
NOTHING = np.zeros(len(FREQUENCY), complex)


def beam(bending=BENDING):
    """Seat receptance of a free beam, both seats pressed alike, at `FREQUENCY`.

    B w'''' = k⁴ B w: cos kx and cosh kx from the middle to the seat; from there two sums that leave the end
    free, of y, from the end. At the seat w, w', w'' go on, and B w''' falls by the force.
    """
    k = (MASS * (2.0 * np.pi * FREQUENCY) ** 2 / (0.5 * LENGTH) / bending + 0j) ** 0.25
    x, y = k * 0.5 * SEATS, k * 0.5 * (LENGTH - SEATS)
    even, odd = [np.cosh, np.sinh] * 2, [np.sinh, np.cosh] * 2
    rows = []
    for n in range(4):
        turn, back = 0.5 * n * np.pi, (-1.0) ** n
        end = [np.cos(y + turn) + even[n](y), np.sin(y + turn) + odd[n](y)]
        rows.append([np.cos(x + turn), even[n](x), *(-back * each for each in end)])
    matrix = np.moveaxis(np.array(rows), 2, 0)
    force = np.multiply.outer(-1.0 / (bending * k**3), [[0.0], [0.0], [0.0], [1.0]])
    amplitude = np.linalg.solve(matrix, force)[:, :, 0]
    return amplitude[:, 0] * np.cos(x) + amplitude[:, 1] * np.cosh(x)


@pytest.mark.parametrize("name", ["nordborg", "nordborg-loss-factor"])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_a_table_of_a_beam_is_the_track_on_such_beams(name, noise):
    """A per cent of noise on the table is less on the track."""
    draws = np.random.default_rng(3)
    around = 1.0 + noise * (draws.standard_normal(250) + 1j * draws.standard_normal(250))
    sleeper = support.measured_sleeper(FREQUENCY, around * beam(BENDING * (1.0 + 1e-9j)), MASS)
    assert sleeper.fit_error < (0.1 if noise else 0.005)
    found = Track.named(name, measured_sleeper=sleeper, ballast_mass=300.0, subgrade_stiffness=9e7)
    bends = {"sleeper_bending_stiffness": BENDING, "sleeper_length": LENGTH, "seat_distance": SEATS}
    exact = Track.named(name, **bends, ballast_mass=300.0, subgrade_stiffness=9e7)
    near = noise or 1e-4
    for x in (0.0, 0.3):
        expected = exact.receptance(LOOKED, x, x)
        np.testing.assert_allclose(found.receptance(LOOKED, x, x), expected, rtol=near)
    assert found.support.static == pytest.approx(exact.support.static, rel=near)
    squares = (each.support.sleeper_square(2.0 * np.pi * LOOKED) for each in (found, exact))
    np.testing.assert_allclose(*squares, rtol=10.0 * near)


def test_a_table_of_a_mass_is_a_mass():
    omega = 2.0 * np.pi * FREQUENCY
    sleeper = support.measured_sleeper(FREQUENCY, -1.0 / (MASS * omega**2) + NOTHING, MASS)
    below = 150e6 * (1.0 + 0.4j) + NOTHING
    np.testing.assert_allclose(sleeper.on(omega, below), RigidMass(MASS).on(omega, below), rtol=1e-12)
    assert sleeper.on(0.0, np.asarray(150e6 + 0j)) == pytest.approx(150e6, rel=1e-12)
    found, exact = (Track.named("uic60", **each) for each in ({"measured_sleeper": sleeper}, {}))
    at = LOOKED, 0.0, 0.0
    np.testing.assert_allclose(found.receptance(*at), exact.receptance(*at), rtol=1e-9)
    sideways = (LateralTrack(each).support(omega) for each in (found, exact))
    np.testing.assert_allclose(*sideways, rtol=1e-12)


def test_a_sleeper_that_loses_is_causal_passive_and_takes_its_part_of_the_power():
    """Its receptance is analytic in the lower half-plane: the mean on a circle is the value in the middle."""
    sleeper = support.measured_sleeper(FREQUENCY, beam(BENDING * (1.0 + 0.03j)), MASS)
    ring = 4000.0 - 300.0j + 200.0 * np.exp(2j * np.pi * np.arange(64) / 64) * np.array([[1.0], [0.0]])
    around, middle = np.mean(1.0 / sleeper.on(ring, 150e6 + 5e4j * ring), axis=1)
    assert around == pytest.approx(middle, rel=1e-12, abs=0.0)
    omega = np.geomspace(1.0, 1e6, 400)
    assert (sleeper.on(omega, np.full(400, 150e6 + 0j)).imag >= 0.0).all()
    track = Track.named("nordborg", rail_loss_factor=0.0, measured_sleeper=sleeper)
    assert causal_track(track) is track
    parts = dissipated_power(track, LOOKED, 0.1)
    assert list(parts) == ["rail", "pad", "sleeper", "ballast"]
    fed = -2.0 * np.pi * LOOKED * track.receptance(LOOKED, 0.1, 0.1).imag
    np.testing.assert_allclose(sum(parts.values()), fed, rtol=1e-9)
    assert parts["sleeper"].max() > 0.01 * fed.max()


@pytest.mark.parametrize("factor", [0.02, 0.1, 0.35])
def test_a_pad_that_stiffens_keeps_its_loss_factor(factor):
    """Its phase everywhere, and by Bode's relation of gain and phase the exponent; 300 Hz is nominal."""
    track = Track.named("uic60", pad_stiffness=2e8, pad_loss_factor=factor, pad_stiffens=True)
    pad, at = track.springs["pad"], np.array([5.0, 41.0, 300.0, 1234.0, 5000.0, 20000.0])
    found = pad.stiffness(2.0 * np.pi * at)
    np.testing.assert_allclose(found.imag / found.real, factor, rtol=1e-6)
    exponent = np.angle(1.0 + 1j * factor) / (0.5 * np.pi)
    np.testing.assert_allclose(found.real, 2e8 * (at / 300.0) ** exponent, rtol=5e-4)
    np.testing.assert_allclose(pad.stiffness(2.0 * np.pi * np.array([0.1])), found[:1], rtol=1e-12)
    assert track.support.elements[0].at_rest.nominal == pytest.approx(found[0].real)


def test_a_pad_that_stiffens_is_met_by_relaxing_elements_better_than_one_that_does_not():
    """What is causal can be approximated: 50 Hz to 3 kHz are missed by a quarter at most of the other."""
    keys, at = {"pad_stiffness": 5e8, "pad_loss_factor": 0.35}, 2.0 * np.pi * np.geomspace(50.0, 3000.0, 30)
    missed = []
    for stiffens in (True, False):
        track = Track.named("uic60", **keys, pad_stiffens=stiffens)
        assert not track.is_causal
        found, aim = (each.springs["pad"].stiffness(at) for each in (causal_track(track), track))
        missed.append(np.abs(found / aim - 1.0).max())
    assert missed[0] < 0.25 * missed[1]


test_pads_that_cannot_stiffen_are_refused = refusals(
    (
        lambda: Track.named("uic60", pad_stiffens=True),
        "pad_stiffens: received True; allowed: only together with pad_loss_factor",
    ),
    (
        lambda: Track.named("uic60", pad_stiffens=True, pad_damping=1e4),
        "pad_stiffens: received True; allowed: only together with pad_loss_factor",
    ),
)


test_sleepers_that_cannot_be_are_refused = refusals(
    (np.where(FREQUENCY < 300.0, 1.0, 1.0 + 0.2j), "imaginary part above zero from 3.* to 6000 Hz, by which"),
    (np.where(FREQUENCY < 300.0, 1.0, 0.0), "size of a receptance"),
    (np.full(len(FREQUENCY), 1e30), "1·10⁻²⁰ to 1·10²⁰ m/N"),
    (beam(), "remove sleeper_bending_stiffness"),
    of=lambda receptance: Track.named(
        "uic60",
        measured_sleeper=support.measured_sleeper(FREQUENCY, receptance + 0j, MASS),
        sleeper_bending_stiffness=BENDING,
    ),
)
