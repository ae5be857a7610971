"""Laws with a film of oil: bodies and film in series, closed forms; tables and curves alike."""

from dataclasses import replace

import numpy as np
import pytest

from asperity import Crowning, SlicedContact
from asperity.contact.film import Film, LineFilm
from asperity.contact.hertz import in_groove
from asperity.errors import InputError
from asperity.kernels.pointforce import evaluate, evaluate_all
from asperity.kernels.stepping import AS_GUESSED, FOUND, solve_law
from asperity.laws.film import LIGHTEST, WithFilm
from asperity.laws.hertz import HertzLaw
from asperity.laws.layout import force
from asperity.laws.linear import Linear
from asperity.laws.printed import Printed
from asperity.laws.shifted import Shifted
from asperity.laws.table import Table
from asperity.reduction.stiffness import ForceCurve, ForceTable
from asperity.reduction.texture import StateTexture
from asperity.rolling.course import steps_beyond
from asperity.rolling.roll import roll_bodies
from asperity.rolling.steps import largest_values
from asperity.structures.body import Body
from one_contact import Stepped

CONTACT = in_groove(115e9, 3.97e-3, 4.13e-3, 15.55e-3)
FILM = Film(CONTACT, 1.77, 17.3e-3, 18.5e-9)
LOAD = 60.0
K = CONTACT.stiffness_constant
FORCES = LOAD * np.geomspace(1e-3, 8.0, 30)
NEARER = CONTACT.approach(1.0) * FORCES ** (2 / 3) - [FILM.central(each) for each in FORCES]
"""Approach of bodies and film in series, by its definition, m."""
SHORT = np.arange(64) * 1e-5


def looked_up(approaches, heights=0.0):
    """A table of smooth contacts on a path of some height, m."""
    forces = K * np.maximum(np.subtract.outer(approaches, -heights * np.ones(64)), 0.0) ** 1.5
    return Table(ForceTable(forces, approaches, 0.0, 1e-5, np.full(64, -heights)))


def test_bodies_and_film_are_in_series():
    """δ(F) = δ_H(F) − h(F); there is a force before smooth bodies would touch."""
    found = force(WithFilm(HertzLaw(K), FILM, LOAD), np.zeros(30), NEARER)
    np.testing.assert_allclose(found, FORCES, rtol=1e-6)
    assert NEARER[0] < 0.0
    thickest = FILM.central(LIGHTEST * LOAD)
    assert force(WithFilm(HertzLaw(K), FILM, LOAD), [0.0], [-1.2 * thickest]) == 0.0


@pytest.mark.parametrize("height", [0.0, 1e-7])
def test_a_table_has_the_film_of_a_curve(height):
    """Of the same smooth contact, by a few states as scans have them, from its first touch on."""
    states = CONTACT.approach(LOAD) * np.array([0.2, 0.5, 1.0, 1.7, 2.6, 4.2])
    law = WithFilm(looked_up(states, height), FILM, LOAD)
    np.testing.assert_allclose(force(law, np.full(30, 3e-4), NEARER - height), FORCES, rtol=1e-9)
    touch = -height - FILM.central(LIGHTEST * LOAD)
    below, above = force(law, np.full(2, 3e-4), touch + np.array([-1e-12, 1e-12]))
    assert below == 0.0 < above


def test_a_texture_is_followed_as_by_the_dry_law_and_its_states_move_with_the_film():
    """h of two states, straight between them: at the film's approach of a state its own."""
    states = CONTACT.approach(LOAD) * np.array([0.5, 1.5])
    texture = StateTexture(np.array([[0.0] * 64, [2e-8] * 64]), states, 0.0, 1e-5)
    dry = Shifted(ForceCurve.hertz(K), texture)
    law = WithFilm(dry, FILM, LOAD)
    for state, height in zip(states, (0.0, 2e-8), strict=True):
        at = law.nearer(np.array([state]))
        assert float(at[0]) == pytest.approx(state - FILM.central(CONTACT.force(state)))
        found = force(law, [1e-4], at)
        alone = force(WithFilm(HertzLaw(K), FILM, LOAD), [0.0], at - height)
        assert found == pytest.approx(alone, rel=1e-9)


def test_the_curve_with_a_film_is_found_once_for_all_pieces_of_a_path(monkeypatch):
    """Where the curve of the dry law, or its states, are others, it is found anew."""
    found = []
    curve = WithFilm.curve
    monkeypatch.setattr(WithFilm, "curve", lambda self, dry: found.append(dry) or curve(self, dry))
    texture = StateTexture(np.array([[0.0] * 64, [2e-8] * 64]), np.array([1e-6, 2e-6]), 0.0, 1e-5)
    law = WithFilm(Shifted(ForceCurve.hertz(K), texture), FILM, LOAD)
    pieces = [law.prepare(each) for each in np.split(SHORT, 4)]
    assert len(found) == 1
    for positions, piece in zip(np.split(SHORT, 4), pieces, strict=True):
        alone = WithFilm(Shifted(ForceCurve.hertz(K), texture), FILM, LOAD).prepare(positions)
        for name, value in piece._asdict().items():
            np.testing.assert_array_equal(value, getattr(alone, name), name)
    softer = ForceCurve.hertz(0.5 * K)
    moved = StateTexture(texture.heights, texture.approaches + 1e-7, 0.0, 1e-5)
    for other in (Shifted(softer, texture), Shifted(ForceCurve.hertz(K), moved)):
        laid = replace(law, law=other)
        laid._softened.update(law._softened)
        np.testing.assert_array_equal(
            laid.prepare(SHORT).states, WithFilm(other, FILM, LOAD).prepare(SHORT).states
        )
        np.testing.assert_array_equal(
            laid.prepare(SHORT).knots, WithFilm(other, FILM, LOAD).prepare(SHORT).knots
        )


ROUGH = looked_up(CONTACT.approach(LOAD) * np.array([0.1, 0.4, 1.0, 2.0]), 5e-8)
TEXTURED = StateTexture(np.array([[0.0] * 64, [2e-8] * 64]), np.array([1e-6, 3e-6]), 0.0, 1e-5)


@pytest.mark.parametrize(
    "dry",
    [
        replace(
            ROUGH, table=replace(ROUGH.table, forces=ROUGH.table.forces * np.linspace(0.5, 1.0, 4)[:, None])
        ),
        Printed(ForceCurve.hertz(K), TEXTURED, datum=1e-6),
    ],
    ids=lambda law: law.name,
)
def test_tables_and_secants_have_the_forces_of_their_bodies_nearer_by_the_film(dry):
    """F(δ − h(F)) is that of the dry law at δ, whatever its states; its slope is the inverse of the sum."""
    bodies = np.linspace(0.2e-6, 9e-6, 40)
    pressed, stiffness, beyond = evaluate_all(dry.prepare(np.full(40, 2e-4)), bodies, 0)
    film = np.array([FILM.central(each) for each in pressed])
    wet = WithFilm(dry, FILM, LOAD).prepare(np.full(40, 2e-4))
    found, slopes, beyond_with_film = evaluate_all(wet, bodies - film, 0)
    np.testing.assert_allclose(found, pressed, rtol=1e-9)
    np.testing.assert_allclose(1.0 / slopes, 1.0 / stiffness + 0.067 * film / pressed, rtol=1e-9)
    assert beyond == beyond_with_film


def test_a_law_that_is_solved_in_every_step_has_no_film():
    class Solved:
        name = "solved"

        def prepare(self, positions):
            return object()

    with pytest.raises(
        InputError, match="law of a contact with a film: received solved; allowed: one that is"
    ):
        WithFilm(Solved(), FILM, LOAD).prepare(SHORT)


STATES = CONTACT.approach(LOAD) * np.array([0.2, 0.5, 1.0, 1.7, 2.6, 4.2, 8.0])


@pytest.mark.parametrize("beside", [lambda dry: dry, Stepped], ids=["compiled", "from Python"])
@pytest.mark.parametrize("damping", [0.0, 200.0])
def test_in_motion_every_step_meets_bodies_and_film(damping, beside):
    """Two balls bounce over waves, one without film: forces are those of approach and damper, found apart."""
    waves = 1e-6 * np.cos(2.0 * np.pi * np.arange(400) / 25.0)
    pressed = K * np.maximum(np.subtract.outer(STATES, waves), 0.0) ** 1.5
    dry = Table(ForceTable(pressed, STATES, 0.0, 1e-5, waves), damping)
    laws = [beside(dry), WithFilm(dry, FILM, LOAD)]
    run = roll_bodies(
        None, [Body.rigid(0.05, LOAD)] * 2, laws, positions=[0.0, 1e-5], speed=1.0, start=1e-3, duration=2e-3,
        time_step=1e-6,
    )  # fmt: skip
    assert run.unconverged_steps == 0
    for law, place, found, approach in zip(
        (dry, laws[1]), run.positions, run.contact_force, run.relative_displacement, strict=True
    ):
        elastic = force(law, place, approach)
        ahead, now, before = (approach[2 - i : 2001 - i] for i in range(3))
        damped = elastic[2:] + damping * (1.5 * ahead - 2.0 * now + 0.5 * before) / 1e-6
        expected = np.where(elastic[2:] > 0.0, np.maximum(damped, 0.0), 0.0)
        assert np.mean(found == 0.0) > 0.02
        np.testing.assert_allclose(found[2:], expected, rtol=1e-6, atol=3e-6 * LOAD)


def solved(law, free, guess, damping, again=False):
    """Force, elastic part, evaluations and how they were found, at the end of a step of 1 µs."""
    of_step = free, 1e-2, 1e-9, 1.5e-3
    return solve_law.py_func(evaluate, law, law.film, 0, of_step, LOAD, guess, damping, False, 1e-10, again)


def test_a_force_that_is_right_is_found_as_such_beside_a_damper():
    law = WithFilm(looked_up(STATES), FILM, LOAD).prepare(np.full(1, 3e-4))
    found, elastic, evaluations, how, _ = solved(law, 1e-6, 0.0, 30.0)
    assert how == FOUND
    assert found == pytest.approx(elastic + 30.0 * (1e-2 - 1.5e-3 * found), rel=1e-9)
    assert float(evaluate_all(law, np.array([1e-6 - 1e-9 * found]), 0)[0][0]) == pytest.approx(
        elastic, rel=1e-6
    )
    assert evaluations > 1
    assert solved(law, 1e-6, found, 30.0)[2:4] == (1, AS_GUESSED)


def test_a_force_that_is_looked_at_again_is_one_step_of_newton_s_from_a_guess_that_was_near():
    law = WithFilm(looked_up(STATES), FILM, LOAD).prepare(np.full(1, 3e-4))
    exact, elastic, *_ = solved(law, 1e-6, 0.0, 30.0)
    for off in (1e-2, 1e-3):  # what it misses is of second order
        found = solved(law, 1e-6, (1.0 + off) * exact, 30.0, again=True)
        assert found[2:4] == (1, FOUND)
        assert found[:2] == pytest.approx((exact, elastic), rel=0.01 * off**2)
    assert solved(law, 1e-6, 1.2 * exact, 30.0, again=True)[2] > 1
    assert solved(law, -1e-5, 1.0, 30.0, again=True)[:2] == (0.0, 0.0)


def test_a_damper_that_engages_leaves_the_film_where_it_touches():
    """Its jump is as large as it would take to hold the bodies there."""
    law = WithFilm(looked_up(STATES), FILM, LOAD).prepare(np.full(1, 3e-4))
    touch = -FILM.central(LIGHTEST * LOAD)
    found, elastic, _, how, _ = solved(law, touch + 3e-9, 0.0, 1e6)
    assert how == FOUND
    assert found == pytest.approx(3e-9 / 1e-9, rel=1e-6)
    assert elastic == pytest.approx(0.0, abs=1e-6)


def test_what_lies_beyond_the_states_is_told_of_the_bodies():
    """A film short of the last state they are at it; the largest stiffness is that of dry ones."""
    law = WithFilm(looked_up(STATES), FILM, LOAD).prepare(SHORT)
    last = CONTACT.force(STATES[-1])
    there = STATES[-1] - FILM.central(last)
    assert steps_beyond(law, 0, there + np.linspace(-2e-9, 2e-9, 64)) == 32
    stiffness, _, force_there = largest_values(law, 1.0)
    assert stiffness == pytest.approx(CONTACT.tangent_stiffness(STATES[-1]), rel=1e-6)
    assert force_there == pytest.approx(last, rel=1e-6)


def test_a_linear_law_is_softer_and_nearer_by_the_film():
    """Through (s0 − h, P) with the stiffness of bodies and film in series."""
    approach = CONTACT.approach(LOAD)
    stiffness = CONTACT.tangent_stiffness(approach)
    law = WithFilm(Linear(LOAD, stiffness, approach, None), FILM, LOAD)
    at = approach - FILM.central(LOAD) + np.array([0.0, 1e-8])
    working, further = force(law, np.zeros(2), at)
    assert working == pytest.approx(LOAD)
    assert (further - working) / 1e-8 == pytest.approx(FILM.stiffness(LOAD), rel=1e-6)
    assert FILM.stiffness(LOAD) < stiffness


def test_a_roller_and_its_film_are_in_series():
    """δ(F) = δ(F) of the slices − h(F), h ~ F^-0.166; of crowned ones, too."""
    for crowning in (Crowning("cylindrical", 8e-3), Crowning.iso(8e-3, 7.5e-3)):
        roller = SlicedContact(115e9, 3e-3, crowning)
        film = LineFilm(roller, 1.77, 17.3e-3, 18.5e-9)
        load = 800.0
        at = roller.approach(8.0 * load) * np.geomspace(1e-3, 1.0, 200)
        pressed = roller.pressed(at)
        dry = ForceCurve.from_samples(at, pressed.force, 10 / 9, pressed.stiffness[:, 0, 0])
        forces = load * np.geomspace(0.01, 6.0, 20)
        apart = film.central(load) * (forces / load) ** -0.166
        law = WithFilm(Shifted(dry, None), film, load)
        np.testing.assert_allclose(force(law, np.zeros(20), dry.inverse(forces) - apart), forces, rtol=2e-3)
        state = roller.approach(load)
        assert float(law.nearer(np.array([state]))[0]) == pytest.approx(state - film.central(load))
