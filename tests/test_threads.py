"""How many threads a computation takes."""

import threading
import time

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import asperity
from asperity import HalfSpace
from asperity.errors import InputError
from asperity.threads import (
    begun_in_order,
    in_order,
    one_thread_in_linear_algebra,
    processors,
    refuse_to_go_on,
    thread_count,
)


def test_one_per_processor_unless_the_environment_says_otherwise(monkeypatch):
    monkeypatch.delenv("ASPERITY_THREADS", raising=False)
    assert thread_count() == processors() >= 1
    monkeypatch.setenv("ASPERITY_THREADS", "3")
    assert thread_count() == 3
    for wrong in ("0", "-1", "two", "1.5"):
        monkeypatch.setenv("ASPERITY_THREADS", wrong)
        with pytest.raises(InputError, match=f"received '{wrong}'; allowed: a whole number greater than 0"):
            thread_count()


def test_linear_algebra_has_one_thread_inside_and_its_own_again_outside():
    def threads():
        return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]

    with one_thread_in_linear_algebra():
        pass  # loads all libraries
    with threadpool_limits(limits=2, user_api="blas"):
        before = threads()
        with one_thread_in_linear_algebra():
            assert set(threads()) == {1}
        assert threads() == before
        assert max(before) == 2


def test_long_tasks_stop_when_nobody_waits_for_them_any_more():
    """As after Ctrl-C: within a piece of the work, not at the end of all."""
    begun = []

    def task(item):
        begun.append(item)
        until = time.monotonic() + (20 if item else 0)
        while time.monotonic() < until:
            refuse_to_go_on()
            time.sleep(0.01)

    results = in_order(task, range(9), workers=2)
    next(results)
    begin = time.monotonic()
    results.close()
    assert time.monotonic() - begin < 5
    assert len(begun) <= 4


def test_results_come_in_order_few_are_held_and_errors_come_out():
    begun = []

    def task(i):
        begun.append(i)
        time.sleep(0.001 * (i % 3))
        return 1 // (20 - i)

    results = in_order(task, range(1000), workers=3)
    assert [next(results) for _ in range(20)] == [1 // (20 - i) for i in range(20)]
    assert len(begun) <= 20 + 2 * 3 + 1
    with pytest.raises(ZeroDivisionError):
        next(results)
    assert len(begun) <= 21 + 2 * 3 + 1


def test_tasks_run_while_the_caller_does_other_work():
    done = threading.Event()
    with begun_in_order(lambda item: (done.set(), item), [0, 1], workers=2) as results:
        assert done.wait(5)
        assert [item for _, item in results] == [0, 1]
    with begun_in_order(str, range(3), workers=1) as results:
        assert list(results) == ["0", "1", "2"]


def test_tasks_stop_when_the_work_beside_them_fails():
    def task(item):
        while True:
            refuse_to_go_on()
            time.sleep(0.01)

    begin = time.monotonic()
    with pytest.raises(ZeroDivisionError), begun_in_order(task, range(9), workers=2):
        1 / 0  # noqa: B018
    assert time.monotonic() - begin < 5


def test_contacts_of_a_scan_are_such_pieces(monkeypatch):
    """A block of 64 positions looks up every 16."""
    looks = []
    monkeypatch.setattr("asperity.contact.pressed.refuse_to_go_on", lambda: looks.append(1))
    x = 1e-5 * np.arange(-8, 9)
    body = (x[:, None] ** 2 + x**2) / (2 * 0.025)
    HalfSpace((17, 17), 1e-5, 115e9).scan(np.zeros((80, 17)), body, [1e-7])
    assert len(looks) >= 4


def test_a_run_is_a_task_that_looks_up_at_each_chunk(monkeypatch):
    looks = []
    monkeypatch.setattr("asperity.rolling.stepper.refuse_to_go_on", lambda: looks.append(1))
    case = {"kind": "ball-on-beam", "laws": ["hertz"], "surface": {"smooth": True}}
    asperity.run(case)
    assert len(looks) >= 2
