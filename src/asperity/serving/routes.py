"""What the page asks of its server, address by address."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from functools import wraps
from importlib import resources
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from asperity.case.toml import LARGEST_CASE
from asperity.errors import AsperityError
from asperity.reporting.payload import chart_script
from asperity.serving import kept_runs, uploads
from asperity.serving.blocks import figures_style
from asperity.serving.desk import Desk, Refused
from asperity.serving.guard import policy_of
from asperity.serving.jobs import Jobs
from asperity.serving.page_template import page_text

CONTACT_SECONDS, FILE_SECONDS = 60.0, 120.0
"""Time that a contact, and a file, may take, s."""
MOST_COMPARED = 4
MOST_COMPARISONS = 20
"""Comparisons that are kept; others are written again when they are asked for."""
LONGEST_SIZE = 19  # digits of a number of bytes
Handler = Callable[["Server", Request], Awaitable[Response]]
_MODULES = ("page", "asking", "canvas", "form", "contact", "runs", "watching")
_STATIC = {f"{name}.js": "text/javascript" for name in _MODULES} | {"page.css": "text/css"}
_WRITTEN = {"charts.js": (chart_script, "text/javascript"), "charts.css": (figures_style, "text/css")}
"""What figures need on every page: its text, and what it is."""


def told_plainly(handler: Handler) -> Handler:
    """Turn what is wrong with the input into an answer that the page shows."""

    @wraps(handler)
    async def answered(server: Server, request: Request) -> Response:
        try:
            return await handler(server, request)
        except Refused as error:
            return JSONResponse({"errors": error.errors}, 422)
        except uploads.TooLarge as error:
            return JSONResponse({"errors": [str(error)]}, 413, {"connection": "close"})
        except AsperityError as error:
            return JSONResponse({"errors": [str(error)]}, 422)

    return answered


class Server:
    """What lies behind the addresses: surfaces and runs on disk, runs under way, and those who answer."""

    def __init__(self, folder: Path) -> None:
        self.surfaces, self.runs = folder / "surfaces", folder / "runs"
        self.comparisons = folder / "comparisons"
        self.jobs = Jobs()
        self.contacts, self.files = Desk(CONTACT_SECONDS), Desk(FILE_SECONDS)

    @asynccontextmanager
    async def alive(self, app: Starlette) -> AsyncIterator[None]:
        """Get ready for the first contact, and end with the server all that it has started."""
        ready = asyncio.create_task(self._prepare())
        try:
            yield
        finally:
            ready.cancel()
            await asyncio.gather(ready, return_exceptions=True)
            await self.jobs.end()
            await self.contacts.end()
            await self.files.end()

    async def _prepare(self) -> None:
        """Have those who answer import what they need before they are asked, the contact first."""
        await self.contacts.ask("prepare to press")
        await self.files.ask("prepare to show")

    def app(self) -> Starlette:
        """The addresses, without token and guard."""
        return Starlette(
            routes=[
                Route("/", self._bound(send_page)),
                Route("/{name}", self._bound(send_static)),
                Route("/ask/press", self._bound(press_contact), methods=["POST"]),
                Route("/ask/check", self._bound(check_form), methods=["POST"]),
                Route("/ask/fill", self._bound(fill_from_file), methods=["POST"]),
                Route("/ask/surfaces", self._bound(send_surfaces)),
                Route("/ask/surfaces", self._bound(take_upload), methods=["POST"]),
                Route("/ask/surfaces/clear", self._bound(clear_surfaces), methods=["POST"]),
                Route("/ask/runs", self._bound(send_runs)),
                Route("/ask/runs", self._bound(start_run), methods=["POST"]),
                Route("/ask/compare", self._bound(send_comparison)),
                Route("/runs/{run}/state", self._bound(send_state)),
                Route("/runs/{run}/view", self._bound(send_view)),
                Route("/runs/{run}/values", self._bound(fill_from_run)),
                Route("/runs/{run}/cancel", self._bound(cancel_run), methods=["POST"]),
                Route("/runs/{run}/go-on", self._bound(go_on_with_run), methods=["POST"]),
                Route("/runs/{run}/delete", self._bound(delete_run), methods=["POST"]),
                Route("/runs/{run}/{name:path}", self._bound(send_file)),
                Route("/comparisons/{run}/{name}", self._bound(send_comparison_file)),
            ],
            lifespan=self.alive,
        )

    def _bound(self, handler: Handler) -> Callable[[Request], Awaitable[Response]]:
        async def bound(request: Request) -> Response:
            return await handler(self, request)

        return bound

    def run_of(self, request: Request) -> Path:
        """Folder of the run that a path names."""
        folder = kept_runs.folder_of(self.runs, request.path_params["run"])
        if folder is None:
            raise HTTPException(404, "There is no such run.")
        return folder

    def told(self, folder: Path) -> dict[str, Any]:
        """What a run is, and how far."""
        return kept_runs.told_of(folder) | self.jobs.told(folder.name)


async def typed_in(request: Request) -> dict[str, Any]:
    """The JSON object that a request carries, of bounded size."""
    text = bytearray()
    async for piece in request.stream():
        text += piece
        if len(text) > LARGEST_CASE:
            raise HTTPException(413, "The question is too long.")
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        raise HTTPException(400, "The question is no JSON.") from None
    if not isinstance(found, dict):
        raise HTTPException(400, "The question is no JSON object.")
    return found


def _form(found: dict[str, Any]) -> dict[str, Any]:
    """Kind and values of a form."""
    values = found.get("values")
    if not isinstance(values, dict):
        raise HTTPException(400, "The question has no values.")
    return {"kind": found.get("kind"), "values": values}


async def send_page(server: Server, request: Request) -> Response:
    """The page itself."""
    return HTMLResponse(page_text())


async def send_static(server: Server, request: Request) -> Response:
    """Its scripts and its styles."""
    name = request.path_params["name"]
    if name in _WRITTEN:
        text, kind = _WRITTEN[name]
        return Response(text(), media_type=kind)
    if name not in _STATIC:
        raise HTTPException(404, "There is nothing of that name.")
    return Response(resources.files(__package__).joinpath(name).read_bytes(), media_type=_STATIC[name])


@told_plainly
async def press_contact(server: Server, request: Request) -> Response:
    """Press the sample of a case to an approach."""
    found = await typed_in(request)
    share = found.get("share")
    if not (share is None or (isinstance(share, int | float) and 0 <= share <= 1)):
        raise HTTPException(400, "The share lies between 0 and 1.")
    whole = found.get("whole") is True
    told = await server.contacts.ask(
        "press", **_form(found), surfaces=str(server.surfaces), share=share, whole=whole
    )
    return JSONResponse(told)


@told_plainly
async def check_form(server: Server, request: Request) -> Response:
    """Read a case from its form."""
    form = _form(await typed_in(request))
    return JSONResponse(await server.contacts.ask("check", **form, surfaces=str(server.surfaces)))


@told_plainly
async def fill_from_file(server: Server, request: Request) -> Response:
    """Read a case file into the form."""
    text = (await typed_in(request)).get("text")
    if not isinstance(text, str):
        raise HTTPException(400, "The question has no text.")
    return JSONResponse(await server.contacts.ask("fill", text=text, surfaces=str(server.surfaces)))


@told_plainly
async def fill_from_run(server: Server, request: Request) -> Response:
    """Read the case of a run into the form."""
    text = kept_runs.case_of_run(server.run_of(request))
    return JSONResponse(await server.contacts.ask("fill", text=text, surfaces=str(server.surfaces)))


async def send_surfaces(server: Server, request: Request) -> Response:
    """Surfaces that were uploaded."""
    return JSONResponse(uploads.uploaded(server.surfaces))


@told_plainly
async def take_upload(server: Server, request: Request) -> Response:
    """Receive a surface, and keep it if anybody can read it."""
    size = request.headers.get("content-length", "")
    announced = int(size) if size.isascii() and size.isdigit() and len(size) < LONGEST_SIZE else None
    name = request.query_params.get("name", "")
    file = await uploads.receive(server.surfaces, name, announced, request.stream())
    try:
        told = await server.files.ask("examine", path=str(file))
    except BaseException:
        kept_runs.remove_kept(file.parent)
        raise
    return JSONResponse(told | {"id": file.parent.name, "name": file.name})


async def clear_surfaces(server: Server, request: Request) -> Response:
    """Delete the surfaces that no run uses; tell which are left."""
    kept_runs.remove_unnamed(server.surfaces, server.runs)
    return JSONResponse(uploads.uploaded(server.surfaces))


async def send_runs(server: Server, request: Request) -> Response:
    """All runs, the latest first."""
    found = [server.told(folder) for folder in kept_runs.kept_in(server.runs)]
    return JSONResponse(sorted(found, key=lambda run: str(run["created"]), reverse=True))


@told_plainly
async def start_run(server: Server, request: Request) -> Response:
    """Keep a case that is right, and roll it."""
    found = await typed_in(request)
    form = _form(found)
    told = await server.contacts.ask("check", **form, surfaces=str(server.surfaces))
    identifier = kept_runs.keep_run(
        server.runs,
        told["toml"],
        kind=form["kind"],
        name=str(found.get("name", "")),
        changed=told["changed"],
    )
    try:
        server.jobs.start(server.runs / identifier)
    except Refused:  # too many wait: it is not kept as one that was begun
        kept_runs.remove_kept(server.runs / identifier)
        raise
    return JSONResponse({"id": identifier})


async def send_state(server: Server, request: Request) -> Response:
    """What became of a run, or how far it is."""
    return JSONResponse(server.told(server.run_of(request)))


@told_plainly
async def send_view(server: Server, request: Request) -> Response:
    """What there is to be seen of a run that is done."""
    path = server.run_of(request) / kept_runs.RESULT
    return JSONResponse(await server.files.ask("view", path=str(path)))


async def cancel_run(server: Server, request: Request) -> Response:
    """End a run."""
    folder = server.run_of(request)
    await server.jobs.cancel(folder.name)
    return JSONResponse(server.told(folder))


@told_plainly
async def go_on_with_run(server: Server, request: Request) -> Response:
    """Roll a run that ended too early; what of it is finished is not computed again."""
    folder = server.run_of(request)
    if not (folder / kept_runs.RESULT).is_file():
        server.jobs.start(folder)
    return JSONResponse(server.told(folder))


async def delete_run(server: Server, request: Request) -> Response:
    """End a run, and delete all of it."""
    folder = server.run_of(request)
    await server.jobs.cancel(folder.name)
    kept_runs.remove_kept(folder)
    return JSONResponse({})


def _compared(server: Server, request: Request) -> dict[str, Any]:
    """Paths and names of the runs that a question names, in their order."""
    found = [kept_runs.folder_of(server.runs, each) for each in request.query_params.getlist("run")]
    folders = [folder for folder in found if folder is not None]
    if not 2 <= len(folders) <= MOST_COMPARED:
        raise HTTPException(400, f"Two to {MOST_COMPARED} runs can be compared.")
    names = [str(kept_runs.told_of(folder)["name"]) for folder in folders]
    return {"paths": [str(folder / kept_runs.RESULT) for folder in folders], "names": names}


@told_plainly
async def send_comparison(server: Server, request: Request) -> Response:
    """Show runs beside each other."""
    runs = _compared(server, request)
    identifier = kept_runs.identifier_of_runs([Path(path).parent.name for path in runs["paths"]])
    told = await server.files.ask("compare", **runs)
    return JSONResponse(told | {"page": f"comparisons/{identifier}/{kept_runs.COMPARISON}"})


@told_plainly
async def send_comparison_file(server: Server, request: Request) -> Response:
    """The page of a comparison, written when it is asked for with its runs; and its table."""
    root, name = server.comparisons, request.path_params["name"]
    if "run" in request.query_params:
        runs = _compared(server, request)
        identifier = kept_runs.identifier_of_runs([Path(path).parent.name for path in runs["paths"]])
        if identifier == request.path_params["run"]:
            await server.files.ask("comparison", **runs, folder=str(root / identifier))
            kept_runs.keep_latest(root, MOST_COMPARISONS)
    folder = kept_runs.folder_of(root, request.path_params["run"])
    return _handed_out(folder, name)


def _handed_out(folder: Path | None, name: str) -> Response:
    """A file of a run or a comparison, to be looked at or taken away."""
    file = None if folder is None else kept_runs.file_of_run(folder, name)
    if folder is None or file is None:
        raise HTTPException(404, "There is no such file.")
    shown = file.suffix in (".html", ".wav", ".svg", ".png")
    taken = file.name if shown else f"{folder.name}-{file.name}"
    where = "inline" if shown else "attachment"
    return FileResponse(file, filename=taken, content_disposition_type=where, headers=policy_of(file.suffix))


@told_plainly
async def send_file(server: Server, request: Request) -> Response:
    """A file of a run: its result, its case, its report with the numbers of its figures, its sounds.

    The report is written when it is asked for first.
    """
    folder, name = server.run_of(request), request.path_params["name"]
    result = folder / kept_runs.RESULT
    if name == kept_runs.REPORT and result.is_file() and not (folder / name).is_file():
        await server.files.ask("report", path=str(result))
    return _handed_out(folder, name)
