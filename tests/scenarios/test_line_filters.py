"""Line filters and datum of a case: what is stored, which law uses which, and what is warned of."""

import json

import numpy as np
import pytest

from asperity import HeightMap
from asperity.case.cases import as_case
from asperity.contact.scan import first_touch
from asperity.laws.layout import force
from asperity.running import prepare_case
from asperity.scenarios.reducing import patch_planes
from asperity.scenes.compute import compute
from asperity.scenes.report import figures_of

pytestmark = [
    pytest.mark.usefixtures("cache_of_module"),
    pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning"),
]

BALL = {
    "kind": "ball-on-beam",
    "laws": ["shifted", "printed", "shifted-unfiltered", "printed-unfiltered", "hertz-filtered", "linear"],
    "start": "0.45 m",
    "duration": "10 ms",
    "surface": {"rms": "0.04 um", "longest": "0.36 mm", "shortest": "60 um"},
    "contact": {"spacing": "20 um", "window": "0.66 mm", "samples": 2, "sample_length": "3 mm"},
    "ball": {"load": "30 N"},
    "numerics": {"highest_frequency": "2 kHz"},
}


def case_of(base=BALL, **keys):
    return as_case(base | {k: base[k] | v if isinstance(v, dict) else v for k, v in keys.items()})


def computed(case):
    return compute(prepare_case(case), lambda done, total, message: None)


def at_load(tree):
    """The state nearest the working load."""
    contact = tree["contact"]
    return int(np.argmin(np.abs(contact["approach"].values - contact.attrs["working_approach"])))


def warned_of_filters(tree):
    found = json.loads(tree.attrs["warnings"])
    return [w["message"] for w in found if w["category"] == "ContactFilterWarning"]


def caption(tree):
    return next(part for part in figures_of(tree) if part.name == "contact_force").caption


@pytest.fixture
def tree(runs):
    return runs(case_of())


@pytest.fixture(scope="module")
def chain():
    return computed(case_of())


# --- what is stored


@pytest.mark.parametrize("name", ["filter", "printed_filter"])
def test_what_is_applied_is_what_was_fitted(tree, name):
    with np.errstate(divide="ignore"):
        fitted, applied = 20 * np.log10(
            [tree[f"contact/{each}"].values for each in (name, f"{name}_applied")]
        )
    counted = (fitted > -30.0) & (tree["contact/filter_excited"].values > 0)
    assert counted.sum() > 50
    assert np.abs(applied - fitted)[counted].max() < 0.3


def test_printed_filter_and_signed_estimate_start_at_one_and_the_other_below(tree):
    """The patch averages what varies across: only the tangent normalisation says so."""
    contact = tree["contact"].to_dataset().isel(approach=at_load(tree))
    ratio = float(contact["filter_scale"])
    assert 0.3 < ratio < 0.9
    assert float(contact["printed_filter"][0]) == pytest.approx(1.0, abs=0.15)
    assert float(contact["filter"][0]) == pytest.approx(ratio, rel=0.35)
    assert contact["filter"].attrs["normalise"] == "tangent"
    np.testing.assert_allclose(contact["filter_signed"][:2], contact["filter_theory"][:2], atol=0.12)
    assert contact["filter_coherence"][:2].min() > 0.9


SMOOTH = {"kind": "ball-on-beam", "duration": "5 ms", "surface": {"spectrum": "iso3095"}}


def test_filter_of_smooth_bodies_is_applied_at_the_working_load(runs, tree):
    smooth = runs(SMOOTH | {"laws": ["hertz-filtered"]})
    contact = smooth["contact"]
    applied = contact["filter_applied"].values
    (row,) = np.flatnonzero(np.isfinite(applied).all(axis=1))
    assert float(contact["approach"][row]) == pytest.approx(contact.attrs["working_approach"])
    np.testing.assert_allclose(applied[row], contact["filter"].values[row], atol=0.02)
    # states of rough bodies count from a plane
    assert "plane that the nominal patch feels" in tree["contact/approach"].attrs["long_name"]
    assert "plane that the nominal patch feels" in caption(tree)
    assert "patch" not in caption(runs(SMOOTH | {"laws": ["hertz"]}))


def test_filters_are_within_0_3_db_of_those_of_exact_contacts(chain):
    """Short waves are small parts of a force: scanned as loosely as a force, filters would be off by 2 dB."""
    exact = computed(case_of(laws=["shifted"], numerics={"force_accuracy": 1e-6}))
    found, wanted = (each.reduction.filters["tangent"].contact_filter for each in (chain, exact))
    counted = (20 * np.log10(wanted.raw) > -30.0) & wanted.excited
    assert counted.sum() > 50
    assert np.abs(20 * np.log10(found.raw / wanted.raw))[counted].max() < 0.3


# --- which law uses which


def test_laws_are_normalised_as_they_are_meant(chain):
    filters, line = chain.reduction.filters, -chain.textures.line
    assert set(filters) == {"tangent", "low-wavenumber"}
    laws = {"shifted": "tangent", "hertz-filtered": "tangent", "printed": "low-wavenumber"}
    for law, normalise in laws.items():
        found, texture = filters[normalise], chain.build(law).texture
        padded = np.pad(line, found.taps.shape[1] // 2, mode="reflect")
        expected = [np.convolve(padded, taps, mode="valid") for taps in found.taps]
        np.testing.assert_allclose(texture.heights, expected, atol=1e-15)
    for law in ("shifted-unfiltered", "printed-unfiltered"):
        np.testing.assert_array_equal(chain.build(law).texture.heights, line[None])


def test_a_normalisation_that_is_asked_for_serves_all_laws(runs):
    given = computed(case_of(laws=["shifted", "printed"], contact={"normalise": "low-wavenumber"}))
    assert set(given.reduction.filters) == {"low-wavenumber"}
    assert np.array_equal(*(given.build(law).texture.heights for law in ("shifted", "printed")))
    unused = runs(case_of(laws=["areal", "linear"]))["contact"]
    assert "filter" in unused
    assert "printed_filter" not in unused


def test_on_a_wavy_path_filters_are_read_at_the_state_of_the_contact():
    """Waves move it by several approaches: under the load it is the same state everywhere."""
    wavy = {"rms": "2.5 um", "longest": "8 mm"}
    found = computed(case_of(laws=["shifted", "hertz-filtered", "printed"], surface=wavy))
    load, positions = found.shape.load, found.runs["shifted"].positions[0]
    laws = {name: found.build(name) for name in found.runs}
    approach = found.reduction.pressed.approach
    held_at = float(found.reduction.ensemble.curve.inverse(load))
    followed = laws["shifted"].texture.held_at(held_at).at(positions)[:, 0]
    assert np.ptp(followed) > 2.0 * approach
    np.testing.assert_allclose(force(laws["shifted"], positions, held_at + followed), load, rtol=1e-9)
    np.testing.assert_allclose(laws["hertz-filtered"].prepare(positions).planes, followed, atol=1e-15)
    # smooth bodies carry the load at another approach, but between the same two states
    smooth = found.shape.hertz.approach(load)
    assert smooth > held_at + 0.1 * approach
    pressed = force(laws["hertz-filtered"], positions, smooth + followed)
    np.testing.assert_allclose(pressed, load, rtol=2e-3)
    assert not laws["printed"].prepare(positions).planes.any()


# --- what is warned of


def test_printed_asymptote_without_long_waves_is_warned_of(runs, tree):
    (message,) = warned_of_filters(tree)
    contact = tree["contact"].to_dataset().dropna("approach", subset=["filter_scale"])
    ratio = np.interp(contact.attrs["working_approach"], contact["approach"], contact["filter_scale"])
    assert f"the filter of the law printed is set to one: k_0/k_t = {ratio:.2f} under" in message
    assert f"its force keeps {-20 * np.log10(ratio):.1f} dB" in message
    assert 'Set contact.normalise = "tangent"' in message
    assert not warned_of_filters(runs(case_of(laws=["shifted", "printed-unfiltered"])))  # no law uses it
    long = {"contact": {"sample_length": "10 mm", "samples": 1}, "surface": {"longest": "4 mm"}}
    assert not warned_of_filters(runs(case_of(laws=["printed"], **long)))


def test_the_filter_of_the_thesis_by_its_keys_and_its_few_taps_are_warned_of(runs):
    """A polynomial over the wavenumber and a short filter by window; both shown, the latter warned of."""
    keys = {"filter_degree": 6, "filter_taps": 34, "samples": 1}
    found = runs(case_of(laws=["printed"], contact=keys))
    contact = found["contact"].to_dataset()
    taps = json.loads(found["scenario"].attrs["numerics"])
    assert {"name": "filter order J", "value": "34"} in taps
    row = np.flatnonzero(np.isfinite(contact["printed_filter"].values[:, 0]))[-1]
    fitted = 20 * np.log10(contact["printed_filter"].values[row])
    within = (fitted < -0.01) & (fitted > -59.0) & (contact["filter_excited"].values > 0)
    k = contact["wavenumber"].values[within]
    residual = fitted[within] - np.polyval(np.polyfit(k, fitted[within], 6), k)
    assert np.abs(residual).max() < 1e-6
    (message,) = (each for each in warned_of_filters(found) if "misses" in each)
    assert message.startswith("the filter of the law printed with J = 34 misses the fitted one by ")
    assert "Leave out contact.filter_taps" in message


# --- the datum


def measured(**contact):
    k = np.hypot(*np.meshgrid(np.fft.fftfreq(300, 20e-6), np.fft.rfftfreq(60, 20e-6), indexing="ij"))
    shape = np.where(k > 0, np.maximum(k, 2.5e3) ** -1.8, 0.0)
    white = np.random.default_rng(2).standard_normal((300, 60))
    z = np.fft.irfft2(np.fft.rfft2(white) * shape, s=(300, 60))
    surface = {"file": HeightMap(0.06e-6 * z / z.std(), 20e-6)}
    return case_of(BALL | {"surface": surface}, laws=["printed"], contact=contact)


def test_the_datum_is_of_the_samples_alone_or_by_its_key_of_samples_and_path():
    """It did grow with the strips for the filters, and with the path, though the samples stayed."""
    short, path = (
        computed(measured(sample_length=length, datum=datum)).reduction
        for length, datum in (("1.4 mm", "samples"), ("5 mm", "path"))
    )
    assert short.ensemble.datum == short.datums["samples"] == path.datums["samples"]
    assert path.ensemble.datum == path.datums["path"] > 1.02 * path.datums["samples"]


def test_of_samples_and_path_it_is_the_first_touch_of_the_path(chain):
    """No point of the path is touched below the state zero, though the strips would be touched later."""
    body, path = chain.shape.body, chain.textures.path
    windows = np.lib.stride_tricks.sliding_window_view(path.rows(0, path.shape[0]), body.shape)[:, 0]
    touches = np.array([(body - window).min() for window in windows])
    touches += patch_planes(path, chain.shape)[body.shape[0] // 2 :][: len(touches)]
    assert -touches.min() == pytest.approx(chain.reduction.datums["path"], rel=1e-9)
    assert touches.min() < min(first_touch(strip.heights, body).min() for strip in chain.textures.strips)
    # the force vanishes at the state zero for every sample
    ensemble = chain.reduction.ensemble
    assert ensemble.datum == chain.reduction.datums["samples"]
    assert not ensemble.forces[:, ensemble.states <= 0.0].any()


def test_where_no_law_filters_a_line_every_third_state_has_the_filter_of_all(tree, runs):
    whole, few = (each["contact"]["filter"].values for each in (tree, runs(case_of(laws=["hertz"]))))
    there = np.isfinite(few).all(axis=1)
    states = np.flatnonzero(np.isfinite(whole).all(axis=1))
    assert np.array_equal(np.diff(np.flatnonzero(there)), np.full(there.sum() - 1, 3))
    assert there.sum() in (len(states) // 3, len(states) // 3 + 1)
    passed = whole[there] > 0.1
    off = 20.0 * np.log10(few[there][passed] / whole[there][passed])
    assert np.abs(off).max() < 0.02
