"""Line filters and datum of a case: what is stored, which law uses which, and what is warned of."""

import json
import re
import warnings

import numpy as np
import pytest

from asperity.case.cases import parse_case
from asperity.contact.scan import first_touch
from asperity.errors import PhysicsWarning
from asperity.laws import Printed, Shifted
from asperity.laws.layout import force
from asperity.reduction.filter import response
from asperity.running import prepare_case, run
from asperity.scenarios.reducing import patch_planes
from asperity.scenes import compute as ball_on_beam
from asperity.scenes import compute as wheel_on_rail
from asperity.scenes.report import figures_of

pytestmark = pytest.mark.usefixtures("cache_of_module")

BALL = """
kind = "ball-on-beam"
laws = {laws}
start = "0.45 m"
duration = "20 ms"
[surface]
rms = "0.04 um"
longest = "{longest}"
shortest = "60 um"
[contact]
spacing = "20 um"
window = "0.66 mm"
samples = {samples}
{contact}
[ball]
load = "30 N"
[numerics]
highest_frequency = "2 kHz"
"""
STRIP = 'sample_length = "3 mm"'
LINE_LAWS = ["shifted", "printed", "shifted-unfiltered", "printed-unfiltered", "hertz-filtered", "linear"]
RAIL = """
kind = "wheel-on-rail"
laws = {laws}
duration = "{duration}"
settling = "0.1 s"
[surface]
spectrum = "iso3095"
level = "{level}"
{surface}
[contact]
samples = 3
[numerics]
poles = 20
"""


def ball(laws=LINE_LAWS, contact=STRIP, longest="0.36 mm", samples=2):
    text = BALL.format(laws=json.dumps(laws), contact=contact, longest=longest, samples=samples)
    return parse_case(text)


def rail(laws, duration, level, surface=""):
    return parse_case(RAIL.format(laws=json.dumps(laws), duration=duration, level=level, surface=surface))


def computed(case):
    kind = ball_on_beam if case.kind == "ball-on-beam" else wheel_on_rail
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        return kind.compute(prepare_case(case), lambda done, total, message: None)


def at_load(tree):
    """The state nearest the working load."""
    contact = tree["contact"]
    return int(np.argmin(np.abs(contact["approach"].values - contact.attrs["working_approach"])))


def warned_of_filters(tree):
    return [
        w["message"] for w in json.loads(tree.attrs["warnings"]) if w["category"] == "ContactFilterWarning"
    ]


def caption(tree, name):
    return next(part for part in figures_of(tree) if part.name == name).caption(tree)


@pytest.fixture(scope="module")
def tree():
    return run(ball())


@pytest.fixture(scope="module")
def chain():
    return computed(ball())


def levels(tree, name):
    with np.errstate(divide="ignore"):
        return 20 * np.log10(tree[f"contact/{name}"].values)


class TestWhatIsStored:
    @pytest.mark.parametrize("name", ["filter", "printed_filter"])
    def test_what_is_applied_is_what_was_fitted(self, tree, name):
        fitted, applied = levels(tree, name), levels(tree, f"{name}_applied")
        excited = tree["contact/filter_excited"].values > 0
        counted = (fitted > -30.0) & excited
        assert counted.sum() > 50
        assert np.abs(applied - fitted)[counted].max() < 0.3

    def test_what_was_fitted_is_the_ratio_of_the_spectra(self, tree):
        """Over each octave; single bands scatter."""
        fitted, raw = tree["contact/filter"].values, tree["contact/filter_raw"].values
        excited = tree["contact/filter_excited"].values > 0
        wavenumber = tree["contact/wavenumber"].values
        octaves = np.floor(np.log2(wavenumber / wavenumber[0]))
        for row in np.flatnonzero(np.isfinite(fitted).all(axis=1)):
            for octave in range(1, int(octaves.max())):
                band = (octaves == octave) & excited
                mean = [10 * np.log10(np.mean(values[row, band] ** 2)) for values in (fitted, raw)]
                assert mean[0] == pytest.approx(mean[1], abs=1.0)

    def test_printed_filter_starts_at_one_and_the_other_below(self, tree):
        """The patch averages what varies across: only the tangent normalisation says so."""
        working = at_load(tree)
        ratio = float(tree["contact/filter_scale"][working])
        assert 0.3 < ratio < 0.9
        printed, tangent = (tree[f"contact/{name}"][working] for name in ("printed_filter", "filter"))
        assert float(printed[0]) == pytest.approx(1.0, abs=0.15)
        assert float(tangent[0]) == pytest.approx(ratio, rel=0.35)
        assert tree["contact/filter"].attrs["normalise"] == "tangent"

    def test_signed_estimate_starts_at_one(self, tree):
        row, low = at_load(tree), slice(0, 2)
        signed, theory, coherence = (
            tree[f"contact/filter_{name}"].values[row, low] for name in ("signed", "theory", "coherence")
        )
        np.testing.assert_allclose(signed, theory, atol=0.12)
        assert coherence.min() > 0.9

    def test_approach_says_from_which_plane_it_counts(self, tree):
        assert "plane that the nominal patch feels" in tree["contact/approach"].attrs["long_name"]
        assert "plane that the nominal patch feels" in caption(tree, "contact_force")
        smooth = run(
            parse_case('kind="ball-on-beam"\nlaws=["hertz"]\nduration="5 ms"\n[surface]\nspectrum="iso3095"')
        )
        assert "patch" not in caption(smooth, "contact_force")

    def test_filter_of_smooth_bodies_is_applied_at_the_working_load(self):
        case = 'kind="ball-on-beam"\nlaws=["hertz-filtered"]\nduration="5 ms"\n[surface]\nspectrum="iso3095"'
        smooth = run(parse_case(case))["contact"]
        applied = smooth["filter_applied"].values
        (row,) = np.flatnonzero(np.isfinite(applied).all(axis=1))
        assert float(smooth["approach"][row]) == pytest.approx(smooth.attrs["working_approach"])
        np.testing.assert_allclose(applied[row], smooth["filter"].values[row], atol=0.02)


def test_filters_are_within_0_3_db_of_those_of_exact_contacts(chain):
    """Short waves are small parts of a force: scanned as loosely as a force, filters would be off by 2 dB."""
    exact = parse_case(ball().text.replace("[numerics]", "[numerics]\nforce_accuracy = 1e-6"))
    found, wanted = (
        reduced.reduction.filters["tangent"].contact_filter for reduced in (chain, computed(exact))
    )
    counted = (20 * np.log10(wanted.raw) > -30.0) & wanted.excited
    assert counted.sum() > 50
    assert np.abs(20 * np.log10(found.raw / wanted.raw))[counted].max() < 0.3


class TestUniformTexture:
    def test_wheel_on_a_rail_that_is_the_same_all_across_hears_sin_q_over_q(self):
        """Raw, fitted and applied filter of a whole case, near the working load."""
        case = rail(["shifted", "linear"], "20 ms", "-20 dB", "lateral = inf")
        found = run(case.with_(contact={"samples": 4}))
        working, contact = at_load(found), found["contact"].to_dataset()
        rows = slice(working - 1, working + 2)  # a band of one state holds a bin or two, which scatter
        q = 2 * np.pi * contact["wavenumber"].values * contact["contact_radius"].values[rows, None]
        for at, theory in ((0.5, -0.36), (1.0, -1.50), (1.5, -3.54), (2.0, -6.85), (4.5, -13.27)):
            band = np.abs(np.log2(q / at)) < 0.12
            assert band.any()
            for name in ("filter_raw", "filter", "filter_applied"):
                found = 10 * np.log10(np.mean(contact[name].values[rows][band] ** 2))
                assert found == pytest.approx(theory, abs=0.4 if at < 2 else 0.8), (name, at)


class TestLaws:
    def test_laws_are_normalised_as_they_are_meant(self, chain):
        filters = chain.reduction.filters
        assert set(filters) == {"tangent", "low-wavenumber"}
        line = -chain.textures.line
        for law, normalise in (
            ("shifted", "tangent"),
            ("hertz-filtered", "tangent"),
            ("printed", "low-wavenumber"),
        ):
            found, texture = filters[normalise], chain.laws[law].texture
            half = found.taps.shape[1] // 2
            padded = np.pad(line, half, mode="reflect")
            expected = [np.convolve(padded, taps, mode="valid") for taps in found.taps]
            np.testing.assert_allclose(texture.heights, expected, atol=1e-15)

    def test_a_normalisation_that_is_asked_for_serves_all_laws(self):
        given = computed(ball(["shifted", "printed"], STRIP + '\nnormalise = "low-wavenumber"'))
        assert set(given.reduction.filters) == {"low-wavenumber"}
        textures = [given.laws[law].texture.heights for law in ("shifted", "printed")]
        assert np.array_equal(*textures)

    def test_on_a_wavy_path_filters_are_read_at_the_state_of_the_contact(self):
        """Waves move it by several approaches: under the load it is the same state everywhere."""
        text = ball(["shifted", "hertz-filtered", "printed"], longest="8 mm").text
        found = computed(parse_case(text.replace("0.04 um", "2 um")))
        load, positions = found.shape.load, found.runs["shifted"].positions[0]
        held_at = float(found.reduction.ensemble.curve.inverse(load))
        followed = found.laws["shifted"].texture.held_at(held_at).at(positions)[:, 0]
        assert np.ptp(followed) > 2.0 * found.reduction.pressed.approach
        np.testing.assert_allclose(
            force(found.laws["shifted"], positions, held_at + followed), load, rtol=1e-9
        )
        planes = {name: law.prepare(positions).planes for name, law in found.laws.items()}
        np.testing.assert_allclose(planes["hertz-filtered"], followed, atol=1e-15)
        # smooth bodies carry the load at another approach, but between the same two states
        smooth = found.shape.hertz.approach(load)
        assert smooth > held_at + 0.1 * found.reduction.pressed.approach
        pressed = force(found.laws["hertz-filtered"], positions, smooth + followed)
        np.testing.assert_allclose(pressed, load, rtol=2e-3)
        assert not planes["printed"].any()

    def test_filter_that_no_law_uses_is_not_stored(self):
        found = run(ball(["areal", "linear"]))["contact"]
        assert "filter" in found
        assert "printed_filter" not in found

    def test_unfiltered_laws_follow_the_bare_line(self, chain):
        line, curve = -chain.textures.line, chain.reduction.ensemble.curve
        for law, kind in (("shifted-unfiltered", Shifted), ("printed-unfiltered", Printed)):
            built = chain.laws[law]
            assert isinstance(built, kind)
            assert built.name == law
            assert built.curve is not None
            np.testing.assert_array_equal(built.texture.heights, line[None])
            np.testing.assert_array_equal(built.curve.knots, curve.knots)
        assert chain.laws["printed-unfiltered"].datum == chain.reduction.ensemble.datum

    def test_unfiltered_laws_force_is_that_of_their_stiffnesses(self):
        """Small motion: `shifted` as the linear contact of stiffness k_t, `printed` by k_c/k_t below it."""
        tree = run(rail(["shifted-unfiltered", "printed-unfiltered", "linear"], "0.2 s", "+0 dB"))
        level = tree["spectra/force_level"].sel(band=slice(700, 4100))
        contact = tree["contact"].to_dataset()
        working, load = contact.attrs["working_approach"], contact.attrs["working_load"]
        secant = load / (working + contact.attrs["datum"])
        tangent = np.interp(working, contact["approach"], contact["tangent_stiffness"])
        shifted = level.sel(law="shifted-unfiltered")
        difference = level.sel(law="printed-unfiltered") - shifted
        assert 20 * np.log10(secant / tangent) < -3.5
        np.testing.assert_allclose(difference, 20 * np.log10(secant / tangent), atol=0.2)
        np.testing.assert_allclose(shifted - level.sel(law="linear"), 0.0, atol=0.3)

    def test_result_says_what_an_unfiltered_law_is(self, tree):
        meanings = {law["name"]: law["meaning"] for law in json.loads(tree["scenario"].attrs["laws"])}
        assert meanings["printed-unfiltered"].endswith("filtered line texture. Here without the filter.")
        assert meanings["hertz-filtered"].endswith("Here with the filtered line texture.")


class TestWarnings:
    def test_printed_asymptote_without_long_waves(self, tree):
        (message,) = warned_of_filters(tree)
        contact = tree["contact"].to_dataset()
        ratio = np.interp(
            contact.attrs["working_approach"],
            contact["approach"][contact["filter_scale"].notnull()],
            contact["filter_scale"].dropna("approach"),
        )
        assert re.match(r"only \d+ % of the texture's power lies in waves with k a < 0\.5, where", message)
        assert (
            f"the filter of the law printed is set to one: k_0/k_t = {ratio:.2f} under the working load"
            in message
        )
        assert f"its force keeps {-20 * np.log10(ratio):.1f} dB" in message
        assert 'Set contact.normalise = "tangent"' in message

    def test_no_law_uses_it_no_word(self):
        assert not warned_of_filters(run(ball(["shifted", "printed-unfiltered"])))

    def test_texture_with_long_waves_passes(self):
        long = 'sample_length = "20 mm"'
        assert not warned_of_filters(run(ball(["printed"], long, longest="8 mm", samples=1)))

    def test_too_few_taps(self):
        (message,) = warned_of_filters(run(ball(["shifted"], STRIP + "\nfilter_taps = 16")))
        assert re.match(
            r"the filter of the law shifted with J = 16 misses the fitted one by \d\.?\d* dB", message
        )
        assert "Leave out contact.filter_taps" in message

    def test_as_in_the_thesis_by_its_keys(self):
        """A polynomial over the wavenumber and a short filter by window; both shown, the latter warned of."""
        found = run(ball(["printed"], STRIP + "\nfilter_degree = 6\nfilter_taps = 34", samples=1))
        contact = found["contact"].to_dataset()
        taps = json.loads(found["scenario"].attrs["numerics"])
        assert {"name": "filter order J", "value": "34"} in taps
        row = np.flatnonzero(np.isfinite(contact["printed_filter"].values[:, 0]))[-1]
        fitted = 20 * np.log10(contact["printed_filter"].values[row])
        within = (fitted < -0.01) & (fitted > -59.0) & (contact["filter_excited"].values > 0)
        k = contact["wavenumber"].values[within]
        residual = fitted[within] - np.polyval(np.polyfit(k, fitted[within], 6), k)
        assert np.abs(residual).max() < 1e-6
        assert any("misses the fitted one" in message for message in warned_of_filters(found))


class TestDatum:
    @staticmethod
    def measured(tmp_path, contact):
        rng = np.random.default_rng(2)
        k = np.hypot(*np.meshgrid(np.fft.fftfreq(300, 20e-6), np.fft.rfftfreq(60, 20e-6), indexing="ij"))
        shape = np.where(k > 0, np.maximum(k, 2.5e3) ** -1.8, 0.0)
        z = np.fft.irfft2(np.fft.rfft2(rng.standard_normal((300, 60))) * shape, s=(300, 60))
        np.savez(tmp_path / "map.npz", z=0.06 * z / z.std())
        surface = 'file = "map.npz"\nheight_unit = "um"\npixel = "20 um"'
        text = BALL.format(laws='["printed"]', contact=contact, longest="0.4 mm", samples=2)
        text = re.sub(r"rms = .*\nlongest = .*\nshortest = .*", surface, text)
        return parse_case(text, tmp_path / "case.toml")

    def test_as_printed_it_is_the_samples_alone(self, tmp_path):
        """It did grow with the strips for the filters, and with the path, though the samples stayed."""
        found = []
        for contact in ('sample_length = "1.4 mm"', 'sample_length = "5 mm"'):
            reduction = computed(self.measured(tmp_path, contact)).reduction
            found.append((reduction.ensemble.datum, reduction.datums["path"]))
        assert found[0][0] == found[1][0]
        assert found[1][1] > 1.02 * found[1][0]

    def test_by_its_key_it_is_that_of_samples_and_path(self, tmp_path):
        contact = 'sample_length = "1.4 mm"\ndatum = "path"'
        reduction = computed(self.measured(tmp_path, contact)).reduction
        assert reduction.ensemble.datum == reduction.datums["path"] > reduction.datums["samples"]

    def test_of_samples_and_path_it_is_the_first_touch_of_the_path(self, chain):
        """No point of the path is touched below the state zero, though the strips would be touched later."""
        body, path = chain.shape.body, chain.textures.path
        windows = np.lib.stride_tricks.sliding_window_view(path.rows(0, path.shape[0]), body.shape)[:, 0]
        touches = np.array([(body - window).min() for window in windows])
        touches += patch_planes(path, chain.shape)[body.shape[0] // 2 :][: len(touches)]
        assert -touches.min() == pytest.approx(chain.reduction.datums["path"], rel=1e-9)
        strips = [first_touch(strip.heights, body).min() for strip in chain.textures.strips]
        assert touches.min() < min(strips)

    def test_force_vanishes_at_the_state_zero_for_every_sample(self, chain):
        reduction = chain.reduction
        assert reduction.ensemble.datum == reduction.datums["samples"]
        below = reduction.ensemble.states <= 0.0
        assert not reduction.ensemble.forces[:, below].any()

    def test_report_says_what_the_datum_does_and_it_does(self, tmp_path):
        """The change that the caption announces is the one that a run with the other datum has."""
        runs = {
            datum: run(self.measured(tmp_path, f'sample_length = "3 mm"\ndatum = "{datum}"'))
            for datum in ("samples", "path")
        }
        level = [
            found["spectra/force_level"].sel(law="printed", band=slice(400, 2100)) for found in runs.values()
        ]
        for (datum, found), change in zip(
            runs.items(), (level[1] - level[0], level[0] - level[1]), strict=True
        ):
            assert found["contact"].attrs["datum_from"] == datum
            said = re.search(r"would change that by ([+−]\d+\.\d) dB", caption(found, "contact_force"))
            assert said is not None
            expected = float(said[1].replace("−", "-"))
            assert abs(expected) > 0.2
            assert float(change.mean()) == pytest.approx(expected, abs=0.15)


def test_response_of_the_taps_is_what_the_force_follows(chain):
    """A law's own texture against the line: the ratio of their spectra is the stored response."""
    found = chain.reduction.filters["tangent"]
    row = len(found.taps) // 2
    line, heard = -chain.textures.line, chain.laws["shifted"].texture.heights[row]
    half = found.taps.shape[1] // 2
    inner = slice(half, -half)
    spectra = [np.fft.rfft(z[inner] * np.hanning(len(z[inner]))) for z in (line, heard)]
    k = np.fft.rfftfreq(len(line[inner]), found.spacing)
    ratio = np.real(spectra[1] * np.conj(spectra[0])) / np.abs(spectra[0]) ** 2
    strong = np.abs(spectra[0]) > 0.2 * np.abs(spectra[0]).max()
    expected = response(found.taps, found.spacing, k[strong])[row]
    np.testing.assert_allclose(ratio[strong], expected, atol=0.12)
