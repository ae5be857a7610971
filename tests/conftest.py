"""What all tests share: a cache of their own, kernels that are compiled once, signals that reach children."""

import gc
import io
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import hypothesis
import pytest

gc.disable()  # until tests are collected: it takes a fifth of the time of imports, and of that

from browser import chromium  # noqa: E402

# These are set before asperity is imported. Kernels outlast a session: compiling them all takes minutes.
os.environ.setdefault("ASPERITY_KERNELS", str(Path(__file__).parents[1] / ".pytest_cache" / "kernels"))
_cache = tempfile.TemporaryDirectory(prefix="asperity-tests-", ignore_cleanup_errors=True)
os.environ["ASPERITY_CACHE"] = _cache.name
# what children import stays compiled: each starts a second sooner
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# workers share the cores: threads of linear algebra would wait for one another
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import asperity  # noqa: E402
from asperity import sandbox  # noqa: E402
from asperity.case.cases import as_case  # noqa: E402
from asperity.errors import InputError  # noqa: E402
from small_cases import CASES, Made, changed  # noqa: E402

hypothesis.settings.register_profile("untimed", deadline=None)
hypothesis.settings.load_profile("untimed")


def pytest_configure():
    """Let children obey signals that the shell of a background job ignores: they inherit no handlers."""
    for name in ("SIGINT", "SIGHUP", "SIGTERM"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, lambda number, frame: None)


SLIDING = """
import numpy as np
from asperity.contact.halfspace import HalfSpace
from asperity.contact.solved import Contact, Outcome
from asperity.contact.tangential import FrictionalHalfSpace
from asperity.reference.materials import material
steel, flat = material("steel"), np.zeros((4, 4))
space = HalfSpace(flat.shape, (1e-3, 1e-3), 0.5 * steel.youngs_modulus / (1.0 - steel.poisson_ratio**2))
pressed = Contact(flat + 1e8, 1600.0, 1e-6, 1.6e-5, 1, 0.0, Outcome.CONVERGED, space, flat)
FrictionalHalfSpace(space, (steel, steel), 0.3).roll(pressed, (1e-3, 0.0))
"""
"""Compiles what slides, beside what presses and rolls."""


def pytest_sessionstart(session):
    """Compile what most tests call before there are workers, each of which would compile all of it."""
    if getattr(session.config.option, "numprocesses", None):
        gc.enable()
        from asperity.scenarios.compiling import compile_kernels

        environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        with subprocess.Popen([sys.executable, "-W", "ignore", "-c", SLIDING], env=environment):
            compile_kernels(lambda *_: None)


def pytest_collection_finish():
    """Seek garbage seldom, and not in what stays until the end: modules, kernels, tests.

    It took up to a fifth of the time of tests that make many objects. What imports left stays with them: it
    is little, and takes half a second to be found.
    """
    gc.freeze()
    gc.enable()
    gc.set_threshold(20_000, 20, 20)


def pytest_unconfigure():
    """Seek garbage once more: pytest would do so five times over, in all that tests and modules left."""
    _cache.cleanup()
    gc.collect()
    gc.freeze()


OPENED_APART = ("results", "structures.modal_files", "studies.kept_signals")
OPENED_APART += ("surfaces.readers.libraries", "surfaces.readers.matlab")


@pytest.fixture(scope="module", autouse=True)
def files_opened_here():
    """Foreign files of tests are their own: only what cannot be read is opened in a sandbox."""

    def opened(function, path, arguments, **of_file):
        try:
            sandbox.send(function(str(path.absolute()), *arguments), answer := io.BytesIO())
        except InputError:
            raise
        except Exception:
            return sandbox.sandboxed(function, path, arguments, **of_file)
        answer.seek(0)
        return sandbox.received(answer)

    with pytest.MonkeyPatch.context() as patch:
        for module in OPENED_APART:
            patch.setattr(f"asperity.{module}.sandboxed", opened)
        yield


@pytest.fixture
def opened_apart(files_opened_here, monkeypatch):
    """Foreign files are opened in a sandbox, as the program does."""
    for module in OPENED_APART:
        monkeypatch.setattr(f"asperity.{module}.sandboxed", sandbox.sandboxed)


@pytest.fixture
def own_cache(tmp_path, monkeypatch):
    """Nothing that another test computed is found."""
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))


@pytest.fixture(scope="module")
def cache_of_module(tmp_path_factory):
    """What the tests of one module compute, they find again; others do not."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ASPERITY_CACHE", cache := str(tmp_path_factory.mktemp("cache")))
        yield cache


@pytest.fixture(scope="session")
def cache_of_runs(tmp_path_factory):
    """Modes, kernels and scans of `runs`, which all workers find."""
    own = tmp_path_factory.getbasetemp()
    return str((own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "cache_of_runs")


@pytest.fixture(scope="module")
def in_cache_of_runs(cache_of_runs):
    """What the tests of a module roll again takes modes, kernels and scans from `runs`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ASPERITY_CACHE", cache_of_runs)
        yield


@pytest.fixture(scope="session")
def runs(cache_of_runs):
    """Results of cases, in any form, each computed once in a session."""
    made = {}

    def run(case):
        case = as_case(case)
        if case.text not in made:
            with pytest.MonkeyPatch.context() as patch:
                patch.setenv("ASPERITY_CACHE", cache_of_runs)
                made[case.text] = asperity.run(case)
        return made[case.text]

    return run


HARDNESS = {"ball-on-beam": "0.6 GPa", "wheel-on-rail": "1.2 GPa", "bodies": "0.6 GPa"}
"""Of which the highest crests yield, so that results hold what is said of running-in, too."""


@pytest.fixture(scope="session")
def real_runs(runs):
    """Results by kind of case."""
    return Made(lambda kind: runs(changed(kind, contact={"hardness": HARDNESS[kind], "running_in": 1})))


@pytest.fixture(scope="session", params=list(CASES))
def real_run(request, real_runs):
    """Result of one kind of case after the other."""
    return real_runs[request.param]


@pytest.fixture(scope="module")
def browser():
    """A browser that the tests of a module share; each opens a page of its own in it.

    What drives it has an event loop, which tests of other modules must not find running.
    """
    yield from chromium()


@pytest.fixture(scope="module")
def members_in_this_process():
    """Members of studies need no processes of their own where those are not the question."""
    from asperity.studies import running

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(running, "locally", lambda members, _: running._in_this_process(members))
        yield
