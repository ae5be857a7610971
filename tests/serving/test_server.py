"""The server without a browser: nobody gets past its guard, what is wrong is told, and nothing piles up."""

import asyncio
import importlib.util
import json
import socket

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the extra app is not installed")
pytest.importorskip("uvicorn", reason="the extra app is not installed")

from starlette.responses import PlainTextResponse

from asperity.serving import routes, stored_runs
from asperity.serving.server import PAGE_POLICY, Guard, new_token
from asperity.serving.worker_processes import Job, Questions, Refused
from command_line import call

TOKEN, PORT = "a-token", 8000
HOST = {"host": f"127.0.0.1:{PORT}"}
FOLLOWED = {"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}


def asked(app, path, method="GET", headers=(), body=b""):
    """Status, headers and text of an answer."""
    sent, coming = [], [{"type": "http.request", "body": body, "more_body": False}]

    async def receive():
        return coming.pop() if coming else {"type": "http.disconnect"}

    async def send(message):
        sent.append(message)

    path, _, query = path.partition("?")
    raw = [(name.encode(), value.encode()) for name, value in dict(headers).items()]
    scope = {"type": "http", "method": method, "path": path, "headers": raw, "query_string": query.encode()}
    asyncio.run(app(scope, receive, send))
    found = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
    return sent[0]["status"], found, b"".join(part.get("body", b"") for part in sent[1:]).decode()


# --- the guard


def guarded(path, headers, method="GET"):
    """Status, headers and path that the page sees, empty where it is not asked."""

    async def page(scope, receive, send):
        await PlainTextResponse(f"inside {scope['path']}")(scope, receive, send)

    status, found, text = asked(Guard(page, TOKEN, PORT), path, method, headers)
    return status, found, text.removeprefix("inside ") if text.startswith("inside ") else ""


def test_the_page_itself_is_let_through_without_its_token():
    status, headers, path = guarded(f"/{TOKEN}/ask/runs", HOST | {"sec-fetch-site": "same-origin"})
    assert (status, path) == (200, "/ask/runs")
    assert headers["content-security-policy"] == PAGE_POLICY
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cache-control"] == "no-store"
    assert headers["x-content-type-options"] == "nosniff"
    assert guarded(f"/{TOKEN}/", HOST | FOLLOWED)[0] == 200  # a link that was followed
    status, headers, path = guarded(f"/{TOKEN}", HOST)
    assert (status, headers["location"], path) == (307, f"/{TOKEN}/", "")


PAGE = f"/{TOKEN}/"
ORIGINS = ("http://evil.example", "null", f"https://127.0.0.1:{PORT}", "http://127.0.0.1:1")
BARRED = [
    # without the token nothing is said
    *(("GET", path, HOST) for path in (
        "/", "", "/ask/runs", "/a-toke/", "/a-tokem/ask/runs", "/A-TOKEN/", "//a-token/", "/ä/")),
    # DNS rebinding: the browser believes it talks to the foreign name, and says so
    *(("GET", PAGE, {"host": host}) for host in (
        "evil.example", f"evil.example:{PORT}", "127.0.0.1", "127.0.0.1:1", "",
        f"127.0.0.1.evil.example:{PORT}")),
    # foreign pages, even with the token
    *((method, PAGE, HOST | foreign) for method in ("GET", "POST") for foreign in (
        *({"origin": origin} for origin in ORIGINS),
        {"sec-fetch-site": "cross-site"},
        {"sec-fetch-site": "same-site"},
        FOLLOWED | {"sec-fetch-dest": "iframe"})),
    ("POST", PAGE, HOST | FOLLOWED),  # a form that was sent
]  # fmt: skip


@pytest.mark.parametrize(("method", "path", "headers"), BARRED)
def test_nobody_else_gets_past_the_guard(method, path, headers):
    assert guarded(path, headers, method)[::2] == (403, "")


def test_tokens_are_long_and_differ():
    found = {new_token() for _ in range(50)}
    assert len(found) == 50
    assert min(map(len, found)) >= 32


# --- addresses


@pytest.fixture
def server(tmp_path, monkeypatch):
    """A server whose questions about cases and files are answered at once, by what was asked."""
    found = routes.Server(tmp_path)

    async def told(question, **arguments):
        return {"toml": "kind = 'x'", "changed": "", "asked": question}

    for questions in (found.contacts, found.files):
        monkeypatch.setattr(questions, "ask", told)
    return found


def ask(server, path, question=None):
    """Status and answer of the server."""
    method = "GET" if question is None else "POST"
    return asked(server.app(), path, method, body=json.dumps(question).encode())[::2]


def run_of(server):
    return server.runs / stored_runs.keep_run(server.runs, "kind = 'x'", kind="x", name="a", changed="")


@pytest.mark.parametrize(
    ("path", "question", "status", "words"),
    [
        ("/ask/press", {"kind": "x", "values": {}, "share": 2}, 400, "The share lies between 0 and 1."),
        ("/ask/check", {"kind": "x"}, 400, "The question has no values."),
        ("/ask/check", [1], 400, "The question is no JSON object."),
        ("/ask/check", "x" * 2**24, 413, "The question is too long."),
        ("/ask/fill", {}, 400, "The question has no text."),
        ("/ask/compare?run=a&run=b", None, 400, "Two to 4 runs can be compared."),
        ("/runs/0000000000000000/state", None, 404, "There is no such run."),
        ("/routes.py", None, 404, "There is nothing of that name."),
    ],
)
def test_questions_that_are_none_are_told_so(server, path, question, status, words):
    assert ask(server, path, question) == (status, words)


def test_what_is_announced_too_large_is_refused_at_once(server):
    vast = {"content-length": str(2**30)}
    status, headers, words = asked(server.app(), "/ask/surfaces?name=vast.npy", "POST", vast)
    assert (status, headers["connection"]) == (413, "close")
    assert "received 1 GiB or more; allowed: at most 256 MiB" in words


@pytest.mark.parametrize("ending", ["html", "svg", "nc"])
def test_what_may_hold_scripts_is_shown_in_a_sandbox(server, ending):
    folder = run_of(server)
    (folder / f"file.{ending}").write_text("x")
    status, headers, _ = asked(server.app(), f"/runs/{folder.name}/file.{ending}")
    assert status == 200
    policy = headers.get("content-security-policy", "")
    assert ("sandbox allow-scripts" in policy) == ("default-src 'none'" in policy) == (ending != "nc")
    assert "allow-same-origin" not in policy
    assert "connect-src" not in policy
    assert headers["content-disposition"].partition(";")[0] == ("attachment" if ending == "nc" else "inline")


def test_a_run_that_a_full_queue_refuses_is_not_kept(server, monkeypatch):
    monkeypatch.setattr("asperity.serving.worker_processes.MOST_WAITING", -1)
    status, words = ask(server, "/ask/runs", {"kind": "ball-on-beam", "values": {}})
    assert status == 422
    assert "runs that wait" in words
    assert ask(server, "/ask/runs") == (200, "[]")


@pytest.mark.parametrize("contents", [None, b"\xff\x00\x01", b"kind = '\xe9'"])
def test_a_case_that_is_damaged_or_missing_is_told(server, contents):
    file = run_of(server) / "case.toml"
    if contents is None:
        file.unlink()
    else:
        file.write_bytes(contents)
    status, words = ask(server, f"/runs/{file.parent.name}/values")
    assert status == 422
    assert "the case of" in words


@pytest.mark.parametrize(
    "facts", [b"[" * 100_000, b'{"name": NaN, "created": [1]}', b'{"name": "\\ud800"}', b"\xff", b"[1, 2"]
)
def test_damaged_facts_of_a_run_are_left_out(server, facts):
    folder = run_of(server)
    (folder / "run.json").write_bytes(facts)
    (folder / "outcome.json").write_bytes(facts)
    status, words = ask(server, "/ask/runs")
    assert status == 200
    assert json.loads(words)[0]["id"] == folder.name


def test_surfaces_that_no_run_uses_can_be_deleted(server):
    files = [server.surfaces / f"{number:016x}" / "map.npy" for number in range(2)]
    for file in files:
        file.parent.mkdir(parents=True)
        np.save(file, np.eye(3))
    (run_of(server) / "case.toml").write_text(f'[surface]\nfile = "{files[1]}"\n')
    status, words = ask(server, "/ask/surfaces/clear", {})
    assert status == 200
    assert [each["id"] for each in json.loads(words)] == [f"{1:016x}"]


# --- who answers


def test_a_process_that_ends_or_takes_too_long_is_replaced():
    """Whoever answers may hang or end: the next question is answered all the same."""
    good = {"kind": "ball-on-beam", "values": {"surface.rms": "0.1 um"}, "surfaces": "/nowhere"}

    async def asked():
        questions = Questions(60.0)
        try:
            first = await questions.ask("check", **good)
            questions.worker.process.kill()
            with pytest.raises(Refused, match="ended the process"):
                await questions.ask("check", **good)
            assert await questions.ask("check", **good) == first
            for wrong, message in (
                ({"values": {"speed": "fast", "surface.rms": "0.1 um"}}, "speed: received 'fast'"),
                ({"kind": "none"}, "kind: received 'none'"),
                ({"surfaces": 1}, "The program failed with TypeError"),
            ):
                with pytest.raises(Refused, match=message):
                    await questions.ask("check", **good | wrong)
            questions.seconds = 0.0
            with pytest.raises(Refused, match="takes more than 0 s"):
                await questions.ask("check", **good)
            assert questions.worker is None
        finally:
            await questions.end()
        return first

    first = asyncio.run(asked())
    assert 'rms = "0.1 um"' in first["toml"]
    assert first["changed"] == "surface.rms 0.1 um"


def test_a_run_tells_how_far_it_is_and_how_long_the_rest_of_a_piece_takes(monkeypatch, tmp_path):
    job, clock = Job(tmp_path), iter([100.0, 104.0, 104.0])
    monkeypatch.setattr("asperity.serving.worker_processes.time.monotonic", lambda: next(clock))
    assert job.told()["state"] == "waiting"
    job.worker = "a process"
    job.hear(10, 60, "scan")
    assert job.told()["left"] is None
    job.hear(30, 60, "scan")
    far = {"message": "scan", "done": 30, "total": 60, "left": 4.0 * 30 / 20}
    assert job.told() == {"state": "running", **far}


# --- the command


def test_without_the_extra_it_says_what_to_install(tmp_path, monkeypatch):
    found = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *more: None if name == "uvicorn" else found(name, *more)
    )
    told = call("serve", "-o", str(tmp_path / "page"), code=2).stderr
    assert 'no uvicorn; allowed: the extra app. Install them: python -m pip install "asperity[app]".' in told
    assert not (tmp_path / "page").exists()


def test_a_port_or_a_folder_that_cannot_be_used_is_said(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        told = call("serve", "-o", str(tmp_path), "--port", str(port), code=2).stderr
    assert f"port: received {port} (Address already in use); allowed: a free port of this machine." in told
    assert "Choose another one with --port" in told
    for port in ("-1", "70000"):
        assert f"'--port': {port} is not in the range" in call("serve", "--port", port, code=2).stderr
    (tmp_path / "page").write_text("x")
    assert "Choose another folder with -o." in call("serve", "-o", str(tmp_path / "page"), code=2).stderr
