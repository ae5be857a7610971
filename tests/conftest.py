"""What all tests share: a cache of their own, kernels that are compiled once, signals that reach children."""

import io
import os
import signal
import tempfile
from pathlib import Path

import hypothesis
import pytest

from browser import chromium

# Both are set before asperity is imported. Kernels outlast a session: compiling them all takes minutes.
os.environ.setdefault("ASPERITY_KERNELS", str(Path(__file__).parents[1] / ".pytest_cache" / "kernels"))
_cache = tempfile.TemporaryDirectory(prefix="asperity-tests-", ignore_cleanup_errors=True)
os.environ["ASPERITY_CACHE"] = _cache.name

from asperity import sandbox  # noqa: E402

hypothesis.settings.register_profile("untimed", deadline=None)
hypothesis.settings.load_profile("untimed")


def pytest_configure():
    """Let children obey signals that the shell of a background job ignores: they inherit no handlers."""
    for name in ("SIGINT", "SIGHUP", "SIGTERM"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, lambda number, frame: None)


def pytest_unconfigure():
    _cache.cleanup()


@pytest.fixture(autouse=True)
def results_opened_here(monkeypatch):
    """Results of tests are their own: `test_results.py` and `faults` open them in sandboxes."""

    def opened(function, arguments, *_):
        sandbox.send(function(*arguments), answer := io.BytesIO())
        return sandbox.received(answer.getvalue())

    monkeypatch.setattr("asperity.results.sandboxed", opened)


@pytest.fixture
def own_cache(tmp_path, monkeypatch):
    """Nothing that another test computed is found."""
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))


@pytest.fixture(scope="module")
def cache_of_module(tmp_path_factory):
    """What the tests of one module compute, they find again; others do not."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ASPERITY_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def browser():
    """A browser that the tests of a module share; each opens a page of its own in it.

    What drives it has an event loop, which tests of other modules must not find running.
    """
    yield from chromium()
