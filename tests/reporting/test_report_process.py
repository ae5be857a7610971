"""A report that a second process writes, with others that it forks."""

import os
import subprocess
import sys
from types import SimpleNamespace

import pytest
from xarray import DataTree

from asperity.errors import ComputationError
from asperity.kinds import report_process as module
from asperity.kinds.report import write_page
from asperity.kinds.report_process import ReportProcess, report_process

KIND = "ball-on-beam"


def some_of(tree, *groups):
    return DataTree.from_dict({f"/{name}": tree[name].to_dataset() for name in groups})


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.suffix != ".nc"}


@pytest.mark.parametrize("known", [[], ["contact"], ["contact", "surface"]])
def test_another_process_writes_what_this_one_does(real_runs, reports, tmp_path, monkeypatch, known):
    monkeypatch.setenv("ASPERITY_THREADS", "2")
    expected, page, saved = files(reports[KIND]), tmp_path / "report.html", []
    monkeypatch.setattr("asperity.kinds.report.write_page", None)  # not here
    with report_process() as reporter:
        for name in known:
            reporter.ahead(some_of(real_runs[KIND], "scenario", name))
        for _ in range(2):
            names = reporter.write(real_runs[KIND], page, lambda: saved.append(1))
            assert files(tmp_path) == expected
            assert expected.keys() < set(names)  # other kinds have other figures
    assert saved == [1, 1]
    assert reporter.process.poll() is not None


@pytest.mark.skipif(not hasattr(os, "fork"), reason="nothing can be forked")
def test_several_processes_write_what_one_does(real_runs, reports, tmp_path):
    write_page(real_runs[KIND], tmp_path / "report.html", processes=3)
    assert files(tmp_path) == files(reports[KIND])


@pytest.mark.parametrize("program", ["pass", "print('no', flush=True); input()", "print('0')"])
def test_what_the_other_process_leaves_is_written_here(real_runs, tmp_path, program):
    done, page = [], tmp_path / "report.html"
    command = [sys.executable, "-c", program]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "start_new_session": True}
    reporter = ReportProcess(subprocess.Popen(command, **pipes))
    try:
        reporter.ahead(some_of(real_runs[KIND], "scenario", "surface"))
        reporter.write(real_runs[KIND], page, lambda: done.append(1))
    finally:
        module._end(reporter)
    assert "</html>" in page.read_text()
    assert done == [1]


def test_what_cannot_be_written_is_told_here(real_runs, tmp_path, monkeypatch):
    monkeypatch.setenv("ASPERITY_THREADS", "2")
    (tmp_path / "report.html").mkdir()
    with report_process() as reporter, pytest.raises(ComputationError, match=r"report\.html"):
        reporter.write(real_runs[KIND], tmp_path / "report.html", lambda: None)


def test_one_thread_writes_alone(monkeypatch):
    monkeypatch.setenv("ASPERITY_THREADS", "1")
    with report_process() as reporter:
        assert reporter.process is None
        assert reporter.ahead is None


def test_none_is_started_where_none_is_wanted():
    with report_process(wanted=False) as reporter:
        assert reporter is None


def test_where_no_process_can_be_started_all_is_written_here(monkeypatch):
    def none(*_, **__):
        raise OSError("no more processes")

    monkeypatch.setenv("ASPERITY_THREADS", "2")
    monkeypatch.setattr(module, "subprocess", SimpleNamespace(Popen=none, PIPE=-1, DEVNULL=-3))
    with report_process() as reporter:
        assert reporter.process is None
