"""Figures drawn by two processes."""

import subprocess
import sys
from types import SimpleNamespace

import pytest

import asperity
from asperity.kinds.drawing import DrawingProcess, drawing_process
from asperity.kinds.report import parts_of, write_page
from asperity.reporting import page
from asperity.reporting.page import picture

KIND = "ball-on-beam"


@pytest.fixture
def kept(real_runs, tmp_path):
    return real_runs[KIND], asperity.save(real_runs[KIND], tmp_path / "run.nc")


def test_two_processes_draw_what_one_does(kept, reports, monkeypatch):
    tree, path = kept
    monkeypatch.setenv("ASPERITY_THREADS", "2")
    parts, here = parts_of(tree), []
    monkeypatch.setattr(page, "picture", lambda tree, part: here.append(part) or picture(tree, part))
    with drawing_process() as drawing:
        assert drawing.process is not None
        drawing.process.stdin.write(f'["{path}", "{parts[-1].name}"]\n')
        drawing.process.stdin.flush()
        assert drawing.process.stdout.readline()  # it is ready
        drawn = drawing.pictures(tree, path, parts)
    assert 0 < len(here) < len(parts)
    assert drawing.process.poll() is not None
    written = write_page(tree, path.parent / "report.html", drawn)
    assert written.read_text() == (reports[KIND] / "report.html").read_text()


@pytest.mark.parametrize("program", ["pass", "print('no picture', flush=True); input(); input()"])
def test_what_the_other_process_leaves_is_drawn_here(kept, program):
    tree, path = kept
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        drawn = DrawingProcess(process).pictures(tree, path, parts_of(tree)[:3])
        process.kill()
    assert list(drawn) == [part.name for part in parts_of(tree)[:3]]


def test_one_thread_draws_alone(monkeypatch):
    monkeypatch.setenv("ASPERITY_THREADS", "1")
    with drawing_process() as drawing:
        assert drawing.process is None


def test_where_no_process_can_be_started_all_is_drawn_here(monkeypatch):
    def none(*_, **__):
        raise OSError("no more processes")

    monkeypatch.setenv("ASPERITY_THREADS", "2")
    monkeypatch.setattr("asperity.kinds.drawing.subprocess", SimpleNamespace(Popen=none, PIPE=-1, DEVNULL=-3))
    with drawing_process() as drawing:
        assert drawing.process is None
