"""Processes that solve blocks of a long scan: Python's own part of small contacts does not run beside itself.

A worker is started as ``python -m asperity.reduction.worker``: it needs nothing of the calling program. Both
sides speak in frames of arrays on the worker's standard input and output; it ends when its input does.
"""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]


def send(sink: IO[bytes], arrays: Arrays) -> None:
    """Write a frame: its length in eight bytes, then the arrays."""
    frame = io.BytesIO()
    np.savez(frame, **arrays)  # type: ignore[arg-type]
    content = frame.getbuffer()
    sink.write(len(content).to_bytes(8, "little"))
    sink.write(content)
    sink.flush()


def receive(source: IO[bytes]) -> Arrays | None:
    """Read a frame; None at the end of the stream."""
    length = source.read(8)
    if len(length) < 8:
        return None
    content = source.read(int.from_bytes(length, "little"))
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}


class Worker:
    """A process that solves blocks of one scan.

    Parameters
    ----------
    body, approaches : ndarray
        As in `asperity.reduction.scan.scan`.
    scalars : dict
        ``spacing``, ``modulus``, ``hardness``, ``stride`` and ``rtol``.
    """

    def __init__(self, body: NDArray, approaches: NDArray, scalars: dict[str, Any]) -> None:
        package = str(Path(__file__).parents[2])
        paths = [package, *filter(None, [os.environ.get("PYTHONPATH")])]
        self._process = subprocess.Popen(
            [sys.executable, "-m", "asperity.reduction.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._sink: Any = self._process.stdin
        self._source: Any = self._process.stdout
        scalar = np.array(json.dumps(scalars))
        send(self._sink, {"body": body, "approaches": approaches, "scalars": scalar})

    def solve(self, rows: NDArray, planes: NDArray) -> tuple[NDArray, NDArray] | None:
        """Solve a block.

        Parameters
        ----------
        rows : ndarray, shape (rows, ny)
            Heights under the block, m.
        planes : ndarray, shape (positions,)
            Planes from which approaches count, m.

        Returns
        -------
        tuple of ndarray, or None
            Forces and counts; None if the process is gone.
        """
        try:
            send(self._sink, {"rows": rows, "planes": planes})
            found = receive(self._source)
        except OSError:
            return None
        return None if found is None else (found["forces"], found["counts"])

    def close(self) -> None:
        """End the process."""
        with suppress(OSError):  # it is gone already
            self._sink.close()
        self._process.wait()
        self._source.close()


def main() -> None:
    """Solve the blocks that come in until there are no more."""
    from asperity.reduction.blocks import Contacts, solve_block

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the calling program decides when to stop
    sink = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    first = receive(sys.stdin.buffer)
    if first is None:
        return
    contacts = Contacts(first["body"], first["approaches"], **json.loads(str(first["scalars"])))
    half_space = contacts.half_space()
    while (block := receive(sys.stdin.buffer)) is not None:
        forces, counts = solve_block(half_space, contacts, block["rows"], block["planes"])
        send(sink, {"forces": forces, "counts": counts})


if __name__ == "__main__":
    main()
