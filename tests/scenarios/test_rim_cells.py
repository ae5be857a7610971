"""Cells at the rim of a case's contact: what `contact.rim_cells` reaches, and when a case needs it."""

import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray

from asperity.errors import Grade, InputError
from asperity.fitting import running as fitting
from asperity.laws import spec_of
from asperity.optimising import running as optimising
from asperity.optimising.definition import Aim
from asperity.running import prepare_case, with_choices_fixed
from asperity.scenarios import problems, reducing, rim_cells
from asperity.scenarios.laws import ReducedCase, reduced_case
from asperity.scenarios.preparing import Work, scans_of
from asperity.scenarios.reducing import samples_of
from asperity.scenarios.refining import on_the_surface_of, settings_for
from asperity.scenarios.textures import textures_under
from asperity.scenes.planning import plan
from asperity.scenes.validity import _whole_cells
from asperity.studies.table import _of_cells
from asperity.surfaces.cell_means import PressedStrip, cell_means, pressed_heights
from asperity.surfaces.strip import Rows
from small_cases import changed


def prepared(kind="ball-on-beam", cells="covered", **keys):
    contact = keys.pop("contact", {}) | {"rim_cells": cells}
    return prepare_case(changed(kind, contact=contact, **keys))


def whole(strip):
    return strip.rows(0, strip.shape[0])


def test_means_over_cells_are_those_of_waves_and_of_a_paraboloid():
    """Of a wave of n cells sin q/q with q = π/n is left on either axis; differences miss q⁴/15 of both."""
    n, m = np.mgrid[:40, :40]
    for cells in (8, 16):
        wave, q = np.cos(2 * np.pi * n / cells) * np.cos(2 * np.pi * m / cells), np.pi / cells
        left = cell_means(wave)[1:-1, 1:-1] / (np.sin(q) / q) ** 2
        np.testing.assert_allclose(left, wave[1:-1, 1:-1], atol=1.1 * q**4 / 15)
    np.testing.assert_allclose(
        (cell_means(1.0 * (n**2 + 3 * m**2)) - n**2 - 3 * m**2)[1:-1, 1:-1], 4 / 12, atol=1e-12
    )


def test_pieces_of_a_texture_on_covered_cells_are_those_of_the_whole_and_made_once(monkeypatch):
    monkeypatch.setattr("asperity.surfaces.cell_means.PIECE", 8)
    heights = np.random.default_rng(1).standard_normal((30, 7))
    strip = PressedStrip(Rows(heights))
    read: list[int] = []
    monkeypatch.setattr(Rows, "rows", lambda of, first, stop: read.append(first) or of.heights[first:stop])
    for first, stop in ((0, 30), (0, 4), (11, 12), (25, 30), (30, 30)):
        np.testing.assert_array_equal(strip.rows(first, stop), pressed_heights(heights)[first:stop])
    assert sorted(read) == [0, 6, 14, 22]


WAVES = [(0.0, 4.0), (0.4, 3.0), (0.7, 6.0), (1.2, 20.0), (np.pi / 4, 2**0.5)]
"""Angle to the grid, and length in cells."""


@pytest.mark.parametrize(("angle", "cells"), WAVES)
def test_waves_are_pressed_as_means_the_longer_they_are(angle, cells):
    """Of a wave of second differences −D times itself 1 − D/24 (1 − D/8) is left; of its mean 1 − D/24."""
    n, m = np.mgrid[:40, :40]
    along, across = (2.0 * np.pi / cells * each for each in (np.cos(angle), np.sin(angle)))
    wave, size = np.cos(along * n + across * m), 4.0 - 2.0 * np.cos(along) - 2.0 * np.cos(across)
    inside, share = (slice(2, -2), slice(2, -2)), 1.0 - size / 24.0 * (1.0 - size / 8.0)
    np.testing.assert_allclose(pressed_heights(wave)[inside], (share * wave)[inside], atol=1e-14)
    np.testing.assert_allclose(cell_means(wave)[inside], ((1.0 - size / 24.0) * wave)[inside], atol=1e-14)
    assert share == pytest.approx(1.0) if size > 7.99 else share < 1.0


def test_covered_cells_of_a_case_press_their_heights_by_every_law_that_solves_the_contact():
    point, mean = prepared(cells="whole"), prepared()
    raised = mean.shape.body - point.shape.body
    radius, (spacing, _) = point.case.ball.radius, point.shape.spacing
    np.testing.assert_allclose(raised[1:-1, 1:-1], spacing**2 / (12.0 * radius), rtol=1e-6)
    for one, other in zip(point.textures.maps, mean.textures.maps, strict=True):
        np.testing.assert_array_equal(other.heights, pressed_heights(one.heights))
    assert [s.heights.tolist() for s in mean.textures.strips] == [
        m.heights.tolist() for m in mean.textures.maps
    ]
    np.testing.assert_array_equal(whole(mean.textures.path), pressed_heights(whole(point.textures.path)))
    np.testing.assert_array_equal(mean.textures.line, point.textures.line)
    for each, cells in ((point, "whole"), (mean, "covered")):
        assert each.shape.half_space(1e9).cells == cells
        law = reduced(each).build("direct")
        np.testing.assert_array_equal(law.heights, whole(each.textures.path))
        assert law.prepare(np.array([each.case.record_start])).half_space.cells == cells


def test_other_wheels_are_pressed_so_too():
    keys = {"kind": "wheel-on-rail", "wheel": {"roughness": "disc", "load": "50 kN"}, "duration": "5 ms"}
    under = []
    for cells in ("whole", "covered"):
        made = prepared(**keys, cells=cells, surface={"spectrum": "iso3095", "lateral": 1.0})
        under.append(textures_under(made.case, 1, made.textures))
    points, means = (whole(textures.path) for textures in under)
    np.testing.assert_array_equal(whole(under[1].averaged.path), points)
    np.testing.assert_allclose(means[2:-2], pressed_heights(points)[2:-2], atol=1e-12 * np.ptp(points))
    assert not np.allclose(means, points, atol=1e-6 * np.ptp(points))


def test_what_is_averaged_under_a_patch_is_no_mean_already(monkeypatch):
    """Else short waves would be lost twice by averaged heights, and won by filters of the line."""
    followed = []

    def found(strips, *rest, lines, **options):
        followed.append([strip.heights for strip in lines])

    monkeypatch.setattr(reducing, "filters_of", found)
    force = np.array([1.0, 30.0])
    states = SimpleNamespace(mean_force=force, approaches=force, curve=SimpleNamespace(stiffness=np.sqrt))
    planes = []
    for cells in ("whole", "covered"):
        made = prepared(cells=cells)
        reducing.line_filters(made, states, lambda *_: None)
        without = replace(made, textures=replace(made.textures, maps=()))
        planes.append(reduced_case(without, lambda *_: None).planes)
    np.testing.assert_array_equal(*planes)
    np.testing.assert_array_equal(*followed)


def test_a_device_takes_whole_cells_alone(monkeypatch):
    monkeypatch.setattr(problems, "find_device", lambda: "a device")
    with pytest.raises(
        InputError, match=r'contact\.rim_cells: received "covered"; allowed: "whole" on the device gpu'
    ):
        prepared()
    prepared(cells="whole")


def chosen(rms, **keys):
    keys = {"laws": ["areal", "direct"], "contact": {"samples": 2}} | keys
    return prepared(cells="auto", surface={"rms": f"{rms} um", "longest": "0.4 mm"}, **keys)


def reduced(made):
    return ReducedCase(**vars(made), reduction=None, planes=None, progress=lambda *_: None)


def test_the_texture_chooses_cells_at_rims_of_laws_that_see_heights():
    """The heights within the patch are a part of the rms, over an approach of 0.89 µm."""
    for rms, cells, side in ((0.02, "covered", "up to"), (0.5, "whole", "more than")):
        made = chosen(rms)
        surface = {"rms": f"{rms} um", "longest": "0.4 mm"}
        given = prepared(cells=cells, surface=surface, laws=["areal", "direct"], contact={"samples": 2})
        assert made.cells_of_heights == given.shape.cells == cells
        assert made.kinds_of_cells == tuple(dict.fromkeys(("whole", cells)))
        assert given.kinds_of_cells == (cells,)
        found, expected = (reduced(each).build("direct") for each in (made, given))
        assert found.cells == cells
        np.testing.assert_array_equal(found.body, expected.body)
        np.testing.assert_array_equal(found.heights, expected.heights)
        within = float(re.match(r"the texture has ([\d.]+) approaches rms", made.rims)[1])
        assert 0.2 < within * made.shape.hertz.approach(made.shape.load) / (1e-6 * rms) < 1.0
        assert made.rims.endswith(f"within the contact, {side} 0.1")
        assert given.rims == ""


def test_a_table_by_choice_scans_what_one_of_covered_cells_does():
    keys = {"surface": {"rms": "0.02 um", "longest": "0.4 mm"}, "laws": ["table"]}
    made, given = (prepared(cells=cells, contact={"samples": 2}, **keys) for cells in ("auto", "covered"))
    jobs = [scans_of(each, np.linspace(0.0, 1e-6, reducing.STATES))["path"][0] for each in (made, given)]
    assert [job.half_space.cells for job in jobs] == ["covered", "covered"]
    for job in jobs:
        np.testing.assert_allclose(np.diff(job.approaches), 1e-6 / (reducing.STATES - 1))  # all, on a beam
    np.testing.assert_array_equal(*(job.body for job in jobs))
    np.testing.assert_array_equal(*(whole(job.surface) for job in jobs))
    found, expected = (
        reduced_case(each, lambda *_: None).scanning._table().touches for each in (made, given)
    )
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-15)  # planes are told to a femtometre


def test_other_laws_keep_whole_cells_whichever_are_run_beside_them():
    beside, alone = chosen(0.02), chosen(0.02, laws=["areal"])
    assert (alone.cells_of_heights, alone.rims, alone.chosen) == (None, "", {})
    assert alone.case.cells_at_rims == ("whole",)
    assert beside.case.cells_at_rims == ("whole", "covered")
    assert beside.shape.cells == alone.shape.cells == "whole"
    np.testing.assert_array_equal(beside.shape.body, alone.shape.body)
    np.testing.assert_array_equal(whole(beside.textures.path), whole(alone.textures.path))
    for one, other in zip(beside.textures.maps, alone.textures.maps, strict=True):
        np.testing.assert_array_equal(one.heights, other.heights)
    assert reduced(beside)._of_law(spec_of("areal")).cells == "whole"
    assert reduced(beside).build("direct").cells == "covered"
    assert changed("ball-on-beam").contact.rim_cells == "auto"


def test_cells_are_whole_on_a_device(monkeypatch):
    monkeypatch.setattr(rim_cells, "find_device", lambda: "a device")
    made = chosen(0.02)
    assert (made.cells_of_heights, made.rims) == ("whole", "the device gpu has no others")


GRID = {"spacing": "1 mm", "sample_length": "0.2 m"}
WHEEL = {"kind": "wheel-on-rail", "duration": "5 ms", "laws": ["direct"], "contact": GRID}
FLAT = {"roughness": None, "flat_length": "40 mm", "flat_position": "50.3 mm"}


@pytest.mark.parametrize(
    "defect", [{"wheel": FLAT}, {"surface": {"joint_depth": "1 mm", "joint_length": "0.1 m"}}]
)
def test_defects_are_covered_likewise_with_mean_heights(defect):
    """Those of points would let an end of a flat touch too early: it is a kink within a cell."""
    keys = {"surface": {"spectrum": "iso3095", "lateral": 1.0} | defect.get("surface", {})}
    keys |= {"wheel": {"load": "50 kN"} | defect.get("wheel", {})}
    made = prepared(**WHEEL, **keys, cells="auto")
    assert made.cells_of_heights == "covered"
    assert made.rims.endswith("within the contact, up to 0.1")
    shape, seen = made.seeing.shape, made.seeing.textures
    defects, (spacing, _) = seen.defects, shape.spacing
    at = seen.rows_along(spacing)
    heights = whole(seen.surface) - whole(seen.path)
    parts = (np.arange(1001) - 500) / 1001 * spacing
    expected = np.mean([defects.heights(at + part) for part in parts], axis=0)
    assert np.ptp(expected - defects.heights(at)) > 5e-7
    np.testing.assert_allclose(heights, np.broadcast_to(expected[:, None], heights.shape), atol=2e-8)
    points = whole(made.textures.surface) - whole(made.textures.path)
    np.testing.assert_allclose(points[:, 0], defects.heights(at), atol=1e-15)


def test_what_was_chosen_is_told_before_the_run():
    rows = dict(plan(chosen(0.02), Work({}, {}, 0, None)))
    assert rows["cells at rims"].startswith("covered for direct: the texture has 0.")
    for other in (prepared(cells="whole"), chosen(0.02, laws=["areal"])):
        assert not any("cells at rims" in row for row in dict(plan(other, Work({}, {}, 0, None))))


def test_a_grid_is_compared_on_heights_of_its_own_cells():
    small = prepared(surface={"rms": "0.02 um", "longest": "0.4 mm"}, contact={"samples": 2})
    finer = settings_for(small, np.linspace(-1e-6, 3e-6, 5))[0].ways[0].changes
    large = prepare_case(small.case.with_(**finer))
    assert large.case.contact.rim_cells == large.shape.cells == "covered"
    found = whole(on_the_surface_of(small, large).textures.path)
    points = whole(large.textures.points.path)
    first, beside = large.textures.before % 2, points.shape[1] // 2 % 2
    expected = pressed_heights(points[first::2, beside::2])
    np.testing.assert_array_equal(found, expected)


def test_a_search_keeps_the_cells_of_the_case_that_it_began_with(monkeypatch):
    """Else levels would jump where a texture that is tried passes the roughness at which cells change."""
    case, begun = chosen(0.02, laws=["direct", "areal"]).case, []

    class Enough(Exception):
        pass

    def begin(of, *rest):
        begun.append(getattr(of, "case", of).contact.rim_cells)
        raise Enough

    monkeypatch.setattr(optimising, "_rolled", begin)
    monkeypatch.setattr(fitting, "_known", begin)
    with pytest.raises(Enough):
        optimising.optimised(case, Aim(rms_at_least="0.02 um", law="table"), lambda *_: None)
    with pytest.raises(Enough):
        fitting.fitted(case, (), (), lambda *_: None)
    assert begun == ["covered", "covered"]
    given = prepared(cells="whole").case
    assert with_choices_fixed(given, given.laws) is given


@pytest.mark.parametrize("laws", [("areal",), ("areal", "direct")])
def test_a_search_by_other_laws_too_leaves_them_on_whole_cells(laws):
    case = chosen(0.02).case
    assert with_choices_fixed(case, laws).contact.rim_cells == "auto"
    assert with_choices_fixed(case, ("direct", "table")).contact.rim_cells == "covered"
    assert with_choices_fixed(chosen(0.02, laws=["areal"]).case, ("table",)).contact.rim_cells == "covered"


def test_a_study_tells_that_its_members_have_unlike_cells():
    of = [
        xarray.Dataset(attrs={"rim_cells": cells})
        for cells in ("covered for direct", "whole", "covered for direct")
    ]
    (told,) = _of_cells([*of, xarray.Dataset()])
    assert told["message"].startswith("cells at rims are covered in 2 members and whole in 1, ")
    assert (told["category"], told["members"]) == ("CoarseSamplingWarning", 3)
    assert not list(_of_cells(of[::2]))


def doubts(rms, cells="whole", laws=("areal", "direct"), **keys):
    """What is doubted of a grid of about nine cells in the half-width of a ball's contact."""
    surface = {"rms": f"{rms} um", "longest": "0.4 mm", "shortest": "60 um"}
    made = prepared(cells=cells, laws=list(laws), surface=surface, contact={"spacing": "15 um"}, **keys)
    samples = samples_of(made.case, made.shape, made.textures.maps, made.shape.class_axes)
    gaps = [SimpleNamespace(undeformed_gap=made.shape.body - sample) for sample in samples]
    return made, list(_whole_cells(made, SimpleNamespace(contacts=gaps)))


def test_whole_cells_under_a_smooth_texture_are_doubted_by_a_number():
    made, (found,) = doubts(0.01)
    assert (found.grade, found.laws) == (Grade.WARNING, ("direct",))
    assert found.concerns("direct")
    missed = rim_cells.stiffness_missed(made.shape)
    level = 20.0 * math.log10(1.0 + missed)
    assert f"up to {100 * missed:.2g} %, about {level:.2g} dB" in found.value
    assert 'Set contact.rim_cells = "covered"' in found.message
    assert doubts(0.01, cells="covered")[1] == doubts(0.01, cells="auto")[1] == []
    assert doubts(0.01, laws=["areal", "shifted"])[1] == []
    assert doubts(1.0)[1] == []  # so rough that many cells enter at once


@pytest.mark.parametrize("laws", [("table",), ("table", "direct")])
def test_a_scan_on_whole_cells_is_doubted_as_contacts_of_each_step_are(laws):
    """Its states take the jumps of the stiffness along: `benchmarks/direct_cells.py --table`."""
    _, (found,) = doubts(0.01, laws=["areal", *laws])
    _, (solved,) = doubts(0.01)
    assert found.quantity == f"error of the stiffness on whole cells, {' and '.join(laws)}"
    assert (found.value, found.meaning, found.laws) == (solved.value, solved.meaning, laws)
    assert found.grade is Grade.WARNING
    assert doubts(0.01, cells="auto", laws=laws)[1] == []


def test_cells_are_counted_in_the_half_width_of_an_ellipse():
    """Six in it miss less than six in a ball, whose rim is all as near, and more than eighteen would."""

    def missed(along, across):
        shape = SimpleNamespace(semi_axes=(along, across), spacing=(1e-3 / 6.0, 1e-3 / 6.0))
        return rim_cells.stiffness_missed(shape)

    assert missed(3e-3, 3e-3) < missed(3e-3, 1e-3) < missed(1e-3, 1e-3)
    assert missed(1e-3, 3e-3) == missed(3e-3, 1e-3)


def test_the_texture_within_the_patch_is_that_about_a_plane():
    """Of s x² + t x about its plane within a circle: x² has the mean a²/4, its square the mean a⁴/8."""
    made = prepared(contact={"spacing": "8 um"})
    (nx, _), (dx, _) = made.shape.body.shape, made.shape.spacing
    a = made.shape.semi_axes[0]
    x = dx * np.arange(-(nx // 2), nx // 2 + 1)[:, None] + 0.0 * made.shape.body
    gap = made.shape.body - (2e-3 * x**2 / a + 0.3 * x)
    expected = 2e-3 * a * math.sqrt(1 / 8 - 1 / 16) / made.shape.hertz.approach(made.shape.load)
    assert rim_cells.roughness_within([made.shape.body - gap], made.shape) == pytest.approx(
        expected, rel=0.05
    )
