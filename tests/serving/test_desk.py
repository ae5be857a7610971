"""Whoever answers may hang or end: the next question is answered all the same."""

import asyncio

import pytest

from asperity.serving.desk import Desk, Refused

VALUES = {"kind": "ball-on-beam", "values": {"surface.rms": "0.1 um"}, "surfaces": "/nowhere"}


def test_a_process_that_ends_is_replaced():
    async def asked():
        desk = Desk(60.0)
        try:
            first = await desk.ask("check", **VALUES)
            desk._process.kill()
            with pytest.raises(Refused, match="ended the process"):
                await desk.ask("check", **VALUES)
            assert await desk.ask("check", **VALUES) == first
            with pytest.raises(Refused, match="speed: received 'fast'"):
                await desk.ask("check", **VALUES | {"values": {"speed": "fast", "surface.rms": "0.1 um"}})
            with pytest.raises(Refused, match="kind: received 'none'"):
                await desk.ask("check", **VALUES | {"kind": "none"})
        finally:
            await desk.end()
        return first

    first = asyncio.run(asked())
    assert 'rms = "0.1 um"' in first["toml"]
    assert first["changed"] == "surface.rms 0.1 um"


def test_an_answer_that_takes_too_long_is_not_waited_for():
    async def asked():
        desk = Desk(0.01)
        with pytest.raises(Refused, match="takes more than 0 s"):
            await desk.ask("check", **VALUES)
        assert desk._process is None

    asyncio.run(asked())
