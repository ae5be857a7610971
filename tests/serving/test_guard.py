"""Nobody without the token, no foreign page and no foreign name gets past the guard."""

import asyncio

import pytest

pytest.importorskip("starlette", reason="the extra app is not installed")

from starlette.responses import PlainTextResponse

from asperity.serving.guard import PAGE_POLICY, Guard, new_token, policy_of

TOKEN, PORT = "a-token", 8000
HOST = {"host": f"127.0.0.1:{PORT}"}


def answer(path, headers, method="GET"):
    """Status, headers and path that the page sees, None where it is not asked."""
    seen, sent = [], []

    async def page(scope, receive, send):
        seen.append(scope["path"])
        await PlainTextResponse("inside")(scope, receive, send)

    async def receive():
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message):
        sent.append(message)

    raw = [(name.encode(), value.encode()) for name, value in headers.items()]
    scope = {"type": "http", "method": method, "path": path, "headers": raw, "query_string": b""}
    asyncio.run(Guard(page, TOKEN, PORT)(scope, receive, send))
    found = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
    return sent[0]["status"], found, seen[0] if seen else None


def test_the_page_itself_is_let_through_without_its_token():
    status, headers, path = answer(f"/{TOKEN}/ask/runs", HOST | {"sec-fetch-site": "same-origin"})
    assert (status, path) == (200, "/ask/runs")
    assert headers["content-security-policy"] == PAGE_POLICY
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cache-control"] == "no-store"
    assert headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize(
    "path", ["/", "", "/ask/runs", "/a-toke/", "/a-tokem/ask/runs", "/A-TOKEN/", "//a-token/", "/ä/"]
)
def test_without_the_token_nothing_is_said(path):
    status, _, seen = answer(path, HOST)
    assert (status, seen) == (403, None)


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        f"evil.example:{PORT}",
        "127.0.0.1",
        "127.0.0.1:1",
        "",
        f"127.0.0.1.evil.example:{PORT}",
    ],
)
def test_a_foreign_name_that_leads_here_is_refused(host):
    """DNS rebinding: the browser believes it talks to the foreign name, and says so."""
    assert answer(f"/{TOKEN}/", {"host": host})[::2] == (403, None)


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize(
    "headers",
    [
        {"origin": "http://evil.example"},
        {"origin": "null"},
        {"origin": f"https://127.0.0.1:{PORT}"},
        {"origin": "http://127.0.0.1:1"},
        {"sec-fetch-site": "cross-site"},
        {"sec-fetch-site": "same-site"},
        {"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate", "sec-fetch-dest": "iframe"},
    ],
)
def test_foreign_pages_are_refused_even_with_the_token(method, headers):
    assert answer(f"/{TOKEN}/ask/runs", HOST | headers, method)[::2] == (403, None)


def test_a_link_may_be_followed_but_no_form_be_sent():
    followed = {"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}
    assert answer(f"/{TOKEN}/", HOST | followed)[0] == 200
    assert answer(f"/{TOKEN}/ask/runs", HOST | followed, "POST")[::2] == (403, None)


def test_the_address_without_its_last_stroke_leads_to_the_page():
    status, headers, seen = answer(f"/{TOKEN}", HOST)
    assert (status, headers["location"], seen) == (307, f"/{TOKEN}/", None)


def test_tokens_are_long_and_differ():
    found = {new_token() for _ in range(50)}
    assert len(found) == 50
    assert min(map(len, found)) >= 32


@pytest.mark.parametrize("ending", [".html", ".svg"])
def test_what_may_hold_scripts_is_shown_in_a_sandbox(ending):
    policy = policy_of(ending)["content-security-policy"]
    assert "sandbox allow-scripts" in policy
    assert "allow-same-origin" not in policy
    assert "default-src 'none'" in policy
    assert "connect-src" not in policy
    assert policy_of(".wav") == {}
