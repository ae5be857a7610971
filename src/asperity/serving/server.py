"""Serves the page on this machine until Ctrl-C."""

from __future__ import annotations

import socket
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import uvicorn

from asperity.errors import InputError
from asperity.files import alone_in, refuse_unwritable
from asperity.serving.guard import Guard, new_token
from asperity.serving.routes import Server

HOME = "127.0.0.1"
PATIENCE = 3
"""Time that requests have to be answered when the server ends, s."""


def serve_folder(folder: Path, port: int, announce: Callable[[str], None]) -> None:
    """Serve the page, and keep surfaces and runs in a folder.

    Parameters
    ----------
    folder : Path
        Where surfaces and runs are kept; those of an earlier time are found again.
    port : int
        Port of this machine; 0 for any that is free.
    announce : callable
        Receives the address, with its token, once it can be opened.

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
            app, log_config=None, access_log=False, server_header=False, date_header=False, lifespan="on",
            proxy_headers=False, ws="none", timeout_graceful_shutdown=PATIENCE,
        )  # fmt: skip
        announce(f"http://{HOME}:{port}/{token}/")
        with suppress(KeyboardInterrupt):  # how a server is meant to end
            uvicorn.Server(config).run(sockets=[listener])


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
