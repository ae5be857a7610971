"""Tables of studies: each member at its place, gaps and warnings told, digits that depend on no executor."""

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import xarray
from executors import BALL, Here

import asperity
from asperity.case.cases import parse_case
from asperity.errors import ComputationError
from asperity.laws import Role
from asperity.running import run
from asperity.schema.spectra import FORCE_LEVEL_DIFFERENCES
from asperity.store import Store
from asperity.studies import member, running
from asperity.studies.member import _weighted, _weighted_name
from asperity.studies.words import table_in_words

SWEEP = {"speed": ["0.5 m/s", "1 m/s"], "seed": [1, 2, 3]}


def computed(sweep, executor=None, **options):
    return asperity.study("ball.toml", sweep, executor=executor or Here(), **options)


@pytest.fixture
def failing(monkeypatch):
    """Let members of some seeds fail; returns the seeds that were computed."""
    seeds = []

    def fails(case, **options):
        seeds.append(case.seed)
        if case.seed == 2:
            raise ComputationError(f"at {case.speed} m/s it failed", "another one")
        if case.seed == 3:
            raise ZeroDivisionError("by nothing")
        return run(case, **options)

    monkeypatch.setattr("asperity.running.run", fails)
    return seeds


def test_each_member_stands_at_its_place():
    table = computed(SWEEP)
    assert table["force_level"].dims == ("speed", "seed", "law", "band")
    assert table["acceleration_level"].dims == ("speed", "seed", "law", "sensor", "band")
    assert table["completed"].all()
    text = BALL.replace("laws", 'seed = 3\nspeed = "0.5 m/s"\nlaws')
    one, found = run(parse_case(text)), table.sel(speed=0.5, seed=3)
    level = found["force_level"].dropna("band")
    np.testing.assert_array_equal(level, one["spectra/force_level"].sel(band=level.band))
    force = one["rolling/contact_force"][:, 0]
    np.testing.assert_array_equal(found["mean_force"], force.mean("time"))
    np.testing.assert_array_equal(found["contact_loss_share"], one["rolling/contact_loss_share"][:, 0])
    np.testing.assert_array_equal(found["sensor_position"], one["rolling/sensor"])
    assert table["speed"].attrs == {"units": "m/s", "long_name": "rolling speed"}
    for values in table.variables.values():
        assert {"units", "long_name"} <= values.attrs.keys()
    assert json.loads(table.attrs["sweep"]) == SWEEP
    assert parse_case(table.attrs["case"]) == parse_case(BALL)


def test_laws_and_words_may_be_swept():
    table = computed({"laws": [["hertz"], ["linear"]], "beam.support": ["free", "clamped"]})
    assert table["laws"].values.tolist() == ["hertz", "linear"]
    assert table["beam.support"].values.tolist() == ["free", "clamped"]
    assert np.isnan(table["mean_force"].sel(laws="hertz", law="linear")).all()
    assert np.isfinite(table["mean_force"].sel(laws="linear", law="linear")).all()


def test_failed_members_leave_gaps_are_grouped_and_tried_again(failing):
    table = computed(SWEEP)
    assert failing == [1, 2, 3, 1, 2, 3]
    assert table["completed"].values.tolist() == [[1, 0, 0], [1, 0, 0]]
    assert np.isnan(table["force_level"].sel(seed=[2, 3])).all()
    assert np.isfinite(table["mean_force"].sel(seed=1)).all()
    first, second = json.loads(table.attrs["failures"])
    assert first == {
        "error": "ComputationError",
        "message": "at 0.5 m/s it failed. Try: another one.",
        "members": ["speed = 0.5 m/s, seed = 2", "speed = 1 m/s, seed = 2"],
    }
    assert second["message"] == "ZeroDivisionError: by nothing"
    del failing[:]
    calls = []
    computed(SWEEP, progress=lambda *call: calls.append(call))
    assert failing == [2, 3, 2, 3]
    assert calls[0] == (2, 6, "study of 6 members")
    assert calls[-1] == (6, 6, "study of 6 members")
    with pytest.raises(ComputationError, match=r"the only member failed, the first one so: at 1\.0 m/s it"):
        computed({"seed": [2]})
    with pytest.raises(ComputationError, match=r"all 2 members failed, the first one so: at 1\.0 m/s it"):
        computed({"seed": [2], "start": ["0.99 m", "0 m"]})  # one that cannot be a case is no reason


def test_values_that_do_not_fit_together_fail_alone():
    table = computed({"start": ["0 m", "0.99 m"]})
    assert table["completed"].values.tolist() == [1, 0]
    (failure,) = json.loads(table.attrs["failures"])
    assert failure["error"] == "CaseError"
    assert "duration: received 0.02 s, which ends at 1.01 m" in failure["message"]


def test_warnings_are_counted_by_member(monkeypatch):
    def warns(case, **options):
        tree = run(case, **options)
        met = [{"category": "Coarse", "message": f"{0.1 * case.seed} mm is coarse", "count": 7}]
        tree.attrs["warnings"] = json.dumps(met if case.seed < 3 else [])
        return tree

    monkeypatch.setattr("asperity.running.run", warns)
    expected = [{"category": "Coarse", "message": "0.1 mm is coarse", "members": 2}]
    assert json.loads(computed({"seed": [1, 2, 3]}).attrs["warnings"]) == expected


@pytest.mark.long
def test_digits_depend_on_no_executor(monkeypatch):
    """Processes, threads and this process write the same file; who computes elsewhere keeps it here, too."""

    class Elsewhere(Here):
        def submit(self, *arguments):
            with pytest.MonkeyPatch.context() as patch:
                patch.setenv("ASPERITY_CACHE", "elsewhere")
                return super().submit(*arguments)

    sweep, unused = {"seed": [1, 2, 3]}, Here()
    first = computed(sweep, Elsewhere())
    assert len(Store("elsewhere").files()) == 3
    xarray.testing.assert_identical(first, computed(sweep, unused))
    assert unused.count == 0
    monkeypatch.setenv("ASPERITY_CACHE", "threads")
    with ThreadPoolExecutor(3) as threads:
        xarray.testing.assert_identical(first, computed(sweep, threads))
    monkeypatch.setenv("ASPERITY_CACHE", "processes")
    xarray.testing.assert_identical(first, asperity.study("ball.toml", sweep, workers=2))


def test_a_member_that_an_executor_loses_fails_alone():
    table = computed({"seed": [4, 5]}, Here(lost=lambda count: count != 1))
    assert table["completed"].values.tolist() == [1, 0]
    assert json.loads(table.attrs["failures"])[0]["message"] == "BrokenPipeError: worker lost"


def test_an_executor_that_is_shut_down():
    executor = ProcessPoolExecutor(1)
    executor.shutdown()
    with pytest.raises(ComputationError, match=r"takes no more members \(.*same study again"):
        computed(SWEEP, executor)


def ends_with_seed_2(key, case):
    """Compute a member, unless it is the one that ends its process."""
    if case.seed == 2:
        os._exit(9)
    return member.compute_member(key, case)


@pytest.mark.long
def test_a_member_that_ends_its_process_fails_alone(monkeypatch):
    monkeypatch.setattr(running, "compute_member", ends_with_seed_2)
    table = asperity.study("ball.toml", {"seed": [1, 2, 3]}, workers=2)
    assert table["completed"].values.tolist() == [1, 0, 1]
    assert json.loads(table.attrs["failures"])[0]["error"] == "ProcessEnded"
    assert "fewer workers" in member.Failure.of(MemoryError()).message


def started(script, *words):
    """A program that starts processes, in a group of its own."""
    Path("script.py").write_text(script)
    pipe = subprocess.PIPE
    program = [sys.executable, "script.py", *words]
    return subprocess.Popen(program, stdout=pipe, stderr=pipe, text=True, process_group=0)


@pytest.mark.long
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT], ids=["killed", "interrupted"])
def test_a_study_that_is_ended_goes_on_and_leaves_no_process(end):
    seeds = {"seed": list(range(12))}
    Path("study.toml").write_text(f'case = "ball.toml"\n[sweep]\nseed = {seeds["seed"]}\n')
    main = "from asperity.cli import main\nif __name__ == '__main__':\n    main()\n"
    with started(main, "study", "study.toml", "--workers", "1") as program:
        while not list(Path("cache").glob("member-*.npz")):
            time.sleep(0.05)
        if end == signal.SIGKILL:
            program.kill()
        else:
            os.killpg(program.pid, end)  # as a terminal does
        said = program.stderr.read()  # to its end: when the last process that may write to it has ended
    if end == signal.SIGINT:
        assert program.returncode == 130
        assert "run the same command again to continue" in said
        assert "Traceback" not in said
    done, rest = len(list(Path("cache").glob("member-*.npz"))), Here()
    assert 1 <= done < 12
    assert computed(seeds, rest)["completed"].all()
    assert rest.count == 12 - done


AT_WORK = """
import time
from asperity.studies.running import _pool
if __name__ == "__main__":
    with _pool(1) as pool:
        pool.submit(int).result()
        pool.submit(time.sleep, 600)
        print("at work", flush=True)
        time.sleep(600)
"""


def test_processes_end_at_once_with_the_one_that_started_them():
    with started(AT_WORK) as program:
        assert program.stdout.readline() == "at work\n"
        program.kill()
        program.communicate(timeout=60)  # until the last process that may write has ended


def test_differences_of_totals_are_over_the_bands_that_both_laws_have():
    """A band that one law lacks is in neither total: here that of 80 dB at 1 kHz."""
    band = xarray.DataArray([500.0, 1000.0, 2000.0], dims="band")
    levels = [[50.0, 80.0, 30.0], [44.0, np.nan, 24.0]]
    at = {"law": ["linear", "areal"], "band": band.values}
    attrs = {"units": "dB re 1 N", "long_name": ""}
    force = xarray.DataArray(levels, dims=("law", "band"), coords=at, attrs=attrs)
    entry = FORCE_LEVEL_DIFFERENCES[Role.BARE]
    difference = (force - force.sel(law="linear")).assign_attrs(units="dB", long_name="", reference="linear")
    found = _weighted({"force_level": force, entry.name: difference})
    assert float(found[_weighted_name(entry)].sel(law="areal")) == pytest.approx(-6.0)


@pytest.mark.parametrize(
    ("heading", "value", "head", "written"),
    [
        ("force_level_a [dB(A) re 1 N]", 1.9364, "force level, A-weighted [dB(A) re 1 N]", "1.9"),
        ("force_a_difference_to_linear [dB]", -18.0, "force, A-weighted, over linear [dB]", "−18.0"),
        ("power_a total [dB(A) re 1 pW]", -0.02, "power, A-weighted total [dB(A) re 1 pW]", "0.0"),
        ("level [dB re 1e-6 m/s2]", float("nan"), "level [dB re 1 µm/s²]", "–"),
        ("contact_loss_share [1]", 0.01234, "contact loss share [%]", "1.234"),
        ("contact_loss_events [1]", 12.0, "contact loss events", "12"),
        ("track_rms [m]", 3.2e-8, "track rms [nm]", "32"),
        ("peak_force [N]", 123456.0, "peak force [kN]", "123.5"),
        ("largest_growth [1/s]", 1234.0, "largest growth [1/s]", "1234"),
        ("longest_loss [s]", 0.0, "longest loss [s]", "0"),
    ],
)  # fmt: skip
def test_the_tables_of_a_study_have_names_units_that_are_read_and_the_levels_of_the_headline(
    heading, value, head, written
):
    """The headline said 1.9 dB(A), the table 1.936 below "force level a"."""
    key = "ball.sample_load [km/h]"
    assert table_in_words([key, heading], [[85.7232, value]], 1) == ([key, head], [["85.72", written]])


def test_numbers_of_a_column_have_one_unit_and_their_scatter_has_it_too():
    heads, cells = table_in_words(
        ["law", "rms [m]"], [["a", 2e-6], ["b", 3e-8]], 1, [["a", 1e-7], ["b", np.nan]]
    )
    assert heads == ["law", "rms [µm]"]
    assert cells == [["a", "2 ± 0.1"], ["b", "0.03"]]
