"""Serve the page, and say where it is."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from asperity.errors import InputError
from asperity.terminal import say


def serve_page(folder: Path, port: int) -> None:
    """Serve the page until Ctrl-C, with surfaces and runs in a folder."""
    missing = [name for name in ("starlette", "uvicorn") if importlib.util.find_spec(name) is None]
    if missing:
        remedy = 'Install them: python -m pip install "asperity[app]".'
        raise InputError("asperity serve", f"no {' and no '.join(missing)}", "the extra app", remedy)
    from asperity.serving.server import serve_folder

    def announce(address: str) -> None:
        say(f"Page:  {address}")
        say(f"Runs:  {folder.resolve()}")
        say(
            "Open the address in a browser of this machine; whoever has it may use the page. Ctrl-C ends it.",
            err=True,
        )

    serve_folder(folder, port, announce)
    say("Ended; runs and surfaces are kept.", err=True)
