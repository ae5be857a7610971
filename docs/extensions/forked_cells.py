"""Pages and examples run in processes that are forked from one where the package has run once.

A kernel for each page would import and load all anew: two seconds of processor time for each, on 25 pages.
"""

import gc
import multiprocessing
import os
import sys
import time
from queue import Empty

import matplotlib.pyplot  # noqa: F401  (and all that follows, once for all pages)
import matplotlib_inline.backend_inline  # noqa: F401
import pandas  # noqa: F401
import xarray  # noqa: F401
from ipykernel.inprocess.manager import InProcessKernelManager
from joblib.parallel import MultiprocessingBackend, register_parallel_backend
from jupyter_cache.executors.utils import ExecutionResult
from myst_nb.core.execute import direct
from nbformat.v4 import output_from_msg

import asperity
from asperity.scenarios.compiling import compile_kernels

ENDING = 10.0  # s that a process has to end once it has answered
OUTPUTS = ("stream", "display_data", "execute_result", "error")


class Examples(MultiprocessingBackend):
    """Processes of the gallery, forked whatever Python would do by itself."""

    def configure(self, *args, **kwargs):
        """Begin them."""
        return super().configure(*args, **kwargs | {"context": multiprocessing.get_context("fork")})


def run_cells(ends, cells, folder):
    """Run cells in a folder, by a kernel in this process; send their outputs, and what failed."""
    there, pipe = ends
    there.close()  # so that this process ends where nobody reads any more
    os.chdir(folder)
    manager = InProcessKernelManager()
    manager.client_class = "ipykernel.inprocess.blocking.BlockingInProcessKernelClient"
    manager.start_kernel()
    client = manager.client()
    client.start_channels()
    client.execute("%matplotlib inline", silent=True)
    outputs, failure = [], None
    for cell in cells:
        client.execute(cell)
        outputs.append([output_from_msg(each) for each in told(client) if each["msg_type"] in OUTPUTS])
        if failed := [each for each in outputs[-1] if each.output_type == "error"]:
            failure = "\n".join([cell, *failed[0].traceback])
            break
    pipe.send((outputs, failure))


def told(client):
    """Messages that a kernel in this process has sent so far."""
    while True:
        try:
            yield client.get_iopub_msg(timeout=0)
        except Empty:
            return


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
