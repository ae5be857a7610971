"""Addresses of the page without a browser: what is damaged or too much is told, and nothing piles up."""

import asyncio
import json
import os

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the extra app is not installed")

from asperity.serving import routes
from asperity.serving.kept_runs import keep_run
from asperity.serving.routes import Server


@pytest.fixture
def server(tmp_path, monkeypatch):
    """A server whose questions about cases and files are answered at once, by what was asked."""
    found = Server(tmp_path)

    async def told(question, **arguments):
        if "folder" in arguments:
            (tmp_path / "comparisons" / arguments["folder"][-16:]).mkdir(parents=True)
        return {"toml": "kind = 'x'", "changed": "", "asked": question}

    for desk in (found.contacts, found.files):
        monkeypatch.setattr(desk, "ask", told)
    return found


def ask(server, path, question=None):
    """Status and answer of the server."""
    sent = []

    async def receive():
        return {"type": "http.request", "body": json.dumps(question).encode(), "more_body": False}

    async def send(message):
        sent.append(message)

    path, _, query = path.partition("?")
    method = "GET" if question is None else "POST"
    scope = {
        "type": "http", "method": method, "path": path, "headers": [], "query_string": query.encode(),
    }  # fmt: skip
    asyncio.run(server.app()(scope, receive, send))
    return sent[0]["status"], b"".join(part.get("body", b"") for part in sent[1:]).decode()


def run_of(server, **facts):
    return server.runs / keep_run(
        server.runs, "kind = 'x'", **{"kind": "x", "name": "a", "changed": ""} | facts
    )


def test_a_run_that_a_full_queue_refuses_is_not_kept(server, monkeypatch):
    monkeypatch.setattr("asperity.serving.jobs.MOST_WAITING", -1)
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


def test_the_latest_comparisons_are_kept_alone(server, monkeypatch):
    monkeypatch.setattr(routes, "MOST_COMPARISONS", 2)
    runs = [run_of(server).name for _ in range(4)]
    for number, other in enumerate(runs[1:]):
        query = f"run={runs[0]}&run={other}"
        page = json.loads(ask(server, f"/ask/compare?{query}")[1])["page"]
        assert ask(server, f"/{page}?{query}")[0] == 404  # nothing was written here but its folder
        os.utime(server.comparisons / page.split("/")[1], (number, number))
    assert len(list(server.comparisons.iterdir())) == 2


def test_surfaces_that_no_run_uses_can_be_deleted(server):
    for number in range(2):
        (server.surfaces / f"{number:016x}").mkdir(parents=True)
        np.save(server.surfaces / f"{number:016x}" / "map.npy", np.eye(3))
    case = run_of(server) / "case.toml"
    case.write_text(f'[surface]\nfile = "{server.surfaces / f"{1:016x}" / "map.npy"}"\n')
    status, words = ask(server, "/ask/surfaces/clear", {})
    assert status == 200
    assert [each["id"] for each in json.loads(words)] == [f"{1:016x}"]
