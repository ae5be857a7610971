"""A disk that is full, or files that may not grow: one message, exit code 3, nothing half-written."""

import os
import shutil
import subprocess
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from program import LONG, RUN, goes_on, here, left, outcome, prepared, same

resource = pytest.importorskip("resource", reason="there is no such limit")

SIZES = [2**k for k in range(12, 22)] if LONG else [300_000]
SMOOTH = 'kind = "ball-on-beam"\nduration = "5 ms"\nlaws = ["hertz"]\n[surface]\nspectrum = "iso3095"\n'


@contextmanager
def limited(size):
    """Let this process write no file that is larger."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("size", SIZES)
def test_files_that_may_not_grow(undisturbed, tmp_path, size):
    folder = prepared(tmp_path)
    with limited(size):
        code, told = here(folder, *RUN)
    assert code in (0, 3)
    assert code == 0 or "could not be written (files may not grow as large here)" in told
    assert left(folder) == []
    goes_on(folder, undisturbed / "out")


def contents(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def test_an_earlier_run_stays_as_it_was(undisturbed, tmp_path):
    """With its report: nothing of it goes before all is there that replaces it."""
    folder = Path(shutil.copytree(undisturbed, tmp_path / "run"))
    for name in ("report.html", "force_history.csv", "force_history.svg"):
        (folder / "out" / name).write_text("earlier")
    before = contents(folder / "out")
    with limited(100_000):
        code, told = here(folder, *RUN, "--again")
    assert code == 3
    assert f"{Path('out', 'run.nc')} could not be written" in told
    assert contents(folder / "out") == before


@pytest.fixture
def small(tmp_path):
    """A file system of a quarter of a mebibyte."""
    place = tmp_path / "small"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(place)]
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("no file system can be mounted here")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def fill(place):
    """Leave no byte free."""
    with open(place / "full", "wb", buffering=0) as file, suppress(OSError):
        while True:
            file.write(bytes(4096))


@pytest.mark.parametrize("full", [False, True], ids=["small", "full"])
@pytest.mark.parametrize("what", ["results", "cache", *(["kernels"] if LONG else [])])
def test_a_full_file_system(undisturbed, small, tmp_path, what, full):
    folder = prepared(tmp_path / "run")
    if full:
        fill(small)
    out = small / "out" if what == "results" else folder / "out"
    places = {"cache": "ASPERITY_CACHE", "kernels": "ASPERITY_KERNELS"}
    env = {places[what]: str(small / what)} if what in places else {}
    ran = outcome if what == "kernels" else here  # this process has kernels
    code, told = ran(folder, "run", "case.toml", "-o", str(out), "--no-report", env=env)
    assert left(folder) == left(small) == []
    if what == "results":
        assert code == 3
        assert "the disk is full (" in told
        assert "are free)" in told
    else:
        assert code == 0
        same(undisturbed / "out", out)
        if full and what == "cache":  # kernels are kept among temporary files then
            assert "finished work is not kept" in told


@pytest.mark.long
def test_a_study_needs_no_cache(small, tmp_path):
    """Its table holds all members, and it is said once that they are not kept."""
    sweep = 'case = "case.toml"\n[sweep]\nseed = [1, 2, 3]\n'
    folder = prepared(tmp_path / "study", case=SMOOTH, study=sweep)
    fill(small)
    code, told = outcome(folder, "study", "study.toml", env={"ASPERITY_CACHE": str(small / "cache")})
    assert code == 0
    assert told.count("arning: ") == told.count("finished work is not kept") == 1
    assert len((folder / "runs" / "study" / "study.csv").read_text().splitlines()) == 4


@pytest.mark.long
def test_nothing_can_be_written_anywhere(tmp_path):
    """A read-only home, and no folder for temporary files: files stand where folders should."""
    folder = prepared(tmp_path, case=SMOOTH.replace("ball-on-beam", "wheel-on-rail"))
    (folder / "file").write_text("")
    env = {name: str(folder / "file" / "no") for name in ("ASPERITY_CACHE", "ASPERITY_KERNELS", "TMPDIR")}
    if not os.access("/tmp", os.W_OK):
        env["HOME"] = str(folder / "file")
    code, told = outcome(folder, *RUN, env=env)
    assert code == 0
    assert "finished work is not kept" in told
