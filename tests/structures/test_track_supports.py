"""Tracks on other supports than pad, sleeper and ballast, by closed forms; and where their power goes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from asperity import Track, Wheel
from asperity.scenes.track import loss_factor_error
from asperity.structures.causal_track import causal_track
from asperity.structures.mobility import dissipated_power
from asperity.structures.support import (
    BendingSleeper,
    MeasuredSleeper,
    Relaxation,
    RigidMass,
    Spring,
    StiffnessTable,
    preloads_of,
    stiffness_at_preload,
    tuned_damper,
)
from asperity.structures.track import EN_15461_BAYS, decay_rate_en15461, decay_rate_of_responses
from asperity.structures.track_parameters import Bays
from refusals import refusals
from superposed import free_rail, superposed

FREQUENCY = np.array([30.0, 120.0, 400.0, 800.0, 1063.0, 2500.0, 5000.0])
OMEGA = 2.0 * np.pi * FREQUENCY
DAMPERS = {"rail_damper_mass": 15.0, "rail_damper_frequency": 800.0, "rail_damper_loss_factor": 0.35}
BED = {"ballast_mass": 300.0, "subgrade_stiffness": 9e7, "subgrade_loss_factor": 0.3}
PAD = StiffnessTable((10.0, 300.0, 2000.0), (150e6, 200e6, 300e6), (15e6, 40e6, 75e6))


def euler(**changes):
    return Track.named("uic60-euler", **changes)


def timoshenko(**changes):
    return Track.named("uic60", **changes)


def test_the_keys_make_the_chain_from_the_rail_down():
    pad = {"under_sleeper_pad_stiffness": 2e8, "under_sleeper_pad_loss_factor": 0.2}
    elements = timoshenko(sleeper_bending_stiffness=6e6, sleeper_length=2.4, **pad, **BED).elements
    assert list(elements) == ["pad", "sleeper", "under_sleeper_pad", "ballast", "ballast mass", "subgrade"]
    assert elements["sleeper"] == BendingSleeper(150.0, 2.4, 6e6, 1.5)
    assert elements["ballast mass"] == RigidMass(300.0)
    for name, (stiffness, loss) in {"under_sleeper_pad": (2e8, 0.2), "subgrade": (9e7, 0.3)}.items():
        spring = elements[name]
        assert isinstance(spring, Spring)
        np.testing.assert_allclose(spring.stiffness(OMEGA), stiffness * (1.0 + 1j * loss))
    assert list(timoshenko().elements) == ["pad", "sleeper", "ballast"]
    assert list(timoshenko(ballast_stiffness=math.inf).elements) == ["pad", "sleeper"]


@pytest.mark.parametrize("make", [euler, timoshenko])
def test_a_foundation_is_the_limit_of_close_supports(make):
    """Of the same stiffness per length, sleepers and ballast with mass among it."""
    spread, names = make(continuous=True, **BED), ("pad", "ballast", "subgrade")
    share = 0.02 / spread.sleeper_spacing
    keys = [f"{name}_{what}" for name in names for what in ("stiffness", "damping")]
    scaled = {key: share * value for key in keys if (value := getattr(spread, key)) is not None}
    masses = {key: share * getattr(spread, key) for key in ("sleeper_mass", "ballast_mass")}
    close = make(sleeper_spacing=0.02, **(BED | scaled | masses))
    x, x0 = [0.0, 0.004, 1.3], [0.0, 0.004, 0.2]
    expected = close.receptance(FREQUENCY, x, x0)
    np.testing.assert_allclose(spread.receptance(FREQUENCY, x, x0), expected, rtol=4e-4)
    assert spread.static_deflection(1.0) == pytest.approx(close.static_deflection(1.0), rel=1e-4)
    slow = [spread.receptance(np.array([f]), 0.0, 0.0)[0].real for f in (0.5, 1.0)]
    at_rest = spread.nominal.static_deflection(1.0)
    assert spread.pinned_pinned_frequency == math.inf
    assert spread.cut_on_frequencies == pytest.approx(close.cut_on_frequencies, rel=1e-9)
    assert spread.foundation_stiffness == pytest.approx(close.foundation_stiffness, rel=1e-9)
    assert at_rest == pytest.approx((4.0 * slow[0] - slow[1]) / 3.0, rel=0.06)  # η of rail and subgrade


@pytest.mark.parametrize("make", [euler, timoshenko])
def test_an_embedded_rail_is_right_at_complex_frequencies(make):
    """Its receptance is analytic in the lower half-plane: the mean on a circle is the value in the middle."""
    track = make(continuous=True, rail_loss_factor=0.0, **DAMPERS)
    for middle, radius in ((900.0 - 400.0j, 300.0), (0.0 - 500.0j, 300.0), (6e3 - 900.0j, 800.0)):
        ring = middle + radius * np.exp(2j * np.pi * (np.arange(64) + 0.5) / 64)
        ring = np.where(ring.real < 0.0, -ring.conj(), ring)  # G(-ω*) = G(ω)*
        values = track.waves(ring).receptance(0.1, 0.1)
        mirrored = (middle + radius * np.exp(2j * np.pi * (np.arange(64) + 0.5) / 64)).real < 0.0
        values = np.where(mirrored, values.conj(), values)
        centre = track.waves(np.array([middle])).receptance(0.1, 0.1)[0]
        assert values.mean() == pytest.approx(centre, rel=1e-9, abs=0.0)


def test_rail_dampers_are_superposed_points():
    """One at mid-span and one support in each bay, against the reactions of 1001 points on the free rail."""
    track, pairs = timoshenko(**DAMPERS), ((0.0, 0.0), (0.3, 0.3), (1.27, 0.1))
    for frequency in (120.0, 800.0, 1063.0):
        omega = 2.0 * np.pi * frequency
        points = [each.stiffness(omega) for each in (track.support, tuned_damper(15.0, 800.0, 0.35))]
        stiffness = np.resize(points, 1001)
        expected = superposed(free_rail(track, omega), stiffness, 0.3 * (np.arange(1001) - 500), pairs)
        found = [track.receptance(frequency, *pair) for pair in pairs]
        np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_bays_with_dampers_that_do_not_differ_are_one_bay():
    track = timoshenko(**DAMPERS)
    cell = replace(track, bays=Bays.equal(3))
    for x, x0 in ((0.0, 0.0), (0.3, 0.3), (2.0, -0.7)):
        expected = track.receptance(FREQUENCY, x, x0)
        np.testing.assert_allclose(cell.receptance(FREQUENCY, x, x0), expected, rtol=1e-9)


def test_a_damper_is_a_mass_on_a_spring():
    """Against the matrix of a mass that carries it; at its frequency its spring is as stated."""
    damper = tuned_damper(15.0, 800.0, 0.35)
    spring = damper.elements[0].stiffness
    assert spring(2.0 * np.pi * 800.0) == pytest.approx(15.0 * (2.0 * np.pi * 800.0) ** 2 * (1 + 0.35j))
    for omega, k, found in zip(OMEGA, spring(OMEGA), damper.stiffness(OMEGA), strict=True):
        inverse = np.linalg.inv([[k + 2e8 - 40.0 * omega**2, -k], [-k, k - 15.0 * omega**2]])
        assert 1.0 / (found + 2e8 - 40.0 * omega**2) == pytest.approx(inverse[0, 0], rel=1e-12, abs=0.0)


def test_a_damper_answers_after_the_rail_only():
    assert Track.named("nordborg", rail_loss_factor=0.0, **DAMPERS).is_causal


# --- measured pads


def test_a_table_is_met_at_its_frequencies_and_held_beyond():
    track = timoshenko(pad_table=PAD)
    at = 2.0 * np.pi * np.array([5.0, 10.0, 300.0, math.sqrt(600e3), 2000.0, 4000.0])
    expected = [150e6 + 15e6j] * 2 + [200e6 + 40e6j, 250e6 + 57.5e6j] + [300e6 + 75e6j] * 2
    np.testing.assert_allclose(track.springs["pad"].stiffness(at), expected, rtol=1e-12)
    assert (track.pad_stiffness, track.pad_damping) == (200e6, None)
    assert track.springs["pad"].at_rest.nominal == pytest.approx(150e6)
    twice = timoshenko(pad_table=PAD, pad_stiffness=400e6).springs["pad"]
    np.testing.assert_allclose(twice.stiffness(at), 2.0 * np.array(expected), rtol=1e-12)
    assert hash(track) == hash(timoshenko(pad_table=PAD))


def test_parts_by_arrays_are_those_by_tuples():
    """Tracks, and what is fitted to them, are kept by their hash."""
    table = StiffnessTable(*map(np.array, (PAD.frequencies, PAD.real, PAD.imaginary)))
    track = replace(Track.named("nordborg", pad_damping=None, pad_table=table), bays=Bays(*np.ones((3, 2))))
    assert table == PAD
    assert causal_track(track) is causal_track(replace(track, pad_table=PAD, bays=Bays.equal(2)))
    relaxation, sleeper = Relaxation(1.0, [0.5], np.array([90.0])), (np.ones(2), np.ones(2), np.ones(2))
    assert hash(relaxation) == hash(Relaxation(1.0, (0.5,), (90.0,)))
    assert MeasuredSleeper(100.0, *sleeper) == MeasuredSleeper(100.0, *[(1.0, 1.0)] * 3)


def test_preloads_are_interpolated_and_held_beyond():
    rows = [(10.0, 100e6, 10e6), (300.0, 120e6, 20e6), (2000.0, 150e6, 30e6)]
    table = np.array([(*row, 18e3) for row in rows] + [(f, 2 * re, 3 * im, 68e3) for f, re, im in rows[::-1]])
    assert list(preloads_of(table)) == [18e3, 68e3]
    for preload, real, imaginary in ((5e3, 120e6, 20e6), (43e3, 180e6, 40e6), (90e3, 240e6, 60e6)):
        at = stiffness_at_preload(table, preload)
        assert (at.real[1], at.imaginary[1]) == pytest.approx((real, imaginary))
    assert stiffness_at_preload(np.array(rows), 0.0).real == (100e6, 120e6, 150e6)
    third = np.array([(*row[:1], 4 * row[1], row[2], 118e3) for row in rows])
    assert stiffness_at_preload(np.vstack([table, third]), 93e3).real[1] == pytest.approx(360e6)


def test_every_layer_relaxes_in_time():
    """Passive, and within 0.6 dB of the force in every band, as check says of loss factors in general."""
    soft = {"under_sleeper_pad_stiffness": 1.5e8, "under_sleeper_pad_loss_factor": 0.2}
    track = Track.named("nordborg-loss-factor", pad_table=PAD, **soft, **BED)
    causal = causal_track(track)
    assert [name for name, each in vars(causal.relaxations).items() if each] == ["rail", *track.springs]
    assert (causal.receptance(np.geomspace(1.0, 2e4, 200), [0.0, 0.3], [0.0, 0.3]).imag < 0.0).all()
    _, error = loss_factor_error(track, Wheel(600.0, 65e3).receptance, 1.2e9, 5000.0).values()
    assert np.abs(error).max() < 0.8


def test_named_frequencies_and_critical_speed_are_those_of_the_nominal_chain():
    soft, bed = {"under_sleeper_pad_stiffness": 1.5e8}, {**BED, "ballast_stiffness": 5e7}
    track = timoshenko(**soft, **bed, **DAMPERS)
    below = 1.0 / (1.0 / 1.5e8 + 1.0 / 5e7 + 1.0 / 9e7)
    assert track.antiresonance_frequency == pytest.approx(
        math.sqrt((180e6 + below) / 150.0) / (2.0 * math.pi)
    )
    for frequency in track.cut_on_frequencies:
        square = (2.0 * math.pi * frequency) ** 2
        rail, sleeper = 180e6 - 60.2 * 0.6 * square, 180e6 + below - 150.0 * square
        assert rail * sleeper == pytest.approx(180e6**2, rel=1e-9)
    foundation = 1.0 / (1.0 / 180e6 + 1.0 / below) / 0.6
    heavy = 60.2 + (150.0 + 300.0 + 15.0) / 0.6
    critical = (4.0 * foundation * track.bending_stiffness / heavy**2) ** 0.25
    assert track.critical_speed == pytest.approx(critical)


test_bad_supports_are_refused = refusals(
    (lambda: timoshenko(ballast_mass=200.0), "only together with subgrade_stiffness"),
    (lambda: timoshenko(subgrade_damping=1e4), "only together with subgrade_stiffness"),
    (lambda: timoshenko(seat_distance=1.4), "only together with sleeper_bending_stiffness"),
    (
        lambda: timoshenko(sleeper_bending_stiffness=6e6, seat_distance=2.6),
        "less than the length of the sleeper, 2.6 m",
    ),
    (lambda: timoshenko(rail_damper_mass=15.0), "received no rail_damper_frequency"),
    (lambda: timoshenko(**(DAMPERS | {"rail_damper_loss_factor": 1.0})), "at most 0.9"),
    (lambda: timoshenko(rail_damper_frequency=800.0), "only together with rail_damper_mass"),
    (lambda: timoshenko(continuous=1), "true or false"),
    (lambda: replace(timoshenko(continuous=True), bays=Bays.equal(2)), "supports that are continuous"),
    (lambda: timoshenko(pad_table=PAD, pad_damping=1e4), "remove pad_damping"),
    (lambda: timoshenko(**BED, subgrade_damping=1e4), "an element is either viscous or has a loss factor"),
    (lambda: StiffnessTable((10.0, 20.0), (1e8, 1e8), (0.0, 0.0)), "3 or more, rising"),
    (lambda: StiffnessTable((10.0, 30.0, 20.0), (1e8,) * 3, (0.0,) * 3), "numbers that do not rise"),
    (lambda: StiffnessTable((10.0, 20.0, 30.0), (1e8,) * 2, (0.0,) * 3), "rows of unequal length"),
    (
        lambda: StiffnessTable((10.0, 20.0, 30.0, 40.0), (1e8,) * 4, (1e6, -1.0, -2.0, 3.0)),
        "an imaginary part below zero from 20 to 30 Hz, by which the pad would make energy",
    ),
    (lambda: StiffnessTable((1.0, 2.0, 3.0), (1e8, 1e8, 0.0), (0.0,) * 3), "real part of zero or less at 3"),
)


def test_a_hammer_strikes_one_rail():
    """Rigid sleepers leave each rail by itself; bending ones join them, and fill the dip of even modes."""
    rigid, bends = timoshenko(), timoshenko(sleeper_bending_stiffness=7e6, sleeper_loss_factor=0.05)
    assert rigid.under_one_rail == (rigid,)
    alike, against = bends.under_one_rail
    assert (alike, against.opposed) == (bends, True)
    dip = np.array([690.0, 700.0, 710.0])
    waves = [each.waves(2.0 * np.pi * dip) for each in (alike, against)]
    x = 0.6 * np.array(EN_15461_BAYS)
    one, both = (
        decay_rate_of_responses(
            x, np.abs(np.mean([[w.receptance(0.3 + d, 0.3) for d in x] for w in them], axis=0))
        )
        for them in (waves, waves[:1])
    )
    np.testing.assert_allclose(decay_rate_en15461(bends, dip), one, rtol=1e-9)
    assert (one > both).all()
    assert (one / both).max() > 1.2


# --- power that goes into a track is dissipated by its parts, each integrated by itself

SOFT = {"under_sleeper_pad_stiffness": 2e8, "under_sleeper_pad_damping": 1e4}
BENT = SOFT | {"sleeper_bending_stiffness": 6e6}
TRACKS = {
    "uic60": Track.named("uic60"),
    "uic60-euler": Track.named("uic60-euler"),
    "all layers": Track.named("nordborg-loss-factor", **BENT, **BED),
    "lossy sleepers": Track.named("uic60", **BENT, sleeper_loss_factor=0.1),
    "in time": causal_track(Track.named("nordborg-loss-factor")),
    "dampers": Track.named("uic60", **DAMPERS),
    "dampers, bending": Track.named("nordborg", **DAMPERS, **BENT),
    "slab-blocks": Track.named("slab-blocks"),
    "embedded": Track.named("embedded", **DAMPERS),
    "embedded, Euler-Bernoulli": Track.named("embedded", shear_stiffness=None, rotary_inertia=None),
    "rigid ground": Track.named("uic60", ballast_stiffness=np.inf),
    "continuous, with sleepers": Track.named("uic60", continuous=True, **BED),
}


@pytest.mark.parametrize("name", TRACKS)
def test_what_goes_in_is_dissipated(name):
    track = TRACKS[name]
    for x in (0.0, 0.11, 0.3, 0.5, 7.9):
        parts = dissipated_power(track, FREQUENCY, x)
        fed = -2.0 * np.pi * FREQUENCY * track.receptance(FREQUENCY, x, x).imag
        np.testing.assert_allclose(sum(parts.values()), fed, rtol=1e-9)
        assert all((power >= 0.0).all() for power in parts.values())
    further = {"rail_damper": track.damper, "sleeper": track.sleeper_loss_factor}
    assert set(parts) == {"rail", *track.springs, *(name for name, there in further.items() if there)}


def test_what_dissipates_nothing_gets_nothing():
    track = Track.named("uic60", pad_damping=None, ballast_damping=None)
    parts = dissipated_power(track, FREQUENCY, 0.2)
    assert not parts["pad"].any()
    assert not parts["ballast"].any()
    assert (parts["rail"] > 0.0).all()


test_bad_questions_of_power_are_refused = refusals(
    ([100.0, 0.0], 0.0, "frequency"),
    ([1.0], np.nan, "force"),
    of=lambda frequency, x: dissipated_power(TRACKS["uic60"], frequency, x),
)
