"""What is outside the range of its law says so: number, limit, meaning and a remedy that helps."""

import json
import re
from types import SimpleNamespace

import numpy as np
import pytest

import asperity
import small_cases
from asperity import Beam, HalfSpace, ModalStructure, Track, material
from asperity.case.cases import as_case, parse_case
from asperity.cli.running import planned
from asperity.contact.scan import Counts, warn_of_flaws, window_for
from asperity.errors import CaseError, Grade, InputError, PhysicsWarning
from asperity.running import prepare_case
from asperity.scenarios.preparing import try_contacts
from asperity.scenes.validity import _contact, _doubts, _of_motion
from asperity.spectra import band_levels, lowest_band, psd, spectrum_segment
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import RailBetween
from command_line import call

STEEL = material("steel")

CASE = """
kind = "ball-on-beam"
laws = {laws}
start = "0.45 m"
duration = "6 ms"
settling = "2 ms"
ball.load = "20 N"
contact = {{spacing = "{spacing} um", window = "{window} mm", samples = 3, sample_length = "2.2 mm"}}
numerics.highest_frequency = "4 kHz"
[surface]
{surface}
"""
MIDDLE, ROUGH, FINE = {"rms": 0.17}, {"rms": 0.4}, {"rms": 1.0, "shortest": 20, "hurst": 0.2}
"""Of twenty textures, the contact area ratio of the first is 0.80, with a standard deviation of 0.04."""
CELLS = "share of the load on asperities of a single cell"
CUT_OFF = "share of contacts that the window cuts off, filters"


def text(surface, laws=("areal",), spacing=10, window=0.66):
    return CASE.format(surface=surface, laws=json.dumps(list(laws)), spacing=spacing, window=window)


def synthetic(rms, shortest=60, hurst=0.8, **keys):
    waves = f'longest = "0.4 mm"\nshortest = "{shortest} um"\nhurst = {hurst}'
    return text(f'rms = "{rms} um"\n{waves}', **keys)


def tried(written):
    """Contacts of a case that are tried before it is run."""
    return try_contacts(prepare_case(parse_case(written)), lambda *_: None)


def validity(tree):
    return {entry["quantity"]: entry for entry in json.loads(tree["contact"].attrs["validity"])}


def messages(tree, category="OutOfRangeWarning"):
    return [w for w in json.loads(tree.attrs["warnings"]) if w["category"] == category]


@pytest.mark.parametrize("kind", ["smooth", "rough", "fine"])
def test_a_check_foresees_what_the_run_will_find_fault_with(runs, kind):
    """Area, slope, grid and window, each of the same grade; the gravest first."""
    keys = {"smooth": {"rms": 0.02}, "rough": ROUGH, "fine": FINE | {"window": 0.44}}[kind]
    case = parse_case(synthetic(**keys))
    told, tree = planned(prepare_case(case)), runs(case)
    area, found = tree["contact"].attrs["contact_area_ratio"], validity(tree)
    said = next(row["value"] for row in told["plan"] if row["name"] == "real contact")
    assert float(re.search(r"about (\d+) %", said)[1]) == pytest.approx(100 * area, abs=10)
    for name in ("real contact area", "rms slope", "on asperities of a single cell"):
        foreseen = [w["grade"] for w in told["warnings"] if name in w["message"]]
        assert foreseen == [w["grade"] for w in messages(tree) if name in w["message"]]
    cut_off = "contacts that the window cuts off, the loading curve"
    foreseen = [w["grade"] for w in told["warnings"] if cut_off in w["message"]]
    truncated = messages(tree, "TruncatedContactWarning")
    assert foreseen == [w["grade"] for w in truncated if "loading" in w["message"]]
    grades = [w["grade"] for w in json.loads(tree.attrs["warnings"])]
    assert grades == sorted(grades, key=["out of range", "warning", "note"].index)
    if kind == "smooth":
        assert not messages(tree)
        assert all(entry["grade"] == "" for name, entry in found.items() if "cuts off" not in name)
        assert area == pytest.approx(1.0, abs=0.03)
        assert not tree.attrs["verdict"].startswith(("Out of range", "Doubtful"))
    elif kind == "rough":
        assert ["Take table." in w["message"] for w in messages(tree)] == [True]
    else:
        verdict = tree.attrs["verdict"]
        assert verdict.startswith("Out of range for areal: real contact area ")
        assert " of the load on single cells" in verdict
        share = tree["contact"].attrs["isolated_share"]
        assert share > 0.05
        assert found[CELLS]["grade"] == ("out of range" if share > 0.25 else "warning")
        assert found[CELLS]["remedy"] == (
            'A grid that would do: contact.spacing = "5 um" resolves all waves, or surface.shortest = '
            '"40 um" leaves out the waves that this one does not resolve.'
        )


@pytest.mark.parametrize(
    ("keys", "grade", "verdict"), [(MIDDLE, "warning", "Doubtful"), (ROUGH, "out of range", "Out of range")]
)
def test_a_rough_contact_is_warned_of_and_table_is_named(runs, keys, grade, verdict):
    tree = runs(parse_case(synthetic(**keys, laws=["areal", "table"])))
    ratio = tree["contact"].attrs["contact_area_ratio"]
    assert 0.7 < ratio < 0.9 if grade == "warning" else ratio < 0.7
    (warning,) = messages(tree)
    assert warning["grade"] == grade
    assert f"{ratio:.2f}, in range from 0.9 on" in warning["message"]
    assert "Read table, which was rolled as well." in warning["message"]
    table = tree["rolling/contact_force"].sel(law="table").values.std()
    assert tree.attrs["verdict"].startswith(verdict)
    assert f"real contact area {100 * ratio:.2g} %" in tree.attrs["verdict"]
    assert f"table varies by {table:.3g} N rms" in tree.attrs["verdict"]


def test_table_alone_is_not_concerned(runs):
    tree = runs(parse_case(synthetic(**ROUGH, laws=["table"])))
    assert not messages(tree)
    assert "range" not in tree.attrs["verdict"]


@pytest.mark.parametrize("keys", [{"spacing": 5}, {"shortest": 40}])
def test_both_remedies_of_a_coarse_grid_help(keys):
    assert tried(synthetic(**FINE | keys)).pressed.isolated_share < 0.05


class TestWindow:
    def test_the_window_that_is_named_holds_the_contacts(self, runs):
        small = runs(parse_case(synthetic(0.3, window=0.36)))
        entry = validity(small)[CUT_OFF]
        assert entry["grade"] == "out of range"
        named = float(re.search(r'contact\.window = "([\d.]+) mm" holds them', entry["remedy"])[1])
        assert 0.5 < named < 1.0
        (warning,) = [w for w in messages(small, "TruncatedContactWarning") if "loading" in w["message"]]
        assert entry["remedy"] in warning["message"]
        assert tried(synthetic(0.3, window=0.36)).cut_off > 0.1
        assert tried(synthetic(0.3, window=named)).cut_off < 0.01

    def test_only_contacts_that_are_rolled_reach_the_headline(self, runs):
        """The highest of the given states is cut off, but the ball does not get there."""
        states = 'approaches = ["-0.1 um", "0 um", "0.3 um", "0.6 um", "1 um", "1.5 um", "4 um"]'
        smooth = synthetic(0.02, window=0.44).replace("samples = 3", f"samples = 3, {states}")
        quiet = runs(parse_case(smooth))
        assert validity(quiet)[CUT_OFF]["grade"] != ""
        entry = validity(quiet)["share of the time in contacts that the window cuts off, areal"]
        assert (entry["value"], entry["grade"]) == ("0 %", "")
        assert quiet.attrs["verdict"].startswith("The ball never loses contact")
        held = float(re.search(r"Forces above ([\d.]+) N", entry["meaning"])[1])
        assert quiet["rolling/contact_force"].values.max() < held < quiet["contact/force"].values[-1]

    def test_a_scan_names_its_window_and_that_of_smooth_bodies_is_a_tenth_wider_than_their_patch(self):
        x = 1e-5 * np.arange(-20, 21)
        body = (x[:, None] ** 2 + x**2) / (2 * 0.025)
        expected = 1.1 * 2 * np.sqrt(0.025 * 2e-6)  # a = sqrt(R δ)
        assert window_for(body, (1e-5, 1e-5), 2e-6) == pytest.approx(expected, rel=0.03)
        with pytest.warns(PhysicsWarning, match=r"A window of 0\.\d+ mm holds them\.") as caught:
            HalfSpace((21, 21), 1e-5, 115e9).scan(np.zeros((25, 21)), body[10:31, 10:31], [1e-6, 2e-6])
        assert caught[0].message.grade is Grade.OUT


@pytest.mark.parametrize("kind", ["unconverged", "truncated"])
def test_flaws_are_told_with_their_share_and_graded_by_it(kind):
    """Contacts that missed their tolerance, and those that are cut off."""
    for flawed, grade, words in ((32, Grade.NOTE, "too seldom"), (4400, Grade.OUT, "so often that levels")):
        counts = Counts(10_000)._replace(**{kind: flawed})
        with pytest.warns(PhysicsWarning) as caught:
            warn_of_flaws(counts, "the path", "numerics.force_accuracy")
        (message,) = (each.message for each in caught)
        assert message.grade is grade
        assert f"{flawed} of 10000 contact solutions of the path ({flawed / 100:.2g} %)" in str(message)
        assert kind == "unconverged" or words in str(message)
    shares = {0.0099: Grade.NOTE, 0.01: Grade.WARNING, 0.099: Grade.WARNING, 0.1: Grade.OUT}
    assert {share: Grade.of_share(share) for share in shares} == shares


# --- motions that are none, and records that hold nothing: told before, or in the verdict

SHORT = {"kind": "wheel-on-rail", "surface": {"spectrum": "iso3095"}, "wheel": {"section": "rigid"}}
SHORT |= {"contact": {"samples": 2, "sample_length": "0.1 m"}}


@pytest.mark.parametrize("duration", [0.03, 0.1, 0.3, 0.5, 1.0])
def test_a_record_without_a_band_up_to_the_highest_frequency_is_refused_before_it_is_rolled(duration):
    """As the spectra of the run would: the check and they agree on either side of the lowest band."""
    step = 1.0 / 8000.0
    lowest = lowest_band(round(duration / step) + 1, step)
    for highest, is_covered in ((0.8 * lowest, False), (1.01 * lowest, True)):
        signal = np.random.default_rng(1).standard_normal(round(duration / step) + 1)
        lines, density = psd(signal, step, segment=spectrum_segment(len(signal), step))
        if is_covered:
            assert len(band_levels(lines, density, high=highest)[0]) == 1
        else:
            with pytest.raises(InputError, match="enough lines to cover a band"):
                band_levels(lines, density, high=highest)
        numerics = {"highest_frequency": highest, "time_step": step}
        case = as_case(SHORT | {"duration": duration, "numerics": numerics})
        if is_covered:
            prepare_case(case)
        else:
            told = f"numerics.highest_frequency: received .* the lowest is at {lowest:.4g} Hz. Record longer"
            with pytest.raises((CaseError, InputError), match=told):
                prepare_case(case)


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_an_energy_that_is_left_over_is_warned_of_and_leads_the_verdict(runs, monkeypatch):
    case = small_cases.changed("bodies", laws=["linear"])
    found = validity(runs(case))["energy that the balance leaves open, linear"]
    assert (found["grade"], found["limit"]) == ("", "up to 0.001")
    monkeypatch.setattr("asperity.scenes.validity.RESIDUAL", 1e-12)
    tree = asperity.run(case, brief=True)
    found = validity(tree)["energy that the balance leaves open, linear"]
    assert found["grade"] == "warning"
    assert "numerics.time_step" in found["remedy"]
    assert tree.attrs["verdict"].startswith("Doubtful for linear: ")
    assert "is unaccounted for" in tree.attrs["verdict"]


@pytest.mark.parametrize(
    ("force", "moved", "words"),
    [
        (-701.0, 2e3, ("Out of range for linear: a mean contact force of -701 loads", "of its length")),
        (1.0, 0.05, ("Doubtful for linear: a beam displaced by 5 % of its length",)),
        (1.7, 0.0, ("Doubtful for linear: a mean contact force of 1.7 loads",)),
        (1.01, 0.01, ()),
    ],
)
def test_a_motion_that_cannot_be_is_no_verdict_without_a_doubt(force, moved, words):
    """A linear contact may pull: a mean of -701 loads, and a beam of 1 m that moves by 2 km."""
    run = motion(moved, 0.0, force * 5.0)
    run.in_contact, run.flights = np.zeros((1, 2), dtype=bool), [([0.0], [1.0])]
    check_doubts(run, Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=500.0), words)
    assert _contact(run, "ball") == "The ball loses contact 1 time, 100 % of the time"


def test_what_is_moved_too_far_is_doubted_over_rails_and_structures_and_on_a_plane():
    """A rail by 6 % of its bow (4 B/s)^(1/4), a structure by half its length, a ball thrown far."""
    track = Track.named("uic60")
    bow = (4.0 * track.bending_stiffness * track.sleeper_spacing / track.support.static) ** 0.25
    places = np.linspace(0.0, 2.0, 21)
    guide = ModalStructure(places, [100.0], 0.01, np.ones((21, 1)), modal_masses=[20.0])
    rail = RailBetween(MovingKernel(track, 50.0, 1e-4, np.ones((2, 8))), {})
    for over, moved, apart, words in (
        (rail, 0.06 * bow, 0.0, ["Doubtful", "a rail displaced by 6 % of its bow under a load"]),
        (guide, -1.0, 0.0, ["Out of range", "a structure displaced by 50 % of its length"]),
        (None, 0.0, -0.05, ["Doubtful", "surfaces apart by 200 % of the radius"]),
        (None, 0.0, 2e-3, ["Doubtful", "an approach of 8 % of the radius"]),
        (rail, 0.01 * bow, 1e-4, []),
    ):
        check_doubts(motion(moved, apart, 5.0), over, words)


def motion(moved, apart, force):
    """A run in which what is rolled over moves so far, m, and surfaces apart, m, under a force, N."""
    return SimpleNamespace(
        energy=SimpleNamespace(residual=0.0),
        body=np.zeros(1, dtype=int),
        over_displacement=np.array([[moved]]),
        relative_displacement=np.array([[0.0, apart]]),
        contact_force=np.full((1, 2), force),
        softening=np.zeros(1),
    )


def check_doubts(run, over, words):
    """What is doubted of a ball's run over something, of 5 N, and nothing where there are no words."""
    computed = SimpleNamespace(runs={"linear": run}, scene=SimpleNamespace(loads=[5.0]), over=over)
    computed.stiffness, computed.case = 1e6, small_cases.changed("ball-on-beam")
    told = "; ".join(_doubts(computed, list(_of_motion(computed))))
    assert all(each in told for each in words), told
    assert bool(told) is bool(words)


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_contacts_that_are_softened_for_the_time_step_are_doubted_by_the_verdict_and_foreseen():
    """A contact that may open is softened so that impacts return their energy; a fine step asks for none."""
    case = as_case(SHORT | {"laws": ["hertz"], "duration": "50 ms", "settling": "0 s", "speed": "1.2 m/s"})
    coarse, fine = (
        case.with_(numerics={"highest_frequency": highest, "kernel": "scatter", "time_step": step})
        for highest, step in (("300 Hz", "280 us"), ("1 kHz", "50 us"))
    )
    told = " ".join(each["message"] for each in planned(prepare_case(coarse))["warnings"])
    assert re.search(
        "the contact resonance on a bay of rail, .* time steps in a period, fewer than 5", told
    ), told
    told = " ".join(each["message"] for each in planned(prepare_case(fine))["warnings"])
    assert "contact resonance" not in told
    tree = asperity.run(coarse, brief=True)
    lead = r"Out of range for hertz: .*contacts softened by \d+ % for the time step"
    assert re.match(lead, tree.attrs["verdict"]), tree.attrs["verdict"]
    row = validity(tree)["softening of contacts by the time step, hertz"]
    assert (row["grade"], row["remedy"]) == ("out of range", "Take a smaller numerics.time_step.")


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_a_beam_that_moves_by_hundreds_of_metres_is_doubted_by_check_verdict_and_page(tmp_path):
    """It yields on its suspension by 5 N/(3.9 kg (2π 10 mHz)²), 322 m, and 12 · 0.2² of that as it tilts."""
    case = as_case(
        {
            "kind": "ball-on-beam",
            "laws": ["linear"],
            "start": "0.3 m",
            "duration": "0.1 s",
            "settling": "0 s",
            "surface": {"spectrum": "iso3095"},
            "ball": {"load": "5 N"},
            "beam": {"support": "free", "suspension_frequency": "10 mHz"},
            "numerics": {"highest_frequency": "1 kHz"},
        }
    )
    told = [each["message"] for each in planned(prepare_case(case))["warnings"]]
    (bent,) = [message for message in told if "displaced by up to" in message]
    mass = 1.0 * 0.05 * 0.01 * STEEL.density
    static = 5.0 / mass / (2.0 * np.pi * 0.01) ** 2 * (1.0 + 12.0 * 0.2**2)
    assert float(re.search(r"up to (\d+) m", bent)[1]) == pytest.approx(static, rel=0.01)
    (tmp_path / "case.toml").write_text(case.to_toml())
    said = call("run", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out"))  # done: exit code 0
    lead = r"Out of range for linear: a mean contact force of [-−]\d+ loads, a beam displaced by \d+ % of its"
    assert re.search(lead, " ".join(said.stdout.split()))
    force = asperity.open_result(tmp_path / "out")["rolling/contact_force"]
    assert float(force.mean()) < -100.0 * 5.0
    page = (tmp_path / "out/report.html").read_text().replace("\u00a0", " ")
    assert re.search(lead, page)
    assert not re.search(r">\s*Valid\s*<", page)
