"""Pages and examples run in processes that are forked from one where the package has run once.

A kernel for each page would import and load all anew: two seconds of processor time for each, on 25 pages.
"""

from __future__ import annotations

import gc
import io
import multiprocessing
import os
import sys
import time
import traceback

import IPython.core.displayhook
import IPython.core.displaypub
import matplotlib.pyplot  # noqa: F401  (and all that follows, once for all pages)
import matplotlib_inline.backend_inline  # noqa: F401
import pandas  # noqa: F401
import xarray  # noqa: F401
from IPython.core.interactiveshell import InteractiveShell
from joblib.parallel import MultiprocessingBackend, register_parallel_backend
from jupyter_cache.executors.utils import ExecutionResult
from myst_nb.core.execute import direct
from nbformat.v4 import new_output
from traitlets import Type
from traitlets.config import Config

import asperity
from asperity.scenarios.compiling import compile_kernels

OUTPUTS: list = []
"""What the cell that runs has said and shown."""

ENDING = 10.0  # s that a process has to end once it has answered


class Said(io.TextIOBase):
    """A stream that keeps what is written to it among the outputs."""

    def __init__(self, name):
        self.name = name

    def writable(self):
        """Whether it can be written to."""
        return True

    def write(self, text):
        """Keep a text, beside what was said just before it."""
        if text and OUTPUTS and OUTPUTS[-1].get("name") == self.name:
            OUTPUTS[-1].text += text
        elif text:
            OUTPUTS.append(new_output("stream", name=self.name, text=text))
        return len(text)


class Shown(IPython.core.displaypub.DisplayPublisher):
    """Keeps what a cell displays, as figures."""

    def publish(self, data, metadata=None, **_):
        """Keep one of them."""
        OUTPUTS.append(new_output("display_data", data=data, metadata=metadata or {}))


class Answered(IPython.core.displayhook.DisplayHook):
    """Keeps the value of a cell's last line."""

    def write_output_prompt(self):
        """Say nothing before it."""

    def write_format_data(self, format_dict, md_dict=None):
        """Keep it in all its formats."""
        answer = {"data": format_dict, "metadata": md_dict or {}, "execution_count": self.prompt_count}
        OUTPUTS.append(new_output("execute_result", **answer))


class Shell(InteractiveShell):
    """A shell as that of a notebook, whose outputs are kept."""

    displayhook_class = Type(Answered)
    display_pub_class = Type(Shown)

    def enable_gui(self, gui=None):
        """Wait for no windows."""


class Examples(MultiprocessingBackend):
    """Processes of the gallery, forked whatever Python would do by itself."""

    def configure(self, *args, **kwargs):
        """Begin them."""
        return super().configure(*args, **kwargs | {"context": multiprocessing.get_context("fork")})


def run_cells(ends, cells, folder):
    """Run cells in a folder; send their outputs, and what failed."""
    there, pipe = ends
    there.close()  # so that this process ends where nobody reads any more
    os.chdir(folder)
    sys.stdout, sys.stderr = Said("stdout"), Said("stderr")
    shell = Shell.instance(config=Config({"HistoryManager": {"enabled": False}}))
    shell.showtraceback = lambda *_, **__: None  # it is sent
    shell.enable_matplotlib("inline")
    outputs, failure = [], None
    for cell in cells:
        OUTPUTS.clear()
        done = shell.run_cell(cell, store_history=True)
        outputs.append([*OUTPUTS])
        if (error := done.error_before_exec or done.error_in_exec) is not None:
            failure = f"{cell}\n{''.join(traceback.format_exception(error))}"
            break
    pipe.send((outputs, failure))


def execute(notebook, cwd, timeout, **_):
    """Run a notebook as `single_nb_execution` does, which starts a kernel for it."""
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    fork, start = multiprocessing.get_context("fork"), time.perf_counter()
    ours, theirs = fork.Pipe(duplex=False)
    process = fork.Process(target=run_cells, args=((ours, theirs), [cell.source for cell in cells], cwd))
    process.start()
    theirs.close()
    answered = ours.poll(timeout)
    try:
        outputs, failure = ours.recv() if answered else ([], f"It had not ended after {timeout} s.")
    except EOFError:
        outputs, failure = [], "The process died."
    process.join(ENDING if answered else 0)
    process.kill()
    for count, (cell, shown) in enumerate(zip(cells, outputs, strict=False), 1):
        cell.outputs, cell.execution_count = shown, count
    notebook.metadata["language_info"] = {"name": "python", "pygments_lexer": "ipython3"}
    error = None if failure is None else RuntimeError(failure)
    return ExecutionResult(notebook, cwd, time.perf_counter() - start, error, failure)


def warm(*_):
    """Run a case in the process from which all others are forked, all kernels compiled."""
    compile_kernels(lambda *_: None)
    brief, small = {"duration": "10 ms", "settling": 0}, {"samples": 2, "sample_length": "2 mm"}
    asperity.run(asperity.BallOnBeam(**brief, surface={"rms": "0.1 um"}, contact=small))
    gc.freeze()


def setup(app):
    """Tell Sphinx."""
    app.connect("builder-inited", warm, priority=200)  # before the gallery starts processes of its own
    if sys.platform == "linux":  # what multiplies matrices on macOS does not outlive a fork
        direct.single_nb_execution = execute
        register_parallel_backend("loky", Examples)  # the gallery asks for no other
    return {"parallel_read_safe": True, "parallel_write_safe": True}
