"""Studies: what they are made of, what they keep, and that the digits depend on nothing but the case."""

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import numpy as np
import pytest
import xarray

import asperity
from asperity.case.cases import load_case, parse_case
from asperity.errors import CaseError, ComputationError, InputError
from asperity.laws import Role
from asperity.running import run
from asperity.schema.spectra import FORCE_LEVEL_DIFFERENCES
from asperity.store import Store
from asperity.studies import member, running
from asperity.studies.definition import TEMPLATE, load_study, study_of
from asperity.studies.member import _weighted, _weighted_name

BALL = """
kind = "ball-on-beam"
duration = "0.02 s"
laws = ["hertz", "linear"]
[surface]
spectrum = "iso3095"
"""
SWEEP = {"speed": ["0.5 m/s", "1 m/s"], "seed": [1, 2, 3]}


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    Path("ball.toml").write_text(BALL)


class Here(Executor):
    """Computes at once, in this process; loses what `lost` says."""

    def __init__(self, lost=lambda count: False):
        self.count, self.lost = 0, lost

    def submit(self, task, /, *arguments, **keywords):
        self.count += 1
        future = Future()
        if self.lost(self.count):
            future.set_exception(BrokenPipeError("worker lost"))
        else:
            future.set_result(task(*arguments, **keywords))
        return future


@pytest.fixture
def failing(monkeypatch):
    """Let members of some seeds fail; returns the seeds that were computed."""
    computed = []

    def fails(case, **options):
        computed.append(case.seed)
        if case.seed == 2:
            raise ComputationError(f"at {case.speed} m/s it failed", "another one")
        if case.seed == 3:
            raise ZeroDivisionError("by nothing")
        return run(case, **options)

    monkeypatch.setattr("asperity.running.run", fails)
    return computed


class TestDefinition:
    def test_the_template_is_a_study(self):
        Path("case.toml").write_text(BALL)
        Path("study.toml").write_text(TEMPLATE)
        assert load_study("study.toml").sweep == {"speed": ["20 m/s", "56 m/s"], "seed": [1, 2, 3]}

    @pytest.mark.parametrize(
        "written", ['"ball.load" = ["5 N"]', 'ball.load = ["5 N"]', '[sweep.ball]\nload = ["5 N"]']
    )
    def test_a_key_with_its_section_is_written_in_three_ways(self, written):
        Path("study.toml").write_text(f'case = "ball.toml"\n[sweep]\n{written}\n')
        found = load_study("study.toml")
        assert found.sweep == {"ball.load": ["5 N"]}
        assert found.members()[0].case.ball.load == 5.0

    def test_the_case_may_stand_in_the_study_and_need_its_swept_keys(self):
        base = 'case.kind = "ball-on-beam"\ncase.surface.hurst = 0.7\n'
        Path("study.toml").write_text(f'{base}[sweep]\n"surface.rms" = ["0.1 um", "0.2 um"]\n')
        assert [m.case.surface.rms for m in load_study("study.toml").members()] == [1e-7, 2e-7]

    def test_files_are_found_from_the_case(self, monkeypatch):
        Path("deep").mkdir()
        np.savetxt("deep/line.txt", np.zeros(9))
        Path("deep/case.toml").write_text(BALL.replace('spectrum = "iso3095"', 'line = "line.txt"'))
        Path("study.toml").write_text('case = "deep/case.toml"\n[sweep]\nseed = [1]\n')
        found = load_study("study.toml")
        first = found.members()[0]
        assert first.case.surface.line.is_absolute()
        np.savetxt("deep/line.txt", np.ones(9))
        assert found.members()[0].key != first.key  # by what a file holds

    def test_keys_name_all_that_a_result_depends_on(self):
        sweep = {"speed": ["1 m/s", "2 m/s"]}
        keys = [m.key for m in study_of("ball.toml", sweep).members()]
        assert len(set(keys)) == 2
        written_otherwise = study_of(parse_case(f"# again\n{BALL}"), {"speed": ["1000 mm/s"]}).members()
        assert written_otherwise[0].key == keys[0]

    @pytest.mark.parametrize(
        ("sweep", "message"),
        [
            ("", "sweep: received nothing; allowed: a key with its values"),
            ("speeds = ['1 m/s']", 'sweep.speeds: received an unknown key.*Did you mean "speed"'),
            ("load = ['1 N']", 'sweep.load: received an unknown key.*Write it with its section, "ball.load"'),
            ("speed = []", "sweep.speed: received an empty list; allowed: one value or more"),
            ("speed = '1 m/s'", r"sweep.speed: received '1 m/s'; allowed: a list of values"),
            ("speed = ['1 m/s', '1 kg']", r"sweep.speed\[2\]: received '1 kg'; allowed: a speed"),
            ("speed = [1.0]", r"sweep.speed\[1\]: received 1.0; allowed: a speed.*Add unit"),
            ("speed = ['1 m/s', '1000 mm/s']", "sweep.speed: received '1000 mm/s' more than once"),
            ("seed = [1.5]", r"sweep.seed\[1\]: received 1.5; allowed: a whole number"),
            ("laws = ['hertz']", r"sweep.laws\[1\]: received 'hertz'; allowed: a list, each"),
            ("laws = [['hertzz']]", r'sweep.laws\[1\]: received \'hertzz\'; .*Did you mean "hertz"'),
            ("beam.support = ['nailed']", r"sweep.beam.support\[1\]: received 'nailed'"),
            ("kind = ['ball-on-beam']", "kind: received a swept key"),
            ("seed = [1]\n[[sweep.deep]]", "sweep.deep: received an unknown key"),
        ],
    )
    def test_wrong_values_are_explained(self, sweep, message):
        Path("study.toml").write_text(f'case = "ball.toml"\n[sweep]\n{sweep}\n')
        with pytest.raises(CaseError, match=message):
            load_study("study.toml")

    def test_all_errors_come_at_once(self):
        with pytest.raises(CaseError, match="study: 2 errors"):
            study_of("ball.toml", {"speeds": ["1 m/s"], "seed": []})

    def test_too_many_members(self):
        with pytest.raises(CaseError, match="200 × 100 = 20000 members; allowed: at most 10000"):
            study_of("ball.toml", {"seed": list(range(200)), "speed": [f"{n} m/s" for n in range(1, 101)]})

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("", "study.toml: received an empty file"),
            ("# nothing", "case: received nothing; allowed: the path of a case"),
            ("case = 3", "case: received 3; allowed: the path of a case"),
            ("case = 'a.toml'\nwhat = 1", "what: received an unknown key; allowed: case and"),
            ("case = 'absent.toml'\n[sweep]\nseed = [1]", "absent.toml: received no such file"),
            ("case = [", "a study in TOML"),
            ("case.kind = 'cube'\n[sweep]\nseed = [1]", "kind: received 'cube'"),
            ("case.seed = 1\n[sweep]\nseed = [1]\nspeed = ['1 m/s']", "1 error\n.*kind: received nothing"),
        ],
    )
    def test_wrong_files_are_explained(self, text, message):
        Path("study.toml").write_text(text)
        with pytest.raises(InputError, match=message):
            load_study("study.toml")

    def test_no_valid_member(self):
        Path("study.toml").write_text('case = "ball.toml"\n[sweep]\nstart = ["2 m", "3 m"]\n')
        with pytest.raises(CaseError, match="start: received 2 m; allowed: a position on the beam"):
            asperity.study("study.toml")


class TestTable:
    def test_each_member_stands_at_its_place(self):
        table = asperity.study("ball.toml", SWEEP, executor=Here())
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

    def test_laws_and_words_may_be_swept(self):
        sweep = {"laws": [["hertz"], ["linear"]], "beam.support": ["free", "clamped"]}
        table = asperity.study("ball.toml", sweep, executor=Here())
        assert table["laws"].values.tolist() == ["hertz", "linear"]
        assert table["beam.support"].values.tolist() == ["free", "clamped"]
        assert np.isnan(table["mean_force"].sel(laws="hertz", law="linear")).all()
        assert np.isfinite(table["mean_force"].sel(laws="linear", law="linear")).all()

    def test_failed_members_are_grouped_and_leave_gaps(self, failing):
        table = asperity.study("ball.toml", SWEEP, executor=Here())
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

    def test_values_that_do_not_fit_together_fail_alone(self):
        table = asperity.study("ball.toml", {"start": ["0 m", "0.99 m"]}, executor=Here())
        assert table["completed"].values.tolist() == [1, 0]
        (failure,) = json.loads(table.attrs["failures"])
        assert failure["error"] == "CaseError"
        assert "duration: received 0.02 s, which ends at 1.01 m" in failure["message"]

    def test_all_members_fail(self, failing):
        with pytest.raises(
            ComputationError, match=r"all 1 members failed, the first one so: at 1\.0 m/s it failed"
        ):
            asperity.study("ball.toml", {"seed": [2]}, executor=Here())

    def test_warnings_are_counted_by_member(self, monkeypatch):
        def warns(case, **options):
            tree = run(case, **options)
            met = [{"category": "Coarse", "message": f"{0.1 * case.seed} mm is coarse", "count": 7}]
            tree.attrs["warnings"] = json.dumps(met if case.seed < 3 else [])
            return tree

        monkeypatch.setattr("asperity.running.run", warns)
        table = asperity.study("ball.toml", {"seed": [1, 2, 3]}, executor=Here())
        expected = [{"category": "Coarse", "message": "0.1 mm is coarse", "members": 2}]
        assert json.loads(table.attrs["warnings"]) == expected


class TestResuming:
    def test_finished_members_are_kept_and_failed_ones_tried_again(self, failing):
        asperity.study("ball.toml", SWEEP, executor=Here())
        assert failing == [1, 2, 3, 1, 2, 3]
        del failing[:]
        calls = []
        asperity.study("ball.toml", SWEEP, executor=Here(), progress=lambda *call: calls.append(call))
        assert failing == [2, 3, 2, 3]
        assert calls[0] == (2, 6, "study of 6 members")
        assert calls[-1] == (6, 6, "study of 6 members")

    def test_results_computed_elsewhere_are_kept_here(self, monkeypatch):
        class Elsewhere(Here):
            def submit(self, *arguments):
                with pytest.MonkeyPatch.context() as patch:
                    patch.setenv("ASPERITY_CACHE", "elsewhere")
                    return super().submit(*arguments)

        first = asperity.study("ball.toml", {"seed": [1]}, executor=Elsewhere())
        assert len(Store("elsewhere").files()) == 1
        unused = Here()
        again = asperity.study("ball.toml", {"seed": [1]}, executor=unused)
        assert unused.count == 0
        xarray.testing.assert_identical(first, again)

    def test_a_killed_study_goes_on(self):
        script = (
            "import asperity, sys\n"
            "if __name__ == '__main__':\n"
            "    report = lambda done, total, what: what.startswith('study') and print(done, flush=True)\n"
            f"    asperity.study('ball.toml', {SWEEP!r}, workers=1, progress=report)\n"
        )
        Path("script.py").write_text(script)
        with subprocess.Popen([sys.executable, "script.py"], stdout=subprocess.PIPE, text=True) as killed:
            for line in killed.stdout:
                if int(line) == 2:
                    break
            killed.kill()
        done = len(list(Path("cache").glob("member-*.npz")))
        assert 2 <= done < 6
        counter = Here()
        table = asperity.study("ball.toml", SWEEP, executor=counter)
        assert counter.count <= 6 - done
        assert table["completed"].all()


class TestExecutors:
    def test_digits_depend_on_no_executor(self, monkeypatch):
        """Processes, threads and this process, with other numbers of workers, write the same file."""
        found = []
        threads = ThreadPoolExecutor(3)
        ways = {"here": (Here(), None), "threads": (threads, None), "one": (None, 1), "two": (None, 2)}
        for name, (executor, workers) in ways.items():
            monkeypatch.setenv("ASPERITY_CACHE", name)
            found.append(asperity.study("ball.toml", SWEEP, executor=executor, workers=workers))
        threads.shutdown()
        for other in found[1:]:
            xarray.testing.assert_identical(found[0], other)

    def test_a_lost_member_is_given_again(self):
        sometimes = Here(lost=lambda count: count in (2, 3, 7))
        table = asperity.study("ball.toml", SWEEP, executor=sometimes)
        assert table["completed"].all()
        assert sometimes.count == 9

    def test_a_member_that_is_lost_each_time_fails(self):
        table = asperity.study("ball.toml", {"seed": [1, 2]}, executor=Here(lost=lambda count: count != 1))
        assert table["completed"].values.tolist() == [1, 0]
        assert json.loads(table.attrs["failures"])[0]["message"] == "BrokenPipeError: worker lost"

    def test_an_executor_that_is_shut_down(self):
        executor = ProcessPoolExecutor(1)
        executor.shutdown()
        with pytest.raises(ComputationError, match=r"takes no more members \(.*same study again"):
            asperity.study("ball.toml", SWEEP, executor=executor)

    def test_a_member_that_ends_its_process_fails_alone(self, monkeypatch):
        monkeypatch.setattr(running, "compute_member", ends_with_seed_2)
        table = asperity.study("ball.toml", {"seed": [1, 2, 3, 4]}, workers=2)
        assert table["completed"].values.tolist() == [1, 0, 1, 1]
        assert json.loads(table.attrs["failures"])[0]["error"] == "ProcessEnded"

    def test_processes_end_with_the_one_that_started_them(self):
        script = (
            "import os, time\n"
            "from asperity.studies.running import _pool\n"
            "if __name__ == '__main__':\n"
            "    with _pool(1) as pool:\n"
            "        print(pool.submit(os.getpid).result(), flush=True)\n"
            "        pool.submit(time.sleep, 600)\n"
            "        time.sleep(600)\n"
        )
        Path("script.py").write_text(script)
        with subprocess.Popen([sys.executable, "script.py"], stdout=subprocess.PIPE, text=True) as started:
            worker = int(started.stdout.readline())
            started.kill()
        assert ended(worker)

    def test_an_interrupt_keeps_what_is_finished_and_leaves_no_process(self):
        Path("study.toml").write_text(f'case = "ball.toml"\n[sweep]\nseed = {list(range(400))}\n')
        Path("script.py").write_text(
            "from asperity.cli import main\nif __name__ == '__main__':\n    main()\n"
        )
        program = [sys.executable, "script.py", "study", "study.toml", "--workers", "1"]
        with subprocess.Popen(program, stderr=subprocess.PIPE, text=True, process_group=0) as started:
            while not list(Path("cache").glob("member-*.npz")):
                time.sleep(0.1)
            os.killpg(started.pid, signal.SIGINT)  # as a terminal does
            said = started.stderr.read()  # to its end: when the last process that may write to it has ended
        assert started.returncode == 130
        assert "run the same command again to continue" in said
        assert "Traceback" not in said

    def test_workers_are_at_least_one(self):
        with pytest.raises(InputError, match="workers: received 0; allowed: a whole number greater than 0"):
            asperity.study("ball.toml", SWEEP, workers=0)


def ends_with_seed_2(key, case):
    """Compute a member, unless it is the one that ends its process."""
    if case.seed == 2:
        os._exit(9)
    return member.compute_member(key, case)


def ended(process, patience=20.0):
    """Whether a process ends within some time."""
    last = time.monotonic() + patience
    while time.monotonic() < last:
        try:
            os.kill(process, 0)
        except ProcessLookupError:
            return True
        state = Path(f"/proc/{process}/stat")
        if state.exists() and state.read_text().rpartition(")")[2].split()[0] == "Z":
            return True
        time.sleep(0.1)
    return False


@pytest.mark.parametrize("wrong", [(None, "nothing"), ({"seed": [1]}, "keys for a study that has its own")])
def test_a_study_needs_swept_keys_once(wrong):
    sweep, message = wrong
    definition = study_of("ball.toml", SWEEP) if sweep else load_case("ball.toml")
    with pytest.raises(InputError, match=f"sweep: received {message}"):
        asperity.study(definition, sweep)


def test_memory_that_is_too_small_is_a_failure_with_advice():
    assert "fewer workers" in member.Failure.of(MemoryError()).message


def test_a_broken_pool_is_named():
    assert "BrokenProcessPool" in member.Failure.of(BrokenProcessPool("x")).message


def test_differences_of_totals_are_over_the_bands_that_both_laws_have():
    """A band that one law lacks is in neither total: here that of 80 dB at 1 kHz."""
    band = xarray.DataArray([500.0, 1000.0, 2000.0], dims="band")
    levels = [[50.0, 40.0, 30.0], [44.0, np.nan, 24.0]]
    at = {"law": ["linear", "areal"], "band": band.values}
    force = xarray.DataArray(
        levels, dims=("law", "band"), coords=at, attrs={"units": "dB re 1 N", "long_name": ""}
    )
    force[0, 1] = 80.0
    entry = FORCE_LEVEL_DIFFERENCES[Role.BARE]
    difference = (force - force.sel(law="linear")).assign_attrs(units="dB", long_name="", reference="linear")
    found = _weighted({"force_level": force, entry.name: difference})
    assert float(found[_weighted_name(entry)].sel(law="areal")) == pytest.approx(-6.0)
