"""Runs of all scenes against each other, against the frequency domain, and against what must come out."""

import json

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import asperity
from asperity import Beam, ModalStructure, Profile, material
from asperity.case.cases import parse_case, template
from asperity.laws.layout import force
from asperity.running import prepare_case
from asperity.scenes import schema
from asperity.scenes.compute import compute
from asperity.schema.spectra import FORCE_LEVEL
from asperity.surfaces.bands import from_bands
from small_cases import CASES, changed

pytestmark = pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")


def forces(tree, law=0):
    return tree["rolling/contact_force"].values[law]


def held(tree, entry, **at):
    return tree[entry.path].sel(**at).values


# --- presets are bodies over what they name

ON_BEAM = {
    "laws": ["hertz", "linear"], "start": "0.3 m", "duration": "30 ms", "settling": "10 ms",
    "surface": {"spectrum": "iso3095", "level": "-40 dB"},
    "contact": {"spacing": "20 um", "window": "0.6 mm"}, "numerics": {"highest_frequency": "2 kHz"},
}  # fmt: skip
SPEED = 30.0
BANDS = 10.0 ** (np.arange(-20, -4) / 10.0)
LINE = from_bands(20_000, 1e-3, BANDS, np.full(BANDS.size, -10.0), 3).heights
ON_TRACK = {
    "speed": SPEED, "start": 2.0, "duration": 0.3, "settling": 0.06, "laws": ["linear", "hertz"],
    "track": {"name": "nordborg", "points": [4.0]},
    "numerics": {"time_step": 1e-3 / SPEED, "highest_frequency": 2500, "kernel": "scatter"},
    "contact": {"spacing": 1e-3, "window": 20e-3, "samples": 2, "sample_length": 60e-3},
    "surface": {"line": Profile(LINE, 1e-3), "continuation": "mirror"},
}  # fmt: skip
WHEEL = {"radius": 0.46, "mass": 600, "load": 65e3, "transverse_radius": "inf"}
BOGIE = WHEEL | {"type": "bogie", "distance": 2.5, "masses": [1500], "springs": [0.6e6], "dampers": [1e4]}


def on_track(body):
    return {"kind": "bodies", "over": "track", "body": body} | ON_TRACK


OF_TRACKS = [
    schema.RADIATED_POWER_LEVEL, schema.PASS_BY_MAXIMUM_LEVEL, schema.POINT_VELOCITY_LEVEL,
    schema.LINEAR_REFERENCE_LEVEL, schema.SOUND_POWER_LEVEL_A,
]  # fmt: skip
BALL, RIGID = {"load": "30 N"}, WHEEL | {"section": "rigid"}
NAMED = {
    "beam": ({"kind": "ball-on-beam", "ball": BALL} | ON_BEAM, {"kind": "bodies", "body": BALL} | ON_BEAM),
    "track": ({"kind": "wheel-on-rail", "wheel": RIGID} | ON_TRACK, on_track(WHEEL)),
}


@pytest.mark.parametrize("over", ["beam", pytest.param("track", marks=pytest.mark.long)])
def test_what_a_preset_names_answers_as_any_body(runs, over):
    named, body = map(runs, NAMED[over])
    entries = [FORCE_LEVEL, *([schema.ACCELERATION_LEVEL] if over == "beam" else OF_TRACKS)]
    np.testing.assert_allclose(forces(body), forces(named), rtol=1e-9, atol=3e-8)
    for entry in entries:
        np.testing.assert_allclose(held(body, entry), held(named, entry), atol=1e-6, equal_nan=True)


def test_modes_of_a_structure_are_the_beam():
    """Forty modes of the same beam at 1001 points: 1e-9 of the force in the same run."""
    beam = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), highest_frequency=40e3)
    x, natural = np.linspace(0.0, 1.0, 1001), beam.natural_frequencies
    modes = ModalStructure(x, natural[:40], beam.damping_ratios[:40], beam.shapes(x)[0][:, :40])
    up_to = 0.5 * (natural[39] + natural[40])
    shared = {"kind": "bodies", "body": {"load": "30 N", "positions": ["0 m", "0.2 m"]}}
    ours, expected = (
        forces(asperity.run(shared | ON_BEAM | own))
        for own in ({"over": "structure", "structure": {"file": modes}}, {"beam": {"modes_up_to": up_to}})
    )
    np.testing.assert_allclose(ours, expected, atol=1e-9 * np.abs(expected).max(), rtol=0)


# --- several contacts


@pytest.fixture
def body(runs):
    return runs(on_track(WHEEL))


@pytest.fixture
def bogie(runs):
    return runs(on_track(BOGIE))


def test_coupled_wheels_follow_the_coupled_reference(bogie, body):
    """Where waves between the wheels interfere, one wheel by itself is decibels off."""
    fine = bogie["spectra/band"].values > 150.0
    level = held(bogie, FORCE_LEVEL, law="linear")
    off, alone = ((level - held(each, schema.LINEAR_REFERENCE_LEVEL))[fine] for each in (bogie, body))
    strongest = np.argmax(np.abs(alone))  # 800 Hz
    # over six draws this band is off by 0.8 dB rms, by one wheel alone by 3.3 dB: one draw shows no less
    assert abs(off[strongest]) < 1.0 < 2.0 < abs(alone[strongest])
    assert np.sqrt(np.mean(off**2)) < 0.7 < 1.0 < np.sqrt(np.mean(alone**2))
    np.testing.assert_allclose(bogie["pass_by/axle_time"], [0.0, 2.5 / SPEED])


@pytest.mark.parametrize("law", ["linear", "hertz"])
def test_two_wheels_radiate_what_their_forces_ask_for(bogie, body, law):
    """In each band the power follows the sum of both mean squares."""
    both = 10.0 ** (bogie["spectra/contact_force_level"].sel(law=law).values / 10.0)
    np.testing.assert_allclose(
        both.mean(axis=0), 10.0 ** (held(bogie, FORCE_LEVEL, law=law) / 10.0), rtol=1e-9
    )
    at = {"law": law, "radiator": "sleepers"}
    power = held(bogie, schema.RADIATED_POWER_LEVEL, **at) - held(body, schema.RADIATED_POWER_LEVEL, **at)
    change = 10.0 * np.log10(both.sum(axis=0)) - held(body, FORCE_LEVEL, law=law)
    missed = np.abs(power - change)[3:]  # where the spectrum within a band differs
    assert np.median(missed) < 0.2
    assert missed.max() < 1.5


def test_one_wheel_of_several_has_a_flat(bogie, runs):
    """It strikes when its own place of the circumference comes down, and the other wheel hardly feels it."""
    flat = {"flat_depth": 0.1e-3, "flat_position": 1.0, "flat_contacts": [2]}
    struck = runs(on_track(BOGIE | flat))
    change = (struck["rolling/contact_force"] - bogie["rolling/contact_force"]).sel(law="hertz")
    change, time = np.abs(change.values), struck["rolling/time"].values
    assert change[1].max() > 2.0 * change[0].max() > 0.0
    assert time[np.argmax(change[1] > 0.1 * change[1].max())] == pytest.approx(1.0 / SPEED, abs=2e-3)


# --- textures, from a case to the numbers that theory expects of them


def rail(runs, **keys):
    keys = {"surface": {"smooth": True}, "wheel": {"roughness": None}, "laws": ["linear"]} | keys
    numerics = {"highest_frequency": "2 kHz"}
    return runs(changed("wheel-on-rail", contact={"window": "20 mm"}, numerics=numerics, **keys))


SINE = 5e-6 * np.sin(2 * np.pi * 1e-3 * np.arange(4000) / 80e-3)
"""Heights 1 mm apart, m: the wheel meets a wave every 1.43 ms, 700 Hz."""


def test_a_measured_sine_adds_a_tone(runs):
    """Texture is linear in a linear contact: what it adds to the smooth force has its frequency alone."""
    tree = rail(runs, surface={"line": Profile(SINE, 1e-3)})
    added = forces(tree)[0] - forces(rail(runs))[0]
    level = np.abs(np.fft.rfft(added * np.hanning(len(added))))
    frequency = np.fft.rfftfreq(len(added), float(tree["rolling/time"][1]))
    assert frequency[np.argmax(level)] == pytest.approx(56.0 / 80e-3, abs=20.0)
    near = abs(tree["spectra/frequency"] - 700.0).argsort()[:7]
    psd, reference = (
        tree["spectra"][name].values[..., near] for name in ("force_psd", "linear_reference_psd")
    )
    # solved in the frequency domain, with the wheel at rest
    assert abs(10 * np.log10(psd[0].sum() / reference.sum())) < 2.0


FLAT = {"roughness": None, "flat_depth": "0.3 mm", "flat_position": "1 m"}


def statistics(found):
    return json.loads(found.attrs["statistics"])


def test_statistics_and_line_are_those_of_the_whole_path(monkeypatch):
    """A flat 2 m along the path, beyond what is kept to be looked at from above."""
    monkeypatch.setattr("asperity.scenes.groups.PATH_ROWS", 100)
    found = rail(asperity.run, surface={"spectrum": "iso3095"}, wheel=FLAT)["surface"]
    assert found["path_heights"].shape[0] == 100
    assert found["line"].size == round(56 * 40e-3 / 1e-3) + 1
    path = {s["symbol"]: s for s in statistics(found) if s["surface"] == "path"}
    assert path["Sz"]["value"] > 0.29e-3
    assert path["Sku"]["value"] > 20.0
    assert path["Sq"]["bandwidth"].endswith("2.24 m")
    assert float(found["line"].min()) < -0.25e-3  # with the texture there


def test_what_has_no_correlation_across_has_statistics_of_lines(runs):
    """Interpolated between lines 5 mm apart, a strip has no correlation length of its own."""
    lines = 10e-6 * np.random.default_rng(0).normal(size=(3, round(2 * np.pi * 460)))
    wheel = {"roughness": None, "line": lines, "line_spacing": "1 mm", "line_distance": "5 mm"}
    found = rail(runs, surface={"spectrum": "iso3095"}, wheel=wheel)["surface"]
    assert found.attrs["across"] == "lines"
    values = statistics(found)
    assert {s["surface"] for s in values} == {"middle line of the path", "3 lines of the wheel, mean"}
    mean = next(s for s in values if s["symbol"] == "Rq" and "mean" in s["surface"])
    assert mean["value"] == pytest.approx(10e-6, rel=0.05)
    corrugated = {"corrugation": "20 um", "corrugation_wavelength": "50 mm"}
    values += statistics(rail(runs, surface=corrugated)["surface"])
    assert all(s["symbol"].startswith("R") for s in values)


@pytest.mark.parametrize(("settling", "low", "high"), [("50 ms", 0.75, 1.25), ("0 s", 0.0, 0.6)])
def test_a_record_is_stationary_after_a_run_in_and_starts_quiet_without(runs, settling, low, high):
    """Rms of the force in the first third of the record, over twelve paths, in that of the last.

    Of four dozens of paths the ratio is 1.02 to 1.19: its standard deviation is 0.08.
    """
    case = {"kind": "ball-on-beam", "ball": {"load": "30 N"}} | ON_BEAM
    case |= {"duration": "15 ms", "settling": settling}
    rolled = [runs(case | {"seed": seed}) for seed in range(12)]
    thirds = np.array_split(np.array([forces(tree)[0] - 30.0 for tree in rolled]), 3, axis=1)
    assert low < thirds[0].std() / thirds[2].std() < high


# --- the stiffness of a linear contact


@pytest.mark.parametrize("linearise", ["hertz", "rough", "secant", "smooth secant"])
def test_a_linear_contact_has_the_stiffness_that_it_is_said_to(linearise):
    """dF/dr or F/r of the loading curve; of smooth bodies F/r = F^(1/3) K^(2/3), and dF/dr 3/2 of it."""
    word, laws = linearise.split()[-1], ["areal", "linear"]
    surface = {
        "rms": "0.4 um",
        "longest": "0.12 mm",
        "shortest": "60 um",
    }  # none that bends the whole contact
    if "smooth" in linearise:
        surface, laws = {"spectrum": "iso3095", "level": "-40 dB"}, laws[1:]
    case = changed("ball-on-beam", laws=laws, contact={"linearise": word}, surface=surface)
    computed = compute(prepare_case(case), lambda *_: None)
    found, load = computed.build("linear").stiffness, computed.shape.load
    secant = load ** (1 / 3) * computed.shape.hertz.stiffness_constant ** (2 / 3)
    if linearise in ("hertz", "smooth secant"):
        assert found == pytest.approx(secant * (1.5 if word == "hertz" else 1.0), rel=1e-3)
        return
    states, curve = computed.reduction.ensemble.states, computed.reduction.ensemble.mean_force
    state = np.interp(load, curve, states)
    tangent = float(CubicSpline(states, curve)(state, 1))
    assert found == pytest.approx(tangent if word == "rough" else load / state, rel=0.03)
    # short asperities are soft: of twenty textures dF/dr is 0.91 of that of smooth bodies, deviation 0.04
    assert found < (1.5 * secant if word == "rough" else 0.96 * tangent)


def test_the_filtered_linear_contact_is_linear():
    """The force grows with the approach by k alone, everywhere: the filter does not follow the state."""
    case = changed("ball-on-beam", laws=["linear-filtered"], contact={"linearise": "hertz"})
    law = compute(prepare_case(case), lambda *_: None).build("linear-filtered")
    x = np.linspace(0.45, 0.46, 50)
    near, far = (force(law, x, approach) for approach in (law.approach, law.approach + 1e-6))
    np.testing.assert_allclose(far - near, law.stiffness * 1e-6, rtol=1e-9)
    assert np.ptp(near) > 0.0


# --- presets as they are written, and another scene, with a structure: one file and one line


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")  # of so short a record
@pytest.mark.parametrize("kind", ["ball-bearing", "roller-bearing"])
def test_what_new_prints_of_a_bearing_runs_and_says_which_part_is_heard(kind):
    tree = asperity.run(parse_case(template(kind)).with_(duration=0.05, settling=0.01))
    assert "% from the inner raceway" in tree.attrs["verdict"]
    main = tree["rolling"]["law"].values[0]
    assert ("; shares by areal." in tree.attrs["verdict"]) == (main != "areal")
    grades = {check["grade"] for check in json.loads(tree["contact"].attrs["validity"])}
    assert grades <= {"", "note"}


@pytest.mark.usefixtures("in_cache_of_runs")  # the ball's scans are those of the bodies
@pytest.mark.parametrize(
    ("kind", "keys"),
    [
        ("wheel-on-rail", {"duration": 0.15, "settling": 0.2, "contact.samples": 4}),
        *(pytest.param(kind, {}, marks=pytest.mark.long) for kind in CASES),
    ],
)
def test_what_new_prints_runs_with_all_checks_in_range(kind, keys):
    tree = asperity.run(parse_case(template(kind)).with_(**keys))
    assert [w for w in json.loads(tree.attrs["warnings"]) if w["grade"] != "note"] == []
    checks = json.loads(tree["contact"].attrs["validity"])
    assert len(checks) > 5
    assert {check["grade"] for check in checks} <= {"", "note"}
    assert "never loses contact" in tree.attrs["verdict"]
