"""Serves the page on this machine until Ctrl-C, behind a guard before every request, whatever it asks for.

The page listens on this machine alone. Other programs and users of the machine, and pages of other sites in
the same browser, can reach it there all the same; they know no token, and their headers tell the guard.
"""

import os
import secrets
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import uvicorn
from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse, RedirectResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from asperity.errors import InputError
from asperity.files import alone_in, refuse_unwritable
from asperity.interrupts import handled
from asperity.serving.routes import Server
from asperity.terminal import say

HOME = "127.0.0.1"
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
        token = new_token()
        port = listener.getsockname()[1]
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
        """End when one of them comes."""
        with handled(self.handle_exit):
            yield


def _listener(port: int) -> socket.socket:
    """Listen on this machine alone."""
    try:
        return socket.create_server((HOME, port))
    except OSError as error:
        remedy = "Choose another one with --port, or leave it out for one that is free."
        received = f"{port} ({os.strerror(error.errno or 0)})"
        raise InputError("port", received, "a free port of this machine", remedy) from None


# --- who may ask

PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; media-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""What the page may load: its own script, style, pictures and sounds, and nothing from elsewhere."""
_HEADERS = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cache-control": "no-store",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "content-security-policy": PAGE_POLICY,
}
_READING = ("GET", "HEAD")


def new_token() -> str:
    """Make the secret that stands in the address."""
    return secrets.token_urlsafe(24)


class Guard:
    """Lets through, below the token, what its own page asks for, and refuses all else in a sentence.

    Parameters
    ----------
    app : ASGI application
        It sees paths without the token.
    token : str
        First part of every path.
    port : int
        Port that is listened on.
    """

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self._app = app
        self._token = token
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] != "http":  # but the page opens no sockets
            if scope["type"] == "lifespan":
                await self._app(scope, receive, send)
            return

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                given = {name.lower() for name, _ in message["headers"]}
                more = ((n.encode(), v.encode()) for n, v in _HEADERS.items() if n.encode() not in given)
                message["headers"] = [*message["headers"], *more]
            await send(message)

        first, slash, rest = scope["path"].removeprefix("/").partition("/")
        reason = self._reason(scope["method"], Headers(scope=scope), first)
        if reason:
            await PlainTextResponse(f"{reason}\n", 403)(scope, receive, guarded)
            return
        if not slash:  # relative addresses of the page need it
            await RedirectResponse(f"/{self._token}/")(scope, receive, guarded)
            return
        within = dict(scope, path=f"/{rest}", raw_path=f"/{rest}".encode())
        await self._app(within, receive, guarded)

    def _reason(self, method: str, headers: Headers, token: str) -> str:
        """Why a request is refused; empty if it is not."""
        host = headers.get("host", "")
        if host not in self._hosts:  # a name of somebody else's that leads here
            return "This server answers to 127.0.0.1 and localhost alone."
        if not secrets.compare_digest(token.encode(), self._token.encode()):
            return "Open the address that 'asperity serve' printed: it holds a token that is missing here."
        if (origin := headers.get("origin")) is not None and origin != f"http://{host}":
            return "Only the page itself may ask this."
        if headers.get("sec-fetch-site", "none") in ("none", "same-origin"):
            return ""
        opened = headers.get("sec-fetch-mode") == "navigate" and headers.get("sec-fetch-dest") == "document"
        if method in _READING and opened:  # a link that was followed, as in the window of a terminal
            return ""
        return "Only the page itself may ask this."
