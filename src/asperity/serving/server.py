"""Serves the page on this machine until Ctrl-C."""

from __future__ import annotations

import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import uvicorn

from asperity.errors import InputError
from asperity.files import alone_in, refuse_unwritable
from asperity.serving.guard import Guard, new_token
from asperity.serving.routes import Server
from asperity.terminal import say

HOME = "127.0.0.1"
ENDING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
PATIENCE = 3
"""Time that requests have to be answered when the server ends, s."""


def serve_folder(folder: Path, port: int) -> None:
    """Serve the page until Ctrl-C, and keep surfaces and runs in a folder; say where the page is.

    Parameters
    ----------
    folder : Path
        Where surfaces and runs are kept; those of an earlier time are found again.
    port : int
        Port of this machine; 0 for any that is free.

    Raises
    ------
    InputError
        If the folder cannot be written to or is served already, or the port is taken.
    """
    folder = folder.absolute()
    refuse_unwritable(folder, "folder of the runs", "Choose another folder with -o.")
    listener = _listener(port)
    with listener, alone_in(folder):
        (folder / "runs").mkdir(exist_ok=True)
        token, port = new_token(), listener.getsockname()[1]
        app = Guard(Server(folder).app(), token, port)
        config = uvicorn.Config(
            app, log_config=None, log_level="critical", access_log=False, server_header=False,
            date_header=False, lifespan="on", proxy_headers=False, ws="none",
            timeout_graceful_shutdown=PATIENCE,
        )  # fmt: skip
        say(f"Page:  http://{HOME}:{port}/{token}/")
        say(f"Runs:  {folder.resolve()}")
        whose = "Open the address in a browser of this machine; whoever has it may use the page."
        say(f"{whose} Ctrl-C ends it.", err=True)
        with suppress(KeyboardInterrupt):  # before it listens for signals, or after
            _Ending(config).run(sockets=[listener])


class _Ending(uvicorn.Server):
    """A server that each signal that ends programs ends in order, for that is how it is meant to end."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """End when one of them comes; what is ignored, as with nohup, stays so."""
        present = (getattr(signal, name) for name in ENDING if hasattr(signal, name))
        heard = [number for number in present if signal.getsignal(number) is not signal.SIG_IGN]
        earlier = {number: signal.signal(number, self.handle_exit) for number in heard}
        try:
            yield
        finally:
            for number, handler in earlier.items():
                signal.signal(number, handler)


def _listener(port: int) -> socket.socket:
    """Listen on this machine alone."""
    listener = socket.socket()
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((HOME, port))
        listener.listen()
    except (OSError, OverflowError) as error:
        listener.close()
        reason = getattr(error, "strerror", None) or error
        remedy = "Choose another one with --port, or leave it out for one that is free."
        raise InputError("port", f"{port} ({reason})", "a free port of this machine", remedy) from None
    return listener
