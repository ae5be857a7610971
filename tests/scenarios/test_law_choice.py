"""The map of law errors: where a case lies on it, what it expects there, and what it says off it."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from asperity import HeightMap, Profile, WheelOnRail
from asperity.case.cases import as_case
from asperity.reference.law_accuracy import Place, law_map, mapped_points
from asperity.running import prepare_case
from asperity.scenarios import law_choice
from asperity.scenarios.geometry import geometry_of
from asperity.scenarios.law_choice import ExpectedError, LawChoice, choose, expected_error, place_of
from asperity.scenarios.preparing import Work
from asperity.scenarios.scene import scene_of
from asperity.scenes.planning import plan
from asperity.scenes.validity import doubted_by_area

ROOT = Path(__file__).parents[2]
BALL = {
    "kind": "ball-on-beam",
    "laws": ["areal"],
    "start": "0.45 m",
    "duration": "20 ms",
    "settling": "5 ms",
    "surface": {"rms": "0.6 um", "longest": "0.4 mm", "shortest": "0.1 mm"},
    "ball": {"load": "30 N"},
    "contact": {"spacing": "20 um", "window": "0.9 mm", "samples": 1, "sample_length": "4 mm"},
}
MAP = law_map()
NO_WORK = Work({}, {}, 0, None)


@pytest.fixture(scope="module")
def shape():
    return geometry_of(as_case(BALL))


def wave(shape, length, amplitude=1e-8, rows=4000):
    """A wave along the path, the same all across."""
    line = amplitude * np.sin(2.0 * np.pi * shape.spacing[0] * np.arange(rows) / length)
    return HeightMap(np.repeat(line[:, None], shape.body.shape[1], axis=1), shape.spacing)


def transfer_of(stiffness, frequency):
    return np.full(frequency.shape, 1e14)  # (N/m)^2


@pytest.mark.parametrize("waves_per_patch", [0.2, 0.7])
def test_a_wave_has_the_place_of_the_closed_form(shape, waves_per_patch):
    """Of a sine, the flat punch feels sin q/q; its correlation is a cosine."""
    a, load = shape.semi_axes[0], shape.load
    length, approach = 2.0 * a / waves_per_patch, shape.hertz.approach(load)
    place = place_of(wave(shape, length), shape, 1.0, transfer_of)
    q = 2.0 * np.pi * a / length
    rms, felt = 1e-8 / math.sqrt(2.0), math.sin(q) / q
    assert place.roughness == pytest.approx(rms / approach, rel=0.02)
    assert place.within == pytest.approx(rms * (1.0 - felt) / approach, rel=0.04)
    assert place.dynamic == pytest.approx(rms * felt * 1e7 / load, rel=0.04)
    # at 1 m/s the highest band, 5 kHz, has waves of 0.2 mm
    assert place.highest_wavenumber == pytest.approx(2.0 * np.pi * a / 0.2e-3)
    # the lag at which a cosine falls to 0.2; grid points are joined by lines
    assert place.correlation == pytest.approx(math.acos(0.2) / (2.0 * np.pi) / waves_per_patch, rel=0.03)
    # the same all across: as far as the window shows
    assert place.across == pytest.approx(shape.body.shape[1] // 2 * shape.spacing[1] / (2.0 * a))


def test_waves_that_excite_less_than_100_hz_have_no_place(shape):
    fast, slow = wave(shape, 5e-3), wave(shape, 20e-3, amplitude=1e-6)
    both = HeightMap(fast.heights + slow.heights, shape.spacing)
    alone = place_of(fast, shape, 1.0, transfer_of)
    assert place_of(both, shape, 1.0, transfer_of).roughness == pytest.approx(alone.roughness, rel=0.1)
    # at 4 m/s the slow one is heard
    assert place_of(both, shape, 4.0, transfer_of).roughness > 50.0 * alone.roughness
    assert place_of(wave(shape, 1.0, 0.0), shape, 1.0, transfer_of) is None


def test_correlation_lengths_are_those_of_direct_sums():
    """Lags at which mean products of all pairs fall to 0.2, joined by lines."""
    line = np.cos(np.arange(60.0) / 9.0)
    products = np.correlate(line, line, "full")[59:] / (60 - np.arange(60)) / np.mean(line**2)
    below = int(np.argmax(products <= 0.2))
    lag = np.interp(0.2, products[[below, below - 1]], [below, below - 1])
    found = law_choice.correlation_lengths(np.add.outer(0.0 * line, line), (2e-3, 3e-3))
    assert found[1] == pytest.approx(3e-3 * lag, rel=1e-12)
    turned = law_choice.correlation_lengths(np.add.outer(line, 0.0 * line), (2e-3, 3e-3))
    assert turned[0] == pytest.approx(2e-3 * lag, rel=1e-12)


def test_the_linear_force_is_that_of_a_mass_on_a_spring_on_a_stiff_beam():
    """A beam as stiff as a block leaves F/z = 1/(1/k - 1/(m w²))."""
    block = {"width": "2 m", "height": "60 mm", "length": "0.5 m"}
    case = BALL | {"start": "0.2 m", "ball": {"mass": "2 kg"}, "beam": block}
    frequency = np.array([60.0, 200.0, 20e3])
    k, w = 1e6, 2.0 * np.pi * frequency
    found = scene_of(as_case(case | {"numerics": {"highest_frequency": 20e3}})).square_transfer(k, frequency)
    np.testing.assert_allclose(found, np.abs(1.0 / (1.0 / k - 1.0 / (2.0 * w**2))) ** 2, rtol=0.05)


def test_a_mapped_point_expects_what_was_found_there():
    for point in MAP.points[::5]:
        choice = choose(MAP, point.kind, point.place, ["shifted", "hertz", "no-such-law"])
        assert set(choice.expected) == {"table", "areal", "shifted", "hertz"}
        assert (choice.distance, choice.nearest) == (0.0, point)
        assert not choice.off_map
        shifted = choice.expected["shifted"]
        assert 1.0 < shifted.high / shifted.error == pytest.approx(shifted.error / shifted.low)


def test_scenes_of_two_kinds_are_as_far_apart_as_is_said():
    """At the same place: by one coordinate for each kind on the map."""
    kinds, place = {point.kind for point in MAP.points}, MAP.points[0].place
    rail, beam = (law_choice._coordinates(MAP, kind, place) for kind in sorted(kinds))
    assert np.linalg.norm(rail - beam) == pytest.approx(law_choice.OTHER_KIND, rel=1e-12)


def bands(points, least=0.0):
    """By law, at some points: whether its error is in the expected band, and by how much it is off."""
    found = {law: [] for law in MAP.spread}
    for point in points:
        for law, error in point.errors.items():
            band, error = expected_error(MAP, point.kind, point.place, law), max(error, least)
            found[law].append((band.low <= error <= band.high, math.log(band.error / error)))
    return {law: np.array(each) for law, each in found.items()}


def test_the_band_holds_what_was_found_as_often_as_it_claims():
    """At points of the map more often than aside of them: chance alone is smoothed out there, evenly.

    Fresh cases have seeds, textures, loads, speeds and lays of their own, and are no points of the map.
    """
    for held, off in (found.mean(axis=0) for found in bands(MAP.points, 0.1).values()):
        assert held > 0.8
        assert 0.9 < np.exp(off) < 1.1
    fresh = mapped_points(json.loads((ROOT / "benchmarks/law_accuracy_fresh.json").read_text()))
    assert len(fresh) >= 60
    for kind, slow, fast in (("ball-on-beam", 0.4, 2.5), ("wheel-on-rail", 25.0, 75.0)):
        speeds = [case.speed for case in fresh if case.kind == kind]
        assert min(speeds) < slow < fast < max(speeds)
    aside = bands(fresh)
    assert min(found[:, 0].mean() for found in aside.values()) >= 0.7
    assert 0.73 <= np.concatenate(list(aside.values()))[:, 0].mean() <= 0.87


def test_off_the_map_it_says_so():
    far = Place(300.0, 1.0, 1.0, 100.0, 500.0, 3.5)
    choice, on_map = (choose(MAP, "wheel-on-rail", at, ["areal"]) for at in (far, MAP.points[0].place))
    areal, near = (each.expected["areal"] for each in (choice, on_map))
    assert areal.high / areal.low > 1.5 * near.high / near.low
    assert choice.off_map
    assert dict(choice.rows())["place on the map"].endswith("so that the expected errors are guesses")
    assert dict(choice.rows())["expected errors, dB"].startswith("guesses: ")
    assert choice.sentence("areal").startswith("A guess, off the map")
    assert choice.sentence("own-law") is None


@pytest.mark.parametrize("kind", ["ball-on-beam", "wheel-on-rail"])
@pytest.mark.parametrize(("end", "ratio"), [(-1, 10.0), (0, 0.1)])
def test_a_speed_that_was_not_mapped_is_off_the_map(kind, end, ratio):
    """Ten times slower, or faster, than any point of these bodies, and else the same as one."""
    mine = sorted((p.place.highest_wavenumber, n) for n, p in enumerate(MAP.points) if p.kind == kind)
    wavenumber, number = mine[end]
    place = MAP.points[number].place
    assert not choose(MAP, kind, place, ["areal"]).off_map
    other = choose(MAP, kind, replace(place, highest_wavenumber=ratio * wavenumber), ["areal"])
    assert (other.off_map, other.taken) == (True, "table")
    assert "not known here" in dict(other.rows())["law to take"]


def test_areal_is_taken_where_it_is_in_its_range_and_table_where_it_leaves_it():
    smooth, rough = (
        choose(MAP, "wheel-on-rail", place, ["areal"])
        for place in (Place(0.1, 1.0, 1.0, 0.03, 0.1, 3.5), Place(1.0, 0.3, 0.3, 0.9, 2.0, 3.5))
    )
    assert (smooth.taken, rough.taken) == ("areal", "table")
    assert "expected within 1 dB of direct" in dict(smooth.rows())["law to take"]
    assert "table: areal leaves its range" in dict(rough.rows())["law to take"]
    assert rough.sentence("areal").endswith("; take table")


def test_check_and_verdict_say_what_the_map_says(runs):
    ready = prepare_case(as_case(BALL))
    rows = dict(plan(ready, NO_WORK, law_choice.law_choice(ready)))
    assert rows["law to take"].startswith("table: areal leaves its range")
    assert re.search(r"areal \d+(\.\d)? \(\d+(\.\d)? to \d+(\.\d)?\)", rows["expected errors, dB"])
    result = runs(BALL)
    assert "areal is" in result.attrs["verdict"]
    assert "; take table" in result.attrs["verdict"]
    entries = json.loads(result["scenario"].attrs["numerics"])
    assert {"name": "law to take", "value": rows["law to take"]} in entries


@pytest.mark.parametrize(("high", "doubted"), [(0.9, ()), (1.4, ("areal", "linear"))])
def test_real_contact_and_the_map_advise_the_same(high, doubted):
    """A small real contact makes no law doubtful that the map trusts; what to take is what the map takes."""
    point = MAP.points[0]
    expected = {law: ExpectedError(law, 0.6, 0.4, high) for law in ("areal", "table")}
    choice = replace(choose(MAP, point.kind, point.place, ["areal"]), expected=expected)
    for ratio in (0.6, 0.85):
        assert doubted_by_area(("areal", "linear"), ratio, choice) == doubted
        assert doubted_by_area(("linear", "areal"), ratio, choice) == ("linear", *doubted[:1])
        assert doubted_by_area(("areal", "table"), ratio, None) == ("areal",)
    assert doubted_by_area(("areal", "linear"), 0.95, None) == ()
    assert choice.taken == ("table" if doubted else "areal")


RAIL = {"kind": "wheel-on-rail", "duration": "0.1 s", "wheel": {"section": "rigid"}}


@pytest.mark.parametrize(
    "case",
    [
        BALL | {"laws": ["hertz"], "surface": {"line": Profile(1e-8 * np.sin(np.arange(3000.0)), 2e-5)}},
        RAIL | {"settling": "0.05 s", "surface": {"smooth": True}},
        RAIL | {"surface": {"joint_depth": "1 mm"}},
    ],
)
def test_why_nothing_is_said_is_said_where_the_map_knows_nothing(case):
    """Of lines, and of defects, where the law to take is the default; what is smooth has none to take."""
    prepared = prepare_case(as_case(case))
    assert law_choice.law_choice(prepared) is None
    told, smooth = dict(plan(prepared, NO_WORK)), "smooth" in case["surface"]
    assert ("law to take" in told) == (not smooth)
    if not smooth:
        assert told["law to take"].startswith("not told by the map of law errors: it holds")
    assert law_choice.UNMAPPED == WheelOnRail(surface={"joint_depth": "1 mm"}).laws[0] == "direct"


@pytest.mark.parametrize(("wavenumber", "off"), [(0.9, True), (1.0, False), (3.0, False), (3.1, True)])
def test_waves_longer_and_shorter_than_any_on_the_map_are_off_it(wavenumber, off):
    place = Place(0.1, 1.0, 1.0, 0.1, 0.1, highest_wavenumber=wavenumber)
    assert LawChoice(place, {}, 0.0, law_map().points[0], (1.0, 3.0)).off_map == off
