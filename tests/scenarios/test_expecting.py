"""What is expected of a run before it starts: its scans as they are, and every part of its time once."""

import numpy as np
import pytest

from asperity.errors import CaseError, InputError
from asperity.kinds.ball_on_beam import plan as ball_plan
from asperity.kinds.ball_on_beam.compute import compute
from asperity.kinds.bodies import plan as bodies_plan
from asperity.kinds.cases import parse_case
from asperity.kinds.wheel_on_rail import plan as rail_plan
from asperity.kinds.wheel_on_rail.plan import step_seconds
from asperity.running import prepare_case
from asperity.scenarios import expecting
from asperity.scenarios.expecting import expect, expected_path_scan
from asperity.scenarios.scan_sizes import scan_sizes
from asperity.scenarios.trial import ContactTrial, try_contacts
from asperity.scenarios.trial_track import TrackTrial, try_track
from asperity.store import Store
from asperity.structures.moving_kernel import moving_kernel

pytestmark = pytest.mark.usefixtures("own_cache")

CASE = """
kind = "ball-on-beam"
duration = "8 ms"
settling = "0 s"
laws = ["table"]
[surface]
rms = "0.05 um"
longest = "0.4 mm"
shortest = "40 um"
[contact]
spacing = "{spacing}"
window = "0.5 mm"
samples = 2
"""
RAIL = """
kind = "wheel-on-rail"
laws = ["areal", "linear"]
duration = "{duration}"
settling = "20 ms"
[surface]
spectrum = "iso3095"
[wheel]
roughness = "disc"
[contact]
spacing = "1 mm"
samples = 2
sample_length = "60 mm"
[numerics]
highest_frequency = "4 kHz"
"""


def quiet(done, total, message):
    """A progress that nobody sees."""


@pytest.mark.filterwarnings("ignore:the record starts 0 ms")
@pytest.mark.parametrize("spacing", ["10 um", "6 um"])
def test_size_on_disk_and_number_of_positions(spacing):
    """At 6 µm, an eighth of the patch is two rows."""
    prepared = prepare_case(parse_case(CASE.format(spacing=spacing)))
    expected = scan_sizes(prepared.case, prepared.shape, prepared.textures)["path"]
    scanned = compute(prepared, quiet).chain.scan
    states, positions = scanned.forces.shape
    assert (states, positions) == (expected.states, expected.positions)
    assert expected.single == scanned.single
    files = [Store().path(key) for key in scanned.forces.keys]
    assert sum(file.stat().st_size for file in files) == pytest.approx(expected.bytes, rel=0.05)
    assert 0 < scanned.counts.solved <= expected.solutions


def test_the_states_that_are_tried_are_much_like_those_of_the_run():
    prepared = prepare_case(parse_case(CASE.format(spacing="10 um")))
    tried = try_contacts(prepared, quiet)
    reduction = compute(prepared, quiet).chain.reduction
    reach = np.ptp(reduction.approaches)
    np.testing.assert_allclose(tried.approaches, reduction.approaches, atol=0.1 * reach)
    assert abs(tried.loaded - len(reduction.filters["tangent"].contact_filter.approaches)) <= 1
    for seconds in (tried.load, tried.curve, tried.filters, tried.path, tried.touch, tried.average):
        assert seconds > 0.0


@pytest.fixture
def tried(monkeypatch):
    """Trials with known times, on one thread of the reference."""
    monkeypatch.setenv("ASPERITY_THREADS", "1")
    monkeypatch.setattr(expecting, "_pace", lambda: 1.0)
    for plan in (ball_plan, rail_plan):
        monkeypatch.setattr(plan, "step_seconds", lambda prepared: 1e-6)
    contacts = ContactTrial(np.linspace(0, 1e-6, 14), 12, 3.0, 5.0, 0.01, 0.02, 0.03, 7e-4, 1e-5, 1e-6)
    monkeypatch.setattr(expecting, "try_contacts", lambda prepared, progress: contacts)
    for plan in (rail_plan, bodies_plan):
        monkeypatch.setattr(plan, "try_track", lambda *_: TrackTrial(0.12, 11.0, 7.0))


@pytest.mark.usefixtures("tried")
def test_every_part_of_the_work_counts_once():
    text = CASE.format(spacing="10 um").replace('"table"', '"table", "direct", "areal"')
    prepared = prepare_case(parse_case(text))
    work = expect(prepared, quiet)
    assert work.total == pytest.approx(sum(work.seconds.values()))
    scans, seconds = work.scans, work.seconds
    assert seconds["scanning for the path"] == pytest.approx(0.02 * scans["path"].positions)
    assert seconds["scanning for the filters"] == pytest.approx(0.01 * scans["filters"].positions)
    assert seconds["pressing the samples"] == pytest.approx(2 * (3.0 + 5.0))
    steps = round(8e-3 / prepared.case.time_step)
    assert seconds["direct"] == pytest.approx(steps * 7e-4)
    rows, strips = prepared.textures.path.shape[0], sum(s.shape[0] for s in prepared.textures.strips)
    under_the_patch = (rows + strips) * 1e-5 + rows * (1 + 14) * 1e-6
    assert seconds["averaging under the patch"] == pytest.approx(under_the_patch)
    assert {"textures", "rolling", "spectra and statistics", "report"} < set(seconds)
    assert expected_path_scan(prepared, quiet) == scans["path"]


@pytest.mark.usefixtures("tried")
def test_kernel_and_passed_points_are_part_of_the_work():
    prepared = prepare_case(parse_case(RAIL.format(duration="40 ms")))
    work, case = expect(prepared, quiet), prepared.case
    assert work.seconds["moving kernel"] == 11.0
    assert work.seconds["poles"] > 0.0
    first, last = case.rolled_range
    convolved = (last - first) / 0.6 * len(case.laws) * 0.12 / case.time_step  # forces of each bay, with lags
    assert work.seconds["passed points"] == pytest.approx(2e-7 * convolved)


@pytest.mark.usefixtures("tried")
def test_rails_between_contacts_are_part_of_the_work():
    """Four contacts at 0, 2.5, 18 and 20.5 m are 2.5, 15.5, 18 and 20.5 m apart, ahead and behind."""
    text = """
    kind = "bodies"
    over = "track"
    speed = "30 m/s"
    laws = ["linear"]
    duration = "50 ms"
    [surface]
    spectrum = "iso3095"
    [body]
    type = "bogie"
    positions = ["0 m", "18 m"]
    radius = "0.46 m"
    mass = "600 kg"
    masses = ["3 t"]
    springs = ["1.2 MN/m"]
    distance = "2.5 m"
    """
    seconds = expect(prepare_case(parse_case(text)), quiet).seconds
    poles = seconds["moving kernel"] - 11.0
    assert poles > 0.0
    assert seconds["rail between contacts"] == pytest.approx(2 * 4 * (7.0 + poles))


@pytest.mark.usefixtures("tried")
def test_threads_share_scans_and_kernel(monkeypatch):
    text = CASE.format(spacing="10 um").replace("8 ms", "80 ms").replace("samples = 2", "samples = 4")
    one = expect(prepare_case(parse_case(text)), quiet).seconds
    monkeypatch.setenv("ASPERITY_THREADS", "4")
    four = expect(prepare_case(parse_case(text)), quiet).seconds
    for name in ("scanning for the path", "scanning for the filters"):
        assert four[name] == pytest.approx(one[name] / 4)
    assert four["pressing the samples"] == pytest.approx(4 * 3.0 + 5.0)


SOFT = """
[track]
pad_damping = "28 kN s/m"
ballast_damping = "28 kN s/m"
rail_loss_factor = 0.001
[contact]"""


@pytest.mark.parametrize("track", ["[contact]", SOFT])
def test_the_length_of_a_kernel_is_found_before_it_is_computed(track):
    """Kernels grow from 0.12 s until they have died away: the less they are damped, the longer."""
    prepared = prepare_case(parse_case(RAIL.replace("[contact]", track).format(duration="40 ms")))
    case = prepared.case
    tried = try_track(case.track_model(), case.speed, case.time_step, quiet)
    kernel = moving_kernel(prepared.case.track_model(), prepared.case.speed, prepared.case.time_step)
    assert tried.length == pytest.approx(kernel.lag[-1], rel=0.02)
    assert (tried.length > 0.15) == (track == SOFT)
    assert tried.kernel > 0.0


@pytest.mark.parametrize("kernel", ["poles", "scatter"])
def test_rolling_is_tried_on_the_rail_of_the_case(kernel):
    text = RAIL.format(duration="40 ms") + f'kernel = "{kernel}"\n'
    assert step_seconds(prepare_case(parse_case(text))) > 0.0


def test_all_errors_come_at_once_and_a_single_one_as_it_is(monkeypatch):
    with pytest.raises(InputError, match=r"contact\.window: received 510 um") as single:
        prepare_case(parse_case(CASE.format(spacing="10 um") + '[ball]\nload = "20 kN"\n'))
    assert not isinstance(single.value, CaseError)
    monkeypatch.setenv("ASPERITY_THREADS", "no")
    monkeypatch.setenv("ASPERITY_DEVICE", "abacus")
    with pytest.raises(CaseError, match=r"2 errors\n.*\$ASPERITY_THREADS: .*\n.*\$ASPERITY_DEVICE: "):
        prepare_case(parse_case(CASE.format(spacing="10 um")))
