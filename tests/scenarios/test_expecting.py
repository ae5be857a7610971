"""What is expected of a run before it starts: its scans as they are, contacts and steps by number."""

import numpy as np
import pytest

from asperity.case.cases import parse_case
from asperity.errors import CaseError, InputError
from asperity.running import prepare_case
from asperity.scenarios.expecting import expect, scan_sizes, try_contacts
from asperity.scenes.compute import compute
from asperity.store import Store

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


def quiet(done, total, message):
    """A progress that nobody sees."""


@pytest.mark.filterwarnings("ignore:the record starts 0 ms")
@pytest.mark.parametrize("spacing", ["10 um", "6 um"])
def test_size_on_disk_and_number_of_positions(spacing):
    """At 6 µm, an eighth of the patch is two rows."""
    prepared = prepare_case(parse_case(CASE.format(spacing=spacing)))
    expected = scan_sizes(prepared.case, prepared.shape, prepared.textures)["path"]
    scanned = compute(prepared, quiet).scan
    states, positions = scanned.forces.shape
    assert (states, positions) == (expected.states, expected.positions)
    assert expected.single == scanned.single
    files = [Store().path(key) for key in scanned.forces.keys]
    assert sum(file.stat().st_size for file in files) == pytest.approx(expected.bytes, rel=0.05)
    assert 0 < scanned.counts.solved <= expected.solutions


def test_the_states_that_are_tried_are_much_like_those_of_the_run():
    prepared = prepare_case(parse_case(CASE.format(spacing="10 um")))
    tried = try_contacts(prepared.case, prepared.shape, prepared.textures, quiet)
    reduction = compute(prepared, quiet).reduction
    reach = np.ptp(reduction.approaches)
    np.testing.assert_allclose(tried.approaches, reduction.approaches, atol=0.1 * reach)
    assert tried.working == pytest.approx(reduction.ensemble.curve.inverse(prepared.shape.load), rel=0.1)
    assert tried.solution > 0.0


def test_contacts_and_steps_are_counted():
    text = CASE.format(spacing="10 um").replace('"table"', '"table", "direct", "areal"')
    prepared = prepare_case(parse_case(text))
    work = expect(prepared, quiet)
    steps = round(8e-3 / prepared.case.time_step)
    assert work.steps == steps
    scans = {f"scan for the {name}": scan.positions * scan.states for name, scan in work.scans.items()}
    assert set(work.scans) == {"filters", "path"}
    assert work.solutions == scans | {"direct": steps}
    least = 0.4 * work.tried.solution * (sum(scans.values()) / 64 + steps)
    assert least < work.seconds < np.inf


def test_every_contact_of_bodies_counts():
    """Two bogies have four contacts; nothing is solved where a law needs no samples."""
    text = """
    kind = "bodies"
    over = "plane"
    laws = ["linear"]
    duration = "50 ms"
    [surface]
    spectrum = "iso3095"
    level = "-40 dB"
    [body]
    load = "50 N"
    positions = ["0 m", "18 m"]
    """
    work = expect(prepare_case(parse_case(text)), quiet)
    assert (work.solutions, work.tried) == ({}, None)
    assert work.seconds == pytest.approx(2.0 + 2e-6 * work.steps, abs=1.0)


def test_all_errors_come_at_once_and_a_single_one_as_it_is(monkeypatch):
    with pytest.raises(InputError, match=r"contact\.window: received 510 um") as single:
        prepare_case(parse_case(CASE.format(spacing="10 um") + '[ball]\nload = "20 kN"\n'))
    assert not isinstance(single.value, CaseError)
    monkeypatch.setenv("ASPERITY_THREADS", "no")
    monkeypatch.setenv("ASPERITY_DEVICE", "abacus")
    with pytest.raises(CaseError, match=r"2 errors\n.*\$ASPERITY_THREADS: .*\n.*\$ASPERITY_DEVICE: "):
        prepare_case(parse_case(CASE.format(spacing="10 um")))
