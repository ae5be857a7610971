"""Wear: closed forms of what friction takes, the balance of work and volume, places, passes, and messages."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from asperity import ArchardWear, EnergyWear, FrictionalHalfSpace, HalfSpace, HeightMap, Hertz, Material
from asperity.contact import tangential
from asperity.contact.wear import Rubbing, rubbing, wear_depth, worn
from asperity.errors import InputError, OutOfRangeWarning, UnconvergedWarning
from asperity.store import Store
from asperity.surfaces.synthesis import self_affine
from refusals import refusals

SHEAR, LOAD, SIDE = 80e9, 60e3, 16e-3
LINEAR = EnergyWear(plateau=math.inf, onset=math.inf)
VOLUME = LINEAR.mild / LINEAR.density  # m³/J


def wheel(n, friction, radii=(0.4, 0.4), nu=0.0, side=SIDE, across=1.0):
    """Its shape on n² cells, so much wider than long, and two like bodies."""
    x = side / n * (np.arange(n) - 0.5 * (n - 1))
    body = Material("body", 2.0 * SHEAR * (1.0 + nu), nu, 7850.0)
    space = HalfSpace((n, n), (side / n, across * side / n), SHEAR / (1.0 - nu))
    gap = x[:, None] ** 2 / (2 * radii[0]) + (across * x) ** 2 / (2 * radii[1])
    return gap, FrictionalHalfSpace(space, (body, body), friction)


def rough(rows, n=24, rms=1e-6):
    d = SIDE / n
    waves = {"longest": 8 * d, "shortest": 3 * d}
    return self_affine((rows, n), (d, d), rms=rms, hurst=0.8, seed=3, **waves).heights


def test_full_sliding_wears_as_its_closed_form_across():
    """∫ µ p ξ dx = µ ξ (π/2) p₀ a (1 − y²/b²), with an error of at least the first order in the cells."""
    radii, load, mu, xi = (0.46, 0.3), 80e3, 0.01, 0.05
    smooth, errors = Hertz(SHEAR, *radii), []
    b = smooth.semi_axes(smooth.approach(load))[1]
    for n in (12, 24, 48):
        gap, rolling = wheel(n, mu, radii, side=18e-3, across=0.8)
        found = rolling.roll(rolling.half_space.solve(gap, load=load), (xi, 0.0))
        y = 0.8 * 18e-3 / n * (np.arange(n) - 0.5 * (n - 1))
        peak = VOLUME * mu * xi * 0.75 * load / b
        expected = peak * np.maximum(1.0 - (y / b) ** 2, 0.0)
        depth = wear_depth(rolling, found, LINEAR)
        errors.append(np.abs(depth - expected).sum() / expected.sum())
    assert errors[2] < 2e-3
    assert errors[2] < 0.5 * errors[1] < 0.25 * errors[0]
    archard = ArchardWear(2e9, 1e-4, 1e-4, 1e-4)  # p s/H is friction work over µ H where all slips
    assert wear_depth(rolling, found, archard) == pytest.approx(1e-4 / (mu * 2e9) / VOLUME * depth, rel=1e-6)
    assert not rubbing(rolling, found, found).sliding[:, 0].any()


def test_small_creepage_wears_as_kalkers_force_and_only_where_it_slips():
    """Volume over distance of G ab c₁₁ ξ², c₁₁ = 4.12 as printed for a circle and ν = 0.25."""
    gap, rolling = wheel(48, 3.0, nu=0.25)
    contact = rolling.half_space.solve(gap, load=LOAD)
    found = rolling.roll(contact, (1e-4, 0.0))
    a = (0.75 * LOAD * 0.4 / rolling.half_space.modulus) ** (1 / 3)
    volume = wear_depth(rolling, found, LINEAR).sum() * SIDE / 48
    assert volume == pytest.approx(VOLUME * SHEAR * a**2 * 4.12 * 1e-4**2, rel=0.02)
    assert found.stick_area > 0.9 * contact.area
    for motion in (found, rolling.roll(contact, (1e-4, 0.0), 0.02)):
        work = rubbing(rolling, motion, motion).work
        assert np.abs(work[motion.sticks]).sum() < 1e-5 * work.sum()


@pytest.mark.parametrize("n", [12, 24])
def test_the_work_is_that_of_the_forces_and_of_what_is_stored(n):
    """Over every step of a transient on a rough surface, under a load that changes, to rounding."""
    gap, rolling = wheel(n, 0.3, nu=0.3)
    space, heights, (xi, eta, spin) = rolling.half_space, rough(n + 8, n), (1e-3, -4e-4, 0.05)
    dx, states, done = SIDE / n, [], 0.0

    def stored(state):
        traction = state.traction[0] + 1j * state.traction[1]
        moved = rolling.displacement(traction, state.normal.pressure)
        return 0.5 * float((traction.conj() * moved).real.sum()) * space.cell_area

    for i in range(8):
        contact = space.solve(gap - heights[i : i + n], load=LOAD * (1.0 + 0.05 * i))
        before = states[-1] if states else None
        states.append(rolling.roll(contact, (xi, eta), spin, before=before))
        if before is not None:
            done += rubbing(rolling, states[-1], before).work.sum() * space.cell_area * dx
    ends = [-(s.force[0] * xi + s.force[1] * (eta + spin * dx / 6) + s.moment * spin) for s in states]
    # what was there before has moved back by a cell, and with it the arm of its moment
    back = [dx * spin * s.force[1] for s in states[:-1]]
    given = 0.5 * dx * (sum(ends[1:]) + sum(ends[:-1]) + sum(back))
    assert done == pytest.approx(given + stored(states[0]) - stored(states[-1]), abs=1e-9 * given)
    assert abs(stored(states[-1]) - stored(states[0])) > 1e-3 * given


@pytest.mark.parametrize("cells", [48, 24, 16])
def test_wear_of_a_varying_load_is_that_of_a_flat_punch(cells):
    """In full sliding a little more load is carried evenly along: the wave of wear is sin(ka)/(ka) of its."""
    gap, rolling = wheel(24, 0.01)
    dx, k = SIDE / 24, 2.0 * math.pi / (cells * SIDE / 24)
    rail, a = np.zeros((48 + cells, 24)), (0.75 * LOAD * 0.4 / SHEAR) ** (1 / 3)
    middle = dx * (np.arange(25 + cells) + 11.5)
    after = worn(rolling, rail, gap, LOAD * (1.0 + 0.02 * np.cos(k * middle)), LINEAR, (0.05, 0.0))
    x, line = dx * np.arange(24, 24 + cells), after.depth[24 : 24 + cells].sum(axis=1)
    wave = 2.0 * np.mean(line * np.exp(-1j * k * x)) / np.mean(line) / 0.02
    assert wave == pytest.approx(math.sin(k * a) / (k * a), abs=5e-3)


def test_what_is_removed_is_what_is_missing():
    """After many passes in all regimes."""
    gap, rolling = wheel(24, 0.3, nu=0.3)
    law, surface = EnergyWear(plateau=5e-3, onset=1e6), HeightMap(rough(60), (SIDE / 24,) * 2, "made")
    after = worn(rolling, surface, gap, LOAD, law, (2e-3, 0.0), 0.05, passes=30, step=20e-9)
    missing = (surface.heights - after.surface.heights).sum() * (SIDE / 24) ** 2
    assert after.removed == pytest.approx(missing, rel=1e-9, abs=0.0)
    assert after.passes.sum() == 30
    assert 3 < len(after.passes) < 30
    assert after.surface.source == "made; worn by 30 passes"
    assert min(after.shares.values()) > 0.05
    assert after.surface.heights[24:36, 8:16].std() < surface.heights[24:36, 8:16].std()


def test_mild_wear_is_in_proportion_to_the_work_and_steps_are_small_against_the_roughness():
    gap, rolling = wheel(24, 0.3, nu=0.3)
    job = (rolling, rough(28, rms=0.1e-6), gap, LOAD, LINEAR, (1e-3, 0.0), 0.0, 30)
    after, same = worn(*job), worn(*job, step=0.1 * job[1].std())
    assert after.removed == pytest.approx(VOLUME * after.work.sum(), rel=1e-9, abs=0.0)
    assert after.passes.tolist() == same.passes.tolist() != [30]


def test_a_closed_surface_has_no_beginning():
    gap, rolling = wheel(24, 0.3, nu=0.3)
    one, other = (
        worn(rolling, np.roll(rough(30), by, axis=0), gap, LOAD, LINEAR, (1e-3, 0.0), closed=True).depth
        for by in (0, 11)
    )
    assert np.abs(np.roll(one, 11, axis=0) - other).max() < 2e-3 * one.max()


def test_a_smooth_surface_is_worn_by_each_pass_as_by_steady_rolling():
    gap, rolling = wheel(24, 0.3, nu=0.3)
    steady = rolling.roll(rolling.half_space.solve(gap, load=LOAD), (2e-3, 0.0))
    after = worn(rolling, np.zeros((50, 24)), gap, LOAD, LINEAR, (2e-3, 0.0))
    expected = wear_depth(rolling, steady, LINEAR)
    assert np.abs(after.depth[23:27] - expected).max() < 1e-4 * expected.max()


def test_what_stands_out_is_worn_where_it_stands():
    gap, rolling = wheel(24, 0.3, nu=0.3)
    rail = np.zeros((64, 24))
    rail[30, 12] = 2e-6
    job = (gap, LOAD, LINEAR, (0.02, 0.0))
    bare, bumped = (worn(rolling, each, *job, step=1e-6).depth for each in (0.0 * rail, rail))
    assert np.unravel_index((bumped - bare).argmax(), rail.shape) == (30, 12)


def test_a_part_that_was_kept_is_not_rolled_again(tmp_path):
    gap, rolling = wheel(16, 0.3, nu=0.3)
    job = (rolling, rough(24, 16), gap, LOAD, EnergyWear(), (3e-3, 0.0))
    whole, how = worn(*job, passes=3, step=12e-9), {"passes": 3, "step": 12e-9, "cache": Store(tmp_path)}

    def stop(done, total, message):
        if message == "wear, pass 3 of 3":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        worn(*job, **how, progress=stop)
    again = []
    resumed = worn(*job, **how, progress=lambda *said: again.append(said))
    assert whole.passes.tolist() == resumed.passes.tolist() == [2, 1]
    assert {message for *_, message in again} == {"wear, pass 3 of 3"}
    assert again[-1][:2] == (9, 9)
    assert np.array_equal(resumed.depth, whole.depth)
    other = worn(*job[:4], EnergyWear(density=8000.0), (3e-3, 0.0), **how)
    assert other.removed == pytest.approx(whole.removed * 7850.0 / 8000.0, rel=1e-3, abs=0.0)


def test_the_cache_tells_laws_apart_by_every_place_of_their_maps(tmp_path):
    """Of more places, and more digits, than numpy writes down unasked."""
    gap, rolling = wheel(34, 0.3)
    for middle in (0.0, 1e-12):
        depth = np.full((34, 34), 1e-3)
        depth[17, 17] += middle
        law = Given((depth, np.zeros((34, 34), dtype=int)))
        after = worn(rolling, np.zeros((34, 34)), gap, LOAD, law, (1e-3, 0.0), cache=Store(tmp_path))
        assert after.depth[17, 17] == pytest.approx(depth[17, 17] * SIDE / 34, rel=1e-14, abs=0.0)


@pytest.mark.parametrize(
    ("work", "mass", "regime"),
    [(5e6, 26.5e-3, 0), (40e6, 55e-3, 1), (100e6, 55e-3 + 61.9e-3 * 22.8, 2), (0.0, 0.0, 0)],
)
def test_energy_wears_as_printed(work, mass, regime):
    """5.3 Tγ/A, 55.0, and 61.9 for each N/mm² above 77.2: 1 µg/(m mm²) is 1e-3 kg/m³."""
    nothing = np.zeros((1, 1))
    depth, found = EnergyWear().removal(Rubbing(nothing + work, nothing, nothing, 1.0))
    assert depth.item() == pytest.approx(mass / 7850.0, rel=1e-12, abs=0.0)
    assert found.item() == regime


@pytest.mark.parametrize(
    ("pressure", "velocity", "factor", "regime"),
    [(1e9, 0.1, 5.5e-4, 0), (1e9, 0.5, 35e-4, 1), (1e9, 0.9, 5.5e-4, 0), (2.5e9, 0.5, 350e-4, 2)],
)
def test_archard_wears_by_velocity_and_pressure(pressure, velocity, factor, regime):
    cell = np.ones((1, 1))
    rubs = Rubbing(0.0 * cell, pressure * cell, velocity / 30.0 * cell, 30.0)
    depth, found = ArchardWear(3e9).removal(rubs)
    assert depth.item() == pytest.approx(factor * pressure * velocity / 30.0 / 3e9, rel=1e-12, abs=0.0)
    assert found.item() == regime


@pytest.mark.parametrize("n", [14, 20, 30])
def test_borders_between_regimes_cross_cells(n):
    """Hertz's pressure, catastrophic above a share of the peak, and slip that rises past a border.

    Within the circle where p > L the integral of p is ⅔πp₀ (1 − (L/p₀)³), radius and slip being one. By whole
    cells some are 8 % off on 14² cells, 5 % on 30².
    """
    for offset in (0.0, 0.2, 0.5):
        x, y = ((np.arange(n) - 0.5 * (n - 1) + each * offset) * 2.3 / n for each in (1.0, 0.3))
        pressure, one = np.sqrt(np.maximum(1.0 - np.add.outer(x**2, y**2), 0.0)), np.ones((n, n))
        for share in (0.6, 0.8, 0.9):
            law = ArchardWear(share / 0.8)
            removed = law.removal(Rubbing(pressure, pressure, one, 1.0))[0].sum() * (2.3 / n) ** 2
            factor = law.mild + (law.catastrophic - law.mild) * (1.0 - share**3)
            assert removed == pytest.approx(factor / law.hardness * 2 / 3 * math.pi, rel=5.0 / n**2)
        law, slip = ArchardWear(1e3), 0.2 * (1.0 + x[:, None]) * one  # severe at x > 0, half of the patch
        removed = law.removal(Rubbing(pressure, pressure, slip, 1.0))[0].sum() * (2.3 / n) ** 2
        # ∫p over half of the circle is π/3, ∫px is π/8
        expected = 0.2 * (law.mild * (math.pi / 3 - math.pi / 8) + law.severe * (math.pi / 3 + math.pi / 8))
        assert removed == pytest.approx(expected / law.hardness, rel=5.0 / n**2)


GAP, ROLLING = wheel(8, 0.3)
RAIL, NOTHING = np.zeros((9, 8)), np.zeros((8, 8))
NO_REGIME = 3 + NOTHING.astype(int)
ROLLED = {
    "rolling": ROLLING,
    "law": LINEAR,
    "contact": ROLLING.roll(ROLLING.half_space.solve(GAP, load=LOAD)),
}


class Nameless:
    removal = EnergyWear.removal


@dataclass(frozen=True)
class Given:
    """A law that removes what it is told, whatever that is."""

    answer: object

    def removal(self, rubbing):
        return self.answer


def wear(surface=RAIL, load=LOAD, law=LINEAR, body=GAP, rolling=ROLLING, **keywords):
    worn(rolling, surface, body, load, law, **keywords)


test_what_has_no_meaning_is_refused = refusals(
    (EnergyWear, {"mild": 0.0}, "mild of EnergyWear: received 0.0"),
    (EnergyWear, {"plateau": math.nan}, "plateau of EnergyWear: received nan"),
    (EnergyWear, {"onset": 1e6}, r"onset: received 1e\+06 Pa; allowed: at least the 1.038e\+07 Pa of"),
    (ArchardWear, {"hardness": -1.0}, "hardness of ArchardWear: received -1.0"),
    (ArchardWear, {"hardness": 3e9, "velocities": 0.2}, "velocities: received 0.2; allowed: two slip"),
    (ArchardWear, {"hardness": 3e9, "velocities": (0.7, 0.2)}, "velocities: received numbers that"),
    (wear, {"rolling": ROLLING.half_space}, "bodies that roll: received HalfSpace; allowed: a half"),
    (wear, {"law": 1e-4}, r"law of wear: received float; allowed: an object with removal"),
    (wear, {"law": Nameless(), "cache": Store(".")}, "received one without fields to keep it by"),
    (wear, {"law": Given(None)}, "removal of Given: received None; allowed: depth over rolled distance"),
    (wear, {"law": Given((NOTHING + math.nan, NOTHING))}, "removal of Given: received nan"),
    (wear, {"law": Given((NOTHING[1:], NOTHING))}, r"removal of Given: received shape \(7, 8\)"),
    (wear, {"law": Given((NOTHING, NOTHING))}, "removal of Given: received regimes of float64"),
    (wear, {"law": Given((NOTHING, NO_REGIME))}, "removal of Given: received regimes of int64"),
    (wear_depth, ROLLED | {"contact": None}, "contact: received none of these bodies; allowed: one that"),
    (wear_depth, ROLLED | {"rolling": wheel(8, 0.2)[1]}, "contact: received none of these bodies"),
    (wear, {"surface": RAIL[:, :6]}, "window of wear: received 8 × 8 cells on a surface of 9 × 6"),
    (wear, {"body": GAP[:4]}, r"body that wears: received shape \(4, 8\); allowed: lengths in m"),
    (wear, {"load": 0.0}, "load: received 0.0; allowed: a force above 0"),
    (wear, {"load": [LOAD] * 3}, r"load: received an array of shape \(3,\).*one for each of 2 positions"),
    (wear, {"passes": 0}, "passes: received 0; allowed: a whole number from 1 to 1e12"),
    (wear, {"speed": 0.0}, "rolling speed: received 0.0"),
    (wear, {"step": 0.0}, "step: received 0.0"),
    (wear, {"rtol": 1.0}, "rtol: received 1.0"),
    (wear, {"creepage": 0.01}, "creepage: received 0.01; allowed: two numbers"),
    of=lambda call, keywords: call(**keywords),
)


def test_a_pass_that_removes_much_is_told():
    with pytest.warns(OutOfRangeWarning, match=r"a single pass removes 1.86 nm, more than the 1 nm after"):
        wear(creepage=(2e-3, 0.0), step=1e-9)


def test_a_contact_that_does_not_roll_wears_nothing():
    shifted = ROLLING.shift(ROLLING.half_space.solve(GAP, load=LOAD), (1e-6, 0.0))
    with pytest.raises(InputError, match="contact: received one that was shifted, or stands; allowed: one"):
        wear_depth(ROLLING, shifted, LINEAR)


def test_tractions_that_did_not_converge_are_counted_and_told(monkeypatch):
    """The pressure converged; the friction on it was not let to."""
    monkeypatch.setattr(tangential, "MAX_ITERATIONS", 1)
    with pytest.warns(UnconvergedWarning, match="2 of 2 contact solutions of wear"):
        after = worn(ROLLING, RAIL, GAP, LOAD, LINEAR, (2e-4, 0.0), 0.1)
    assert after.counts.unconverged == after.counts.solved == 2
