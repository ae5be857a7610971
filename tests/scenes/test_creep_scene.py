"""A wheel that creeps in a run: signs, friction in time, no trace without [creep], and who squeals."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import asperity
from asperity.case.beam import BallOnBeam
from asperity.case.bodies import WheelOnRail
from asperity.contact.creep import creep_curve
from asperity.contact.hertz import stick_stiffness
from asperity.contact.wear import EnergyWear, wear_depth
from asperity.errors import CaseError
from asperity.reference.materials import MATERIALS
from asperity.scenarios.preparing import prepare
from asperity.scenes import schema
from asperity.scenes.compute import compute
from asperity.scenes.creep import (
    _wear,
    creep_group,
    friction_of,
    rough_strips,
    shape_with_friction,
    smooth_with_friction,
    states_of,
)
from asperity.scenes.figures.sideways import CREEP, creep_answers, friction_table
from asperity.scenes.result import computed_result
from asperity.schema import tree
from asperity.structures.lateral_rail import LateralTrack, wheel_receptances
from asperity.structures.squeal import ringing_modes, standing_modes
from asperity.studies.member import kept
from asperity.surfaces.cell_means import pressed_heights
from small_cases import BALL, BODIES, HEARD

ATTACK, SPEED = 0.012, 20.0
FALLING = {"angle_of_attack": ATTACK, "kinetic": 0.5, "falling_velocity": 0.3}
KEYS = HEARD | {"speed": SPEED, "duration": "60 ms", "settling": "20 ms"}
KEYS |= {"wheel": {"roughness": "disc", "section": "straight-web"}}
KEYS |= {"numerics": {"highest_frequency": "2 kHz", "kernel": "scatter"}}
KEYS |= {"contact": {"spacing": "1 mm", "samples": 2, "sample_length": "60 mm"}}


@pytest.fixture(scope="module")
def computed(cache_of_module):
    return compute(prepare(WheelOnRail(**KEYS | {"creep": FALLING})), lambda *_: None)


@pytest.fixture(scope="module")
def creeping(computed):
    """What is laid out of one run with other keys of [creep]."""

    def group(creep, modes=computed.scene.modes, rim_cells="auto", **sideways):
        contact = KEYS["contact"] | {"rim_cells": rim_cells}
        case = WheelOnRail(**KEYS | {"creep": creep, "sideways": sideways, "contact": contact})
        return creep_group(replace(computed, case=case, scene=replace(computed.scene, modes=modes)))

    return group


@pytest.fixture(scope="module")
def falling(creeping):
    return creeping(FALLING)


def answer(values):
    return creep_answers(tree({entry: each for entry, each in values.items() if entry.group == "creep"})).more


def test_a_wheel_that_heads_for_the_field_side_creeps_to_the_other_and_is_pushed_there(falling, creeping):
    """η = −tan α, beside what the case says of η itself; friction acts against it."""
    assert falling[schema.CREEPAGE] == (0.0, pytest.approx(-math.tan(ATTACK), rel=1e-12), 0.0)
    assert np.all(np.array(falling[schema.SAMPLE_FRICTION])[:, 1] > 0.0)
    both = creeping({"angle_of_attack": -ATTACK, "lateral": 0.002, "longitudinal": 0.001, "spin": 0.2})
    assert both[schema.CREEPAGE] == (0.001, pytest.approx(math.tan(ATTACK) + 0.002), 0.2)
    (along, across), moment = both[schema.SAMPLE_FRICTION][0], both[schema.SPIN_MOMENT][0]
    assert max(along, across) < 0.0
    driven = -SPEED * (along * 0.001 + across * (math.tan(ATTACK) + 0.002) + moment * 0.2)
    assert both[schema.SAMPLE_HEAT][0] == pytest.approx(driven, rel=1e-12)
    assert creeping({}) == creeping({"angle_of_attack": 0.0}) == {}
    asked = friction_of(WheelOnRail(**KEYS | {"creep": FALLING, "contact": {"friction": 0.4}}))
    assert (asked.static, asked.kinetic, asked.velocity) == (0.4, 0.5, 0.3)


@pytest.mark.parametrize(
    ("contact", "cells"),
    [
        ({}, "covered"),
        ({"rim_cells": "covered"}, "covered"),
        ({"rim_cells": "whole"}, "whole"),
        ({"hardness": "4 GPa"}, "whole"),
    ],
)
def test_smooth_bodies_creep_on_covered_cells(contact, cells):
    """And not by more than Kalker's linear theory, as on whole cells of the same grid."""
    case = WheelOnRail(**KEYS | {"contact": KEYS["contact"] | contact})
    prepared = prepare(case)
    rolling, smooth = smooth_with_friction(prepared, friction_of(case))
    assert rolling.half_space.cells == smooth.half_space.cells == cells
    assert smooth.force == pytest.approx(prepared.shape.load, rel=1e-6)
    curve = creep_curve(rolling, smooth, prepared.shape.semi_axes, count=12)
    assert curve.slopes[0] < 1.0 if cells == "covered" else curve.slopes[0] > 1.01
    assert curve.force[0, -1] == pytest.approx(curve.limit, rel=1e-3)


def test_covered_cells_with_friction_are_not_long():
    prepared = prepare(WheelOnRail(**KEYS))
    h = prepared.shape.spacing[0]
    for sides, cells in (((h, 0.4 * h), "whole"), ((0.4 * h, h), "whole"), ((h, 0.6 * h), "covered")):
        one = SimpleNamespace(case=prepared.case, shape=replace(prepared.shape, spacing=sides))
        assert shape_with_friction(one).cells == cells


def test_samples_and_states_are_those_of_the_cells_of_friction(monkeypatch):
    """A case whose law sees no heights has whole cells otherwise, and textures at points."""
    monkeypatch.setattr("asperity.scenes.creep.traction_states", lambda *of: of)
    for rim_cells in ("auto", "whole"):
        prepared = prepare(WheelOnRail(**KEYS | {"contact": KEYS["contact"] | {"rim_cells": rim_cells}}))
        assert prepared.shape.cells == "whole"
        space, _, body, samples, *_ = states_of(prepared, 2, None)
        assert space.cells == ("whole" if rim_cells == "whole" else "covered")
        np.testing.assert_array_equal(body, shape_with_friction(prepared).body)
        heights = prepared.textures.strips[0].heights
        pressed = heights if rim_cells == "whole" else pressed_heights(heights)
        np.testing.assert_allclose(np.diff(samples[0], axis=0), np.diff(pressed, axis=0), atol=1e-18)


def test_friction_follows_the_contact_force_by_its_coefficient_in_full_slip(computed, creeping):
    """µ N to the field side, and its heat µ N V η, at every moment."""
    found, force = creeping({"angle_of_attack": 0.03}), computed.stacked("contact_force")
    assert np.ptp(force) > 0.1 * force.mean()
    np.testing.assert_allclose(found[schema.FRICTION_FORCE][:, :, 1], 0.3 * force, rtol=2e-3)
    np.testing.assert_allclose(found[schema.FRICTION_POWER], 0.3 * force * SPEED * math.tan(0.03), rtol=3e-3)
    assert found[schema.MEAN_FRICTION_POWER] == pytest.approx(found[schema.FRICTION_POWER].mean(), rel=1e-12)
    assert (*found[schema.FULL_SLIP_SHARE], *found[schema.STICK_AREA]) == (1.0, 0.0, 0.0, 0.0)
    assert found[schema.SLIP_VELOCITY].max() < 1.5 * SPEED * 0.03
    little = creeping({"lateral": 0.0035})
    assert np.all(np.array([little[schema.STICK_AREA], little[schema.SLIP_AREA]]) > 0.0)
    assert little[schema.FULL_SLIP_SCALE] > 1.0
    assert np.any((little[schema.SLIP_VELOCITY] == 0.0) & (little[schema.TRACTION] > 0.0))
    for none in (found, little):  # by symmetry there is no force along, and no rounding in its place
        assert not np.any([none[schema.SAMPLE_FRICTION][0][0], *none[schema.FRICTION_FORCE][:, :, 0].ravel()])
    assert little[schema.FULL_SLIP_SHARE] == np.mean(force <= little[schema.FULL_SLIP_LOAD])


@pytest.mark.parametrize("rim_cells", ["covered", "whole"])
def test_what_steps_over_a_sample_miss_is_added(computed, creeping, monkeypatch, rim_cells):
    """A sample without roughness slips, sticks and pulls as smooth bodies do; whole cells have long steps."""
    smooth = np.zeros_like(rough_strips(computed)[0])
    monkeypatch.setattr("asperity.scenes.creep.rough_strips", lambda of: [smooth])
    found = creeping({"lateral": 0.002, "spin": 0.3}, rim_cells=rim_cells)
    for entry in (schema.STICK_AREA, schema.SLIP_AREA, schema.SPIN_MOMENT, schema.SAMPLE_HEAT):
        both = np.array(found[entry])
        assert both[1] == pytest.approx(both[0], rel=2e-3)
    assert found[schema.SAMPLE_FRICTION][1] == pytest.approx(found[schema.SAMPLE_FRICTION][0], rel=2e-3)


def test_a_wheel_in_flight_does_not_slip(computed, creeping, monkeypatch):
    """Of a force that is off for a quarter of the time, all the rest slips: three quarters."""
    force = computed.stacked("contact_force").copy()
    force[..., : force.shape[-1] // 4] = 0.0
    apart = np.mean(force == 0.0)
    monkeypatch.setattr(type(computed), "stacked", lambda self, name: force)
    found = creeping({"angle_of_attack": 0.03})
    assert found[schema.FULL_SLIP_SHARE] == pytest.approx(1.0 - apart, rel=1e-12)
    assert 0.2 < apart < 0.3
    assert not np.any(found[schema.FRICTION_POWER][force == 0.0])


def test_axial_modes_squeal_by_falling_friction_and_move_by_themselves(computed, falling, creeping):
    """No approach and no force is left over, on the rail at mid-span. Constant friction damps."""
    growth, fastest = falling[schema.GROWTH_RATE], int(np.nanargmax(falling[schema.GROWTH_RATE]))
    assert np.sum(growth > 1.0) >= 4
    assert falling[schema.AXIAL_SHARE][growth > 1.0].min() > 0.9
    omega = np.array([2.0 * np.pi * falling[schema.SQUEAL_FREQUENCY][fastest] - 1j * growth[fastest]])
    both = wheel_receptances(computed.scene.modes, 600.0, omega / (2.0 * np.pi), 0.0)
    both += LateralTrack(computed.track.nominal).answers(omega, 0.3, 0.3, 0.0)
    (vv, vl), (_, ll) = both[..., 0]
    stick = stick_stiffness(computed.shape.semi_axes, (MATERIALS["steel"],) * 2)
    slip, slope = 1j * omega[0] * falling[schema.CREEP_DAMPING], falling[schema.LOAD_SLOPE]
    matrix = [[1.0 / computed.stiffness + vv, vl], [slope + slip * vl, 1.0 + slip * (ll + 1.0 / stick)]]
    assert abs(np.linalg.det(matrix)) < 1e-6 * abs(matrix[0][0])
    constant = creeping({"angle_of_attack": ATTACK})
    assert constant[schema.GROWTH_RATE].max() < 0.0
    assert "Squeal: no, all " in answer(constant)
    assert falling[schema.SQUEAL_GROWTH] == np.nanmax(growth) > 0.0 > constant[schema.SQUEAL_GROWTH]


def test_modes_that_squeal_hardly_know_what_carries_the_wheel_sideways(creeping, monkeypatch):
    """Held instead of free: their growth changes by a tenth, that of n = 0 by more."""
    free = creeping({"angle_of_attack": -ATTACK}, contact_place="15 mm")
    monkeypatch.setattr(
        "asperity.structures.lateral_rail.wheel_receptances",
        lambda modes, mass, *at: wheel_receptances(modes, 1e9, *at),
    )
    held = creeping({"angle_of_attack": -ATTACK}, contact_place="15 mm")
    growth, changed = free[schema.GROWTH_RATE], held[schema.GROWTH_RATE] - free[schema.GROWTH_RATE]
    squeals = (free[schema.SQUEAL_DIAMETERS] >= 2) & (growth > 1.0)
    assert np.count_nonzero(squeals) >= 4
    assert np.all(np.abs(changed[squeals]) < 0.1 * growth[squeals].max())
    first = np.argmin(np.where(free[schema.SQUEAL_DIAMETERS] == 0, free[schema.SQUEAL_FREQUENCY], np.inf))
    assert abs(changed[first]) > 0.3 * abs(growth[first])


def test_modes_that_move_the_axle_are_told_but_do_not_squeal(computed, falling, creeping, monkeypatch):
    """Constant friction, the contact off the middle: pairs of waves are counted once, n = 0 and 1 aside.

    The fastest mode is given one nodal diameter here, as a bent web has it.
    """
    modes, places = computed.scene.modes, []

    def ringing(modes, place, *motion):
        places.append(place)
        return ringing_modes(modes, place, *motion)

    monkeypatch.setattr("asperity.scenes.creep.ringing_modes", ringing)
    bent = replace(modes, nodal_diameters=np.where(modes.nodal_diameters == 3, 1, modes.nodal_diameters))
    constant = creeping({"angle_of_attack": -ATTACK}, bent, contact_place="15 mm")
    assert places == [15e-3]
    growth, diameters = constant[schema.GROWTH_RATE], constant[schema.SQUEAL_DIAMETERS]
    grows, believed = np.nan_to_num(growth, nan=-1.0) > 0.0, diameters >= 2
    shapes, looked = (
        set(constant[schema.SQUEAL_SHAPE][each].tolist()) for each in (grows & believed, believed)
    )
    assert 0 < len(shapes) < np.sum(grows & believed)
    told = answer(constant)
    assert f"Squeal: yes, {len(shapes)} of {len(looked)} modes of the wheel with two and more nodal" in told
    assert " by mode coupling (linear stability); fastest axial n = 2 at " in told
    first = 1e3 / constant[schema.SQUEAL_GROWTH]
    assert f", the first e-fold in {first:.3g} ms" in told
    share = growth[grows & believed] / (2.0 * np.pi * constant[schema.SQUEAL_FREQUENCY][grows & believed])
    assert f"; about {100.0 * share.max():.2g} % more of critical damping would stop all." in told
    radial, axial = np.square(modes.at(15e-3))  # where the contact is
    first_of = {number: n for n, number in reversed([*enumerate(standing_modes(modes).tolist())])}
    at = [first_of[number] for number in constant[schema.SQUEAL_SHAPE].tolist()]
    assert constant[schema.AXIAL_SHARE] == pytest.approx((axial / (radial + axial))[at], rel=1e-12)
    assert constant[schema.SQUEAL_GROWTH] == growth[grows & believed].max()
    assert constant[schema.LARGEST_GROWTH] > constant[schema.SQUEAL_GROWTH]
    aside = told.partition("Not counted: ")[2]
    assert aside.startswith("axial n = 1 at 9")
    assert ", axial n = 0 at " in aside
    assert "of which the axle decides, here rigid" in aside
    of_axle = dict(constant)
    of_axle[schema.GROWTH_RATE] = np.where(believed, -1.0, growth)
    assert answer(of_axle).startswith("Squeal: no, all ")
    assert "Not counted: axial n = 1 at " in answer(of_axle)
    before = {entry: each for entry, each in constant.items() if entry != schema.SQUEAL_SHAPE}
    for factor, word in ((1.01, "yes"), (0.99, "on the edge, too near to be decided")):  # 0.02 % decides
        scaled = growth * np.where(growth > 0.0, factor * 2e-4 / share.max(), 1.0)
        assert answer(constant | {schema.GROWTH_RATE: scaled}).startswith(
            f"Squeal: {word}, {len(shapes)} of "
        )
    assert f"Squeal: yes, {np.sum(grows & believed)} of " in answer(before)  # of a result from before
    assert "by falling friction (linear" in answer(falling)
    assert "would stop all." in answer(falling)


def test_the_page_says_whether_it_squeals_and_shows_where_it_slips(computed, falling, monkeypatch):
    monkeypatch.setattr("asperity.scenes.result.compute", lambda *_: computed)
    result = computed_result(prepare(computed.case), lambda *_: None, [], brief=True)
    told, fastest = creep_answers(result).more, np.nanargmax(falling[schema.GROWTH_RATE])
    assert f" axial n = {falling[schema.SQUEAL_DIAMETERS][fastest]} at " in told.partition("Squeal: yes, ")[2]
    assert all(figure.drawn(result).caption for figure in CREEP)
    rows = [[cell.text for cell in row] for row in friction_table(result).rows]
    assert [row[0] for row in rows] == ["smooth", "sample 1", "sample 2", "in time, linear"]
    assert rows[3][1:3] == ["–", "100.0"]
    of_study = kept(result)
    assert of_study["squeal_growth_rate"] == falling[schema.SQUEAL_GROWTH]
    assert of_study["mean_friction_power"] == falling[schema.MEAN_FRICTION_POWER]
    rigid = replace(computed, scene=replace(computed.scene, modes=None))
    assert "Whether it squeals is not known" in answer(creep_group(rigid))


@pytest.mark.parametrize("kind", ["ball-on-beam", "bodies"])
def test_whatever_rolls_creeps_and_does_not_squeal(kind):
    """Full slip: µ F against the creepage and µ F V ξ of heat, at every moment and contact; SI from here."""
    keys = ({"ball-on-beam": BALL, "bodies": BODIES}[kind]) | {"laws": ["linear"], "duration": "5 ms"}
    contact = keys["contact"] | {"friction": 0.05}
    result = asperity.run(keys | {"contact": contact, "creep": {"longitudinal": 0.03}})
    rolled = result["rolling"]
    force = rolled["contact_force"].values
    assert rolled["way"].values.tolist() == ["along", "across"]
    np.testing.assert_allclose(rolled["friction_force"].sel(way="along"), -0.05 * force, rtol=2e-3)
    np.testing.assert_allclose(rolled["friction_force"].sel(way="across"), 0.0, atol=1e-6 * force.max())
    np.testing.assert_allclose(rolled["friction_power"], 0.05 * force * 1.0 * 0.03, rtol=3e-3)
    assert rolled["full_slip_share"].values.tolist() == [1.0]
    assert creep_answers(result) is None
    assert all(figure.drawn(result).caption for figure in CREEP[:2])
    assert friction_table(result).rows[0][0].text == "smooth"
    assert "Kalker" in str(result.attrs["citations"])


def test_friction_of_a_case_is_a_key_of_its_contact_and_still_read_by_its_old_name():
    with pytest.warns(FutureWarning, match=r"\[sideways\] friction is now contact\.friction: write that\."):
        old = WheelOnRail(**KEYS | {"sideways": {"friction": 0.2, "contact_place": "5 mm"}})
    new = WheelOnRail(**KEYS | {"sideways": {"contact_place": "5 mm"}}).with_(**{"contact.friction": 0.2})
    assert old == new
    with pytest.raises(CaseError, match=r"\[sideways\] friction: received with contact\.friction"):
        new.with_(**{"sideways.friction": 0.3})


def test_spin_moves_the_rim_of_a_contact_no_faster_than_creepages_may():
    """A tenth over the larger semi-axis: of a wheel some 15 rad/m, of a ball hundreds."""
    most = {"wheel": (WheelOnRail, KEYS), "ball": (BallOnBeam, {"surface": {"rms": "1 um"}})}
    for kind, keys in most.values():
        case = kind(**keys)
        smooth = case.smooth_contact
        rim = 0.1 / max(smooth.semi_axes(smooth.approach(case.rolling.contact_load)))
        kind(**keys | {"creep": {"spin": 0.99 * rim}})
        with pytest.raises(CaseError, match=r"a creepage of 0\.1 at the contact.s rim"):
            kind(**keys | {"creep": {"spin": 1.01 * rim}})


def test_a_depth_of_wear_is_over_the_width_across():
    """3 W of each of two contacts at 2 m/s and 1 mm³/J take 3e-3 mm², over a width of 4 mm."""
    case = SimpleNamespace(creep=SimpleNamespace(wear=1e-9), speed=2.0)
    of = SimpleNamespace(case=case, shape=SimpleNamespace(semi_axes=(1e-3, 2e-3)))
    (area, depth) = _wear(of, np.full((1, 2, 5), 3.0)).values()
    assert [area[0], depth[0]] == pytest.approx([3e-9, 0.75e-6])


def test_what_creeps_wears_as_the_cells_of_its_contact_do():
    """Volume over work times heat over speed; cell by cell by the slip of each, in partial slip as well."""
    rate = 7e-13  # m³/J, 5.5 µg of steel
    for creepage, contacts in ((0.0005, 1), (0.03, 2)):
        keys = {1: BALL, 2: BODIES}[contacts] | {"laws": ["linear"], "duration": "5 ms"}
        creep = {"longitudinal": creepage, "wear": "7e-4 mm^3/J"}
        result = asperity.run(keys | {"creep": creep})
        case = asperity.read_case(keys | {"creep": creep})
        prepared = prepare(case)
        rolling, smooth = smooth_with_friction(prepared, friction_of(case))
        found = rolling.roll(smooth, (creepage, 0.0), speed=case.speed)
        law = EnergyWear(mild=rate * 7850.0, plateau=math.inf, onset=math.inf, density=7850.0)
        section = contacts * wear_depth(rolling, found, law).sum() * rolling.half_space.spacing[1]
        worn = result["rolling/worn_area"]
        assert float(worn[0]) == pytest.approx(section, rel=0.02)  # the force varies
        width = 2.0 * prepared.shape.semi_axes[1]
        assert float(result["rolling/wear_depth"][0]) == pytest.approx(section / width, rel=0.02)
        assert kept(result)["wear_depth"] == result["rolling/wear_depth"].values
        (*_, row) = friction_table(result).rows
        assert row[-1].text.endswith("m")
