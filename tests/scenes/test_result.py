"""What the result of any scene holds: the whole chain on small cases, by every law."""

import json

import numpy as np
import pytest

import asperity
from asperity import Track, Wheel
from asperity.case.cases import parse_case
from asperity.laws import names
from asperity.optimising.definition import ACCELERATION, measures_of
from asperity.reference.railways import iso_3095_decay_rate
from asperity.reporting.data import signed
from asperity.scenes.track import described_losses, loss_factor_error
from asperity.spectra import nominal_frequency
from small_cases import changed

EVERY = {
    "ball-on-beam": changed("ball-on-beam", laws=list(names())),
    "wheel-on-rail": changed("wheel-on-rail", laws=list(names()), contact={"window": "20 mm"}),
    "bodies": changed("bodies", laws=["table", "direct", "linear-filtered", "linear"]),
}
GROUPS = {"scenario", "surface", "contact", "rolling", "spectra"}
OF_TRACKS = {"track", "pass_by", "sideways"}


@pytest.fixture(params=EVERY)
def kind(request):
    return request.param


@pytest.fixture
def tree(kind, runs):
    return runs(EVERY[kind])


@pytest.fixture
def ball(runs):
    return runs(EVERY["ball-on-beam"])


@pytest.fixture
def wheel(runs):
    return runs(EVERY["wheel-on-rail"])


def warned(tree):
    return {each["category"] for each in json.loads(tree.attrs["warnings"])}


def numerics(tree):
    return {entry["name"]: entry["value"] for entry in json.loads(tree["scenario"].attrs["numerics"])}


def test_groups_and_provenance(tree, kind):
    assert set(tree.children) == GROUPS | (OF_TRACKS if kind == "wheel-on-rail" else set())
    moving = ("law", "contact", "time")
    assert all(tree["rolling"][name].dims == moving for name in EVERY[kind].DISPLACEMENTS)
    assert parse_case(tree.attrs["case"]) == EVERY[kind]
    assert (tree.attrs["seed"], tree["scenario"].attrs["kind"]) == (1, kind)
    assert tree.attrs["asperity_version"] == asperity.__version__
    assert any("Lundberg" in each for each in json.loads(tree.attrs["citations"]))
    assert "ShortRecordWarning" in warned(tree)
    lost = {"bodies": "None of the 2 contacts is ever lost"}
    verdict = lost.get(kind, f"The {kind.partition('-')[0]} never loses contact")
    assert tree.attrs["verdict"].startswith(verdict)


def test_what_observers_doubt_stands_in_the_table_of_validity(wheel):
    """After what is asked of the contact: that of the track, whose largest error it holds."""
    checks = json.loads(wheel["contact"].attrs["validity"])
    row = checks[-1]
    assert row["quantity"] == "error of the contact force for constant loss factors, at most"
    error = wheel["track/loss_factor_force_error"].values
    assert row["value"].startswith(signed(float(error[int(np.abs(error).argmax())])))


@pytest.mark.usefixtures("own_cache")
@pytest.mark.parametrize("kind", ["ball-on-beam", "wheel-on-rail"])
def test_a_run_on_its_own_has_the_same_digits(tree, kind):
    again = asperity.run(EVERY[kind].with_(laws=["linear", "table"]), brief=True)["rolling/contact_force"]
    assert np.array_equal(again, tree["rolling/contact_force"].sel(law=["linear", "table"]))


def test_time_is_uniform_energy_closes_and_the_mean_force_is_the_load(tree):
    rolling, time = tree["rolling"], tree["rolling/time"].values
    np.testing.assert_allclose(np.diff(time), time[1], rtol=1e-9)
    np.testing.assert_allclose(rolling["contact_force"].mean("time") / rolling["static_load"], 1.0, rtol=0.01)
    assert float(rolling["energy_residual"].max()) < 1e-5


def test_bodies_approach_as_far_as_they_sink(tree, kind):
    """δ = w of what rolls − w of what is rolled over."""
    over, rolling = EVERY[kind].DISPLACEMENTS
    sunk = tree["rolling"][rolling] - tree["rolling"][over]
    np.testing.assert_allclose(sunk, tree["rolling/relative_displacement"], atol=1e-9)


def test_table_follows_direct(tree):
    force, level = tree["rolling/contact_force"], tree["spectra/force_level_difference_to_reference"]
    direct = force.sel(law="direct")
    off = ((force.sel(law="table") - direct).std("time") / direct.std("time")).max()
    assert 20.0 * np.log10(1.0 + float(off)) < 0.2  # dB; of a dozen textures 0.1, deviation 0.03
    assert level.attrs["reference"] == "direct"
    assert level.sizes["band"] >= 10
    assert float(abs(level.sel(law="table")).max()) < 0.3


def test_areal_explains_direct_better_than_a_line_does(ball, wheel):
    """Of what the force of a line leaves unexplained, which chance moves much, it leaves a tenth at most."""
    for tree, least in ((ball, 0.95), (wheel, 0.9996)):
        correlation = tree["rolling/contact_force"].sel(contact=1).to_pandas().T.corr()["direct"]
        unexplained = 1.0 - correlation**2
        assert correlation["areal"] > least
        assert unexplained["areal"] < 0.1 * unexplained[["shifted", "hertz"]].min()


def test_differences_to_the_linear_laws(tree):
    level, name = tree["spectra/force_level"], "force_level_difference_to_linear_filtered"
    np.testing.assert_allclose(tree["spectra"][name], level - level.sel(law="linear-filtered"))
    assert tree["spectra"][name].attrs["reference"] == "linear-filtered"


def test_the_verdict_keeps_quiet_of_bands_that_say_little(ball):
    assert float(ball["spectra/band_time_product"].max()) < 10.0
    assert "The record is too short to compare its one-third octaves" in ball.attrs["verdict"]
    assert "per one-third octave" not in ball.attrs["verdict"].lower()


def test_the_verdict_compares_with_practice_first_and_names_the_secant(runs):
    laws, secant = ["areal", "linear", "linear-filtered"], {"linearise": "secant"}
    found = runs(changed("ball-on-beam", laws=laws, contact=secant, duration="0.15 s"))
    verdict = found.attrs["verdict"]
    practice, bare = "over linear-filtered", "over linear (linear with the stiffness F/r)"
    assert 0 < verdict.index(practice) < verdict.index(bare)
    spectra = found["spectra"].to_dataset()
    settled = spectra["start_share"] <= spectra["start_share"].attrs["most"]
    bands = spectra.where((spectra["band_time_product"] >= 10.0) & settled, drop=True)
    difference = bands["force_level_difference_to_linear_filtered"].sel(law="areal", band=slice(90, 5500))
    for at in (difference.values.argmin(), difference.values.argmax()):
        band = nominal_frequency(float(difference["band"][at]))
        assert f"{float(difference[at]):+.1f} dB ({band})".replace("-", "−") in verdict


def test_the_verdict_tells_where_and_by_how_much_the_start_makes_levels_low(runs):
    found = runs(changed("ball-on-beam", laws=["linear"], settling="10 ms"))
    start = found["spectra/start_share"]
    low = start > start.attrs["most"]
    assert 0 < low.sum() < len(low)
    named = ", ".join(nominal_frequency(float(band)) for band in start["band"][low])
    size = -10.0 * np.log10(1.0 - float(start.max()))
    assert f"Levels at {named} are up to {size:.1f} dB low: " in found.attrs["verdict"]
    settled = runs(changed("ball-on-beam", laws=["linear"], beam={"loss_factor": 0.5}))
    assert "dB low" not in settled.attrs["verdict"]


class TestTrack:
    def test_its_points_are_judged_by_their_acceleration(self, wheel):
        velocity = wheel["spectra/point_velocity_psd"].sel(law="linear").mean("point")
        expected = velocity * (2.0 * np.pi * velocity["frequency"]) ** 2 / 1e-6**2
        measure = measures_of(EVERY["wheel-on-rail"])[ACCELERATION]
        np.testing.assert_allclose(measure.density(wheel, "linear"), expected, rtol=1e-12)

    def test_marks(self, wheel):
        spectra = wheel["spectra"].attrs
        assert spectra["sleeper_passing_frequency"] == pytest.approx(56 / 0.6)
        middle = 0.5 * (spectra["pinned_pinned_low"] + spectra["pinned_pinned_high"])
        assert middle == pytest.approx(wheel["track"].attrs["pinned_pinned_frequency"])
        assert spectra["wheel_revolution_frequency"] == pytest.approx(56 / (2 * np.pi * 0.46))

    def test_loss_factors_err_by_what_the_result_says_in_every_band(self, wheel):
        track, errors = wheel["track"], wheel["track/loss_factor_force_error"]
        assert float(errors.band[0]) == pytest.approx(5.01, abs=0.01)
        assert set(np.round(wheel["spectra/band"].values)) <= set(np.round(errors.band.values))
        assert 0.01 < float(np.abs(errors).max()) < 0.2  # x2000: the rail alone has a loss factor
        assert track.attrs["static_deflection_in_time"] > track.attrs["static_deflection"]
        assert "else below 0.05" in numerics(wheel)["loss factors in time"]

    def test_viscous_tracks_have_nothing_to_tell(self):
        track = Track.named("nordborg", rail_loss_factor=0.0)
        viscous = loss_factor_error(track, Wheel(600.0, 65e3).receptance, 1.2e9, 2e3)
        assert (viscous, list(described_losses(viscous))) == ({}, [])

    def test_the_limit_of_decay_rates(self):
        limits = iso_3095_decay_rate([100.0, 250.0, 500.0, 800.0, 2000.0, 9000.0])
        np.testing.assert_array_equal(limits, [np.nan, 2.0, 6.0, 2.19, 0.8, np.nan])

    def test_poles_follow_the_scattered_kernel(self, runs, wheel):
        scatter = changed("wheel-on-rail", laws=["shifted"], numerics={"poles": None, "kernel": "scatter"})
        scattered, poles = runs(scatter), wheel["rolling/contact_force"].sel(law="shifted")
        difference = np.abs(poles.values - scattered["rolling/contact_force"].values[0]).max()
        assert difference < 0.005 * float(poles.std())


@pytest.mark.usefixtures("own_cache")
def test_long_work_says_what_it_does():
    seen = {}
    case = changed("ball-on-beam", laws=["areal", "table"], duration="6 ms")
    asperity.run(case, lambda done, total, what: seen.setdefault(what, []).append((done, total)))
    assert [what for what in seen if what.startswith("compiled functions")]
    wanted = {"pressing the samples", "scanning for the contact filters", "scanning the path", "rolling"}
    assert wanted <= set(seen)
    for steps in seen.values():
        assert steps[-1][0] == steps[-1][1]
    scanned = seen["scanning the path"]  # of all states together, so that the time that is left does not jump
    assert scanned == sorted(scanned)
    assert len({total for _, total in scanned}) == 1
