"""Work shared out among forked processes."""

import os
import time

import pytest

from asperity.forked import in_processes

needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="nothing can be forked")


@pytest.mark.parametrize("count", [1, 2, 5])
def test_results_come_in_the_order_of_the_items(count):
    assert in_processes(lambda k: [k, "é"], range(300), count) == [[k, "é"] for k in range(300)]
    assert in_processes(lambda k: k, [], count) == []


@needs_fork
def test_several_processes_work():
    def slowly(_):
        time.sleep(0.02)
        return os.getpid()

    assert len(set(in_processes(slowly, range(60), 3))) == 3


@needs_fork
@pytest.mark.parametrize("fail", [lambda: 1 / 0, lambda: os._exit(1), lambda: {1}])
def test_what_a_process_does_not_tell_is_done_here(fail):
    here = os.getpid()

    def task(k):
        if os.getpid() != here:
            return fail()
        time.sleep(0.01)
        return k

    assert in_processes(task, range(12), 2) == list(range(12))


@needs_fork
def test_an_error_here_ends_the_others(tmp_path):
    here = os.getpid()

    def task(_):
        if os.getpid() == here:
            time.sleep(0.2)
            raise ValueError("no")
        (tmp_path / str(os.getpid())).touch()
        time.sleep(60.0)

    with pytest.raises(ValueError, match="no"):
        in_processes(task, range(12), 3)
    others = [int(path.name) for path in tmp_path.iterdir()]
    assert others
    for process in others:
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


def test_where_nothing_can_be_forked_all_is_done_here(monkeypatch):
    monkeypatch.delattr(os, "fork", raising=False)
    assert set(in_processes(lambda _: os.getpid(), range(4), 2)) == {os.getpid()}


@needs_fork
def test_where_no_more_processes_can_be_had_those_there_are_do_all(monkeypatch):
    fork, left, before = os.fork, [None], len(os.listdir("/dev/fd"))

    def scarce():
        if not left:
            raise BlockingIOError(11, "Resource temporarily unavailable")
        left.pop()
        return fork()

    def slowly(k):
        time.sleep(0.02)
        return [k, os.getpid()]

    monkeypatch.setattr(os, "fork", scarce)
    found = in_processes(slowly, range(30), 4)
    assert [k for k, _ in found] == list(range(30))
    assert len({process for _, process in found}) == 2
    assert len(os.listdir("/dev/fd")) == before  # no pipe is left open
