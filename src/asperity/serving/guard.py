"""Who may ask: the guard before every request, whatever it asks for.

The page listens on this machine alone. Other programs and users of the machine, and pages of other sites in
the same browser, can reach it there all the same; they know no token, and their headers tell the guard.
"""

from __future__ import annotations

import secrets

from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; media-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""What the page may load: its own script, style, pictures and sounds, and nothing from elsewhere."""
REPORT_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "sandbox allow-scripts allow-downloads allow-popups"
)
"""What a report may do: run what stands in it, in a sandbox that can ask nothing of the server."""
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
        self._app, self._token = app, token
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":  # the page opens no sockets
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
            moved = PlainTextResponse("", 307, {"location": f"/{self._token}/"})
            await moved(scope, receive, guarded)
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


def policy_of(ending: str) -> dict[str, str]:
    """Headers of a file by its ending: what a browser shows as a page of its own lives in a sandbox."""
    return {"content-security-policy": REPORT_POLICY} if ending in (".html", ".svg") else {}
