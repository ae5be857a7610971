"""Asks the process that answers the page's questions, and starts another where it ends or takes too long."""

from __future__ import annotations

import asyncio
import json
import sys
from contextlib import suppress
from typing import Any

from asperity.interrupts import no_interrupt_for_children

_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]); "
    "from asperity.serving.{module} import {function}; {function}()"
)
LONGEST_ANSWER = 2**27  # bytes
BACK = 2.0
"""Time that a process has to go before it is told more plainly, s."""


class Refused(Exception):
    """The question has no answer: what is wrong, one message each."""

    def __init__(self, errors: list[str]) -> None:
        self.errors = errors
        super().__init__("; ".join(errors))


async def start_apart(module: str, function: str, *words: str) -> asyncio.subprocess.Process:
    """Start a function of the serving package in a process of its own, which Ctrl-C does not reach."""
    code = _START.format(module=module, function=function)
    with no_interrupt_for_children():
        return await asyncio.create_subprocess_exec(
            sys.executable, "-c", code, json.dumps(sys.path), *words,
            stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.DEVNULL,
            limit=LONGEST_ANSWER,
        )  # fmt: skip


async def end_apart(process: asyncio.subprocess.Process) -> None:
    """End a process, and wait until it has ended: the end of its input lets it go by itself."""
    assert process.stdin is not None
    process.stdin.close()
    for end in (process.terminate, process.kill):
        with suppress(TimeoutError):
            await asyncio.wait_for(process.wait(), BACK)
            return
        with suppress(ProcessLookupError):
            end()
    await process.wait()


class Desk:
    """One process that answers questions, one after the other."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds  # that an answer may take
        self._process: asyncio.subprocess.Process | None = None
        self._turn = asyncio.Lock()

    async def ask(self, question: str, **arguments: Any) -> dict[str, Any]:
        """Ask a question of `answering`, and wait for the answer; `Refused` says why there is none."""
        line = json.dumps({"question": question, **arguments}).encode() + b"\n"
        async with self._turn:
            process = await self._ready()
            try:
                assert process.stdin is not None
                assert process.stdout is not None
                process.stdin.write(line)
                await process.stdin.drain()
                answer = await asyncio.wait_for(process.stdout.readline(), self.seconds)
            except TimeoutError:
                await self.end()
                raise Refused(
                    [f"This takes more than {self.seconds:.0f} s. Run it with 'asperity run'."]
                ) from None
            except OSError:
                answer = b""
            except BaseException:  # nobody waits any more: the next answer must not be this one
                await self.end()
                raise
            if not answer:
                await self.end()
                raise Refused(["What was asked ended the process that answers. Is the file damaged?"])
        told: dict[str, Any] = json.loads(answer)
        if "refused" in told:
            raise Refused(told["refused"])
        return told

    async def _ready(self) -> asyncio.subprocess.Process:
        if self._process is None or self._process.returncode is not None:
            self._process = await start_apart("answering", "answer_all")
        return self._process

    async def end(self) -> None:
        """End the process."""
        if self._process is not None:
            await end_apart(self._process)
            self._process = None
