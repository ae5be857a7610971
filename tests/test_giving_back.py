"""Memory is given back where the C library can be asked to, and nothing happens where it cannot."""

import ctypes
import sys

import numpy as np
import pytest

from asperity import memory


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1])  # pages


@pytest.fixture(autouse=True)
def _asked_anew():
    memory._trim.cache_clear()
    yield
    memory._trim.cache_clear()


@pytest.mark.skipif(sys.platform != "linux" or memory._trim() is None, reason="needs glibc")
def test_what_is_free_is_given_back():
    """Many small arrays, freed but for the last, lie below it in the heap: alone they would stay."""
    held = [np.ones(8000) for _ in range(1000)]  # 64 KB each, from the heap
    last = held[-1]
    del held
    before = resident()
    memory.give_back()
    assert before - resident() > 0.8 * 1000 * 64000 / 4096
    assert last.all()


@pytest.mark.parametrize("error", [AttributeError, OSError, TypeError])
def test_another_library_is_not_asked(monkeypatch, error):
    def none(_):
        raise error

    monkeypatch.setattr(ctypes, "CDLL", none)
    memory.give_back()
