"""What the page asks of its server, address by address."""

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
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
from asperity.reporting import chart, payload
from asperity.serving import case_form, stored_runs
from asperity.serving.worker_processes import Jobs, Questions, Refused

CONTACT_SECONDS, FILE_SECONDS = 60.0, 120.0
"""Time that a contact, and a file, may take, s."""
MOST_COMPARED = 4
LONGEST_SIZE = 19  # digits of a number of bytes
REPORT_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "sandbox allow-scripts allow-downloads allow-popups"
)
"""What a file that a browser shows as a page of its own may do: run what stands in it, and ask nothing."""
_MODULES = ("page", "asking", "canvas", "form", "contact", "runs", "watching")
_STATIC = {f"{name}.js": "text/javascript" for name in _MODULES} | {"page.css": "text/css"}


class Server:
    """What lies behind the addresses: surfaces and runs on disk, runs under way, and those who answer."""

    def __init__(self, folder: Path) -> None:
        self.surfaces = folder / "surfaces"
        self.runs = folder / "runs"
        self.jobs = Jobs()
        self.contacts = Questions(CONTACT_SECONDS)
        self.files = Questions(FILE_SECONDS)

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
        """Have who presses import and compile what is needed before it is asked."""
        await self.contacts.ask("prepare to press")

    def app(self) -> Starlette:
        """The addresses, without token and guard."""
        addresses = (
            ("GET", "/", self.page),
            ("GET", "/{name}", self.static),
            ("POST", "/ask/press", self.press),
            ("POST", "/ask/check", self.check),
            ("POST", "/ask/fill", self.fill),
            ("GET", "/ask/surfaces", self.list_surfaces),
            ("POST", "/ask/surfaces", self.take_surface),
            ("POST", "/ask/surfaces/clear", self.clear_surfaces),
            ("GET", "/ask/runs", self.list_runs),
            ("POST", "/ask/runs", self.start_run),
            ("GET", "/ask/compare", self.compare),
            ("GET", "/runs/{run}/state", self.state),
            ("GET", "/runs/{run}/view", self.view),
            ("GET", "/runs/{run}/values", self.fill_from_run),
            ("POST", "/runs/{run}/cancel", self.cancel),
            ("POST", "/runs/{run}/go-on", self.go_on),
            ("POST", "/runs/{run}/delete", self.delete),
            ("GET", "/runs/{run}/{name:path}", self.send_file),
        )
        return Starlette(
            routes=[Route(path, handler, methods=[method]) for method, path, handler in addresses],
            exception_handlers={Refused: _told, AsperityError: _told},
            lifespan=self.alive,
        )

    # --- the page, its contact and its form

    async def page(self, request: Request) -> Response:
        """Send the page itself."""
        return HTMLResponse(case_form.page_text())

    async def static(self, request: Request) -> Response:
        """Send its scripts and its styles."""
        match request.path_params["name"]:
            case "charts.js":
                return Response(payload.chart_script(), media_type="text/javascript")
            case "charts.css":
                light, dark = (f":root {{ {chart.colour_variables(dark=of)} }}" for of in (False, True))
                style = f"{light}\n@media (prefers-color-scheme: dark) {{ {dark} }}\n{payload.chart_style()}"
                return Response(style, media_type="text/css")
            case name if name in _STATIC:
                content = resources.files(__package__).joinpath(name).read_bytes()
                return Response(content, media_type=_STATIC[name])
        raise HTTPException(404, "There is nothing of that name.")

    async def _of_contacts(self, question: str, **words: Any) -> Response:
        """Answer what concerns cases and contacts."""
        return JSONResponse(await self.contacts.ask(question, **words, surfaces=str(self.surfaces)))

    async def press(self, request: Request) -> Response:
        """Press the sample of a case to an approach."""
        found = await _typed_in(request)
        share = found.get("share")
        if not (share is None or (isinstance(share, int | float) and 0 <= share <= 1)):
            raise HTTPException(400, "The share lies between 0 and 1.")
        return await self._of_contacts("press", **_form(found), share=share, whole=found.get("whole") is True)

    async def check(self, request: Request) -> Response:
        """Read a case from its form."""
        return await self._of_contacts("check", **_form(await _typed_in(request)))

    async def fill(self, request: Request) -> Response:
        """Read a case file into the form."""
        text = (await _typed_in(request)).get("text")
        if not isinstance(text, str):
            raise HTTPException(400, "The question has no text.")
        return await self._of_contacts("fill", text=text)

    async def fill_from_run(self, request: Request) -> Response:
        """Read the case of a run into the form."""
        return await self._of_contacts("fill", text=stored_runs.case_of_run(self._run(request)))

    # --- surfaces

    async def list_surfaces(self, request: Request) -> Response:
        """List surfaces that were uploaded."""
        return JSONResponse(stored_runs.uploaded(self.surfaces))

    async def take_surface(self, request: Request) -> Response:
        """Receive a surface, and keep it if anybody can read it."""
        size = request.headers.get("content-length", "")
        announced = int(size) if size.isascii() and size.isdigit() and len(size) < LONGEST_SIZE else None
        name = request.query_params.get("name", "")
        file = await stored_runs.receive(self.surfaces, name, announced, request.stream())
        try:
            told = await self.files.ask("examine", path=str(file))
        except BaseException:
            stored_runs.remove_kept(file.parent)
            raise
        return JSONResponse(told | {"id": file.parent.name, "name": file.name})

    async def clear_surfaces(self, request: Request) -> Response:
        """Delete the surfaces that no run uses; tell which are left."""
        stored_runs.remove_unnamed(self.surfaces, self.runs)
        return JSONResponse(stored_runs.uploaded(self.surfaces))

    # --- runs

    def _run(self, request: Request) -> Path:
        """Folder of the run that a path names."""
        folder = stored_runs.folder_of(self.runs, request.path_params["run"])
        if folder is None:
            raise HTTPException(404, "There is no such run.")
        return folder

    def _far(self, folder: Path) -> dict[str, Any]:
        """What a run is, and how far."""
        return stored_runs.told_of(folder) | self.jobs.told(folder.name)

    async def list_runs(self, request: Request) -> Response:
        """List all runs, the latest first."""
        found = map(self._far, stored_runs.kept_in(self.runs))
        return JSONResponse(sorted(found, key=lambda run: str(run["created"]), reverse=True))

    async def start_run(self, request: Request) -> Response:
        """Keep a case that is right, and roll it."""
        found = await _typed_in(request)
        form = _form(found)
        name = str(found.get("name", ""))
        told = await self.contacts.ask("check", **form, surfaces=str(self.surfaces))
        facts = {"kind": form["kind"], "name": name, "changed": told["changed"]}
        identifier = stored_runs.keep_run(self.runs, told["toml"], **facts)
        try:
            self.jobs.start(self.runs / identifier)
        except AsperityError:  # too many wait: it is not kept as one that was begun
            stored_runs.remove_kept(self.runs / identifier)
            raise
        return JSONResponse({"id": identifier})

    async def state(self, request: Request) -> Response:
        """Tell what became of a run, or how far it is."""
        return JSONResponse(self._far(self._run(request)))

    async def view(self, request: Request) -> Response:
        """Send what there is to be seen of a run that is done."""
        path = _result_of(self._run(request))
        return JSONResponse(await self.files.ask("view", path=path))

    async def cancel(self, request: Request) -> Response:
        """End a run."""
        await self.jobs.cancel(self._run(request).name)
        return await self.state(request)

    async def go_on(self, request: Request) -> Response:
        """Roll a run that ended too early; what of it is finished is not computed again."""
        folder = self._run(request)
        if not stored_runs.is_own(folder, stored_runs.RESULT):
            self.jobs.start(folder)
        return await self.state(request)

    async def delete(self, request: Request) -> Response:
        """End a run, and delete all of it."""
        folder = self._run(request)
        await self.jobs.cancel(folder.name)
        stored_runs.remove_kept(folder)
        return JSONResponse({})

    async def send_file(self, request: Request) -> Response:
        """Send a file of a run: its result, its case, its report with the numbers of its figures, its sounds.

        The report is written when it is asked for first.
        """
        folder = self._run(request)
        name = request.path_params["name"]
        done = stored_runs.is_own(folder, stored_runs.RESULT)
        if name == stored_runs.REPORT and done and not (folder / name).exists():
            await self.files.ask("report", path=_result_of(folder))
        return _handed_out(folder, name)

    async def compare(self, request: Request) -> Response:
        """Show runs beside each other, the first as the reference."""
        found = [stored_runs.folder_of(self.runs, each) for each in request.query_params.getlist("run")]
        folders = [folder for folder in found if folder is not None]
        if not 2 <= len(folders) <= MOST_COMPARED:
            raise HTTPException(400, f"Two to {MOST_COMPARED} runs can be compared.")
        paths = [_result_of(folder) for folder in folders]
        names = [str(stored_runs.told_of(folder)["name"]) for folder in folders]
        return JSONResponse(await self.files.ask("compare", paths=paths, names=names))


async def _told(request: Request, error: Exception) -> Response:
    """What is wrong with the input, as an answer that the page shows."""
    errors = error.errors if isinstance(error, Refused) else [str(error)]
    if isinstance(error, stored_runs.TooLarge):
        return JSONResponse({"errors": errors}, 413, {"connection": "close"})
    return JSONResponse({"errors": errors}, 422)


async def _typed_in(request: Request) -> dict[str, Any]:
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


def _result_of(folder: Path) -> str:
    """Path of the result of a run, which is a file of its folder where there is one."""
    result = folder / stored_runs.RESULT
    if result.exists() and not stored_runs.is_own(folder, result.name):
        raise HTTPException(404, "There is no such file.")
    return str(result)


def _handed_out(folder: Path, name: str) -> Response:
    """A file of a run, to be looked at or taken away."""
    if (file := stored_runs.file_of_run(folder, name)) is None:
        raise HTTPException(404, "There is no such file.")
    policy = {"content-security-policy": REPORT_POLICY} if file.suffix in (".html", ".svg") else {}
    if file.suffix in (".html", ".wav", ".svg", ".png"):
        return FileResponse(file, filename=file.name, content_disposition_type="inline", headers=policy)
    return FileResponse(file, filename=f"{folder.name}-{file.name}")
