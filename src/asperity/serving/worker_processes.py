"""Processes that work for the page: those that answer its questions, and those that roll its runs.

One that ends or takes too long is replaced; runs are rolled one after the other, and can be cancelled.
"""

import asyncio
import json
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asperity.errors import InputError
from asperity.files import discard
from asperity.interrupts import no_interrupt_for_children
from asperity.serving.stored_runs import OUTCOME, RESULT, write_outcome
from asperity.written_numbers import count_of

_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]); "
    "from asperity.garbage import seek_seldom; seek_seldom(); "
    "from asperity.serving.worker import {function}; {function}()"
)
LONGEST_ANSWER = 2**27  # bytes
BACK = 2.0
"""Time that a process has to go before it is told more plainly, s."""
MOST_WAITING = 20
"""Runs that may wait."""


class Refused(Exception):
    """The question has no answer: what is wrong, one message each."""

    def __init__(self, errors: list[str]) -> None:
        self.errors = errors
        super().__init__("; ".join(errors))


class WorkerProcess:
    """A function of `worker` in a process of its own, which Ctrl-C does not reach."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        assert process.stdin is not None
        assert process.stdout is not None
        self.process = process
        self.stdin = process.stdin
        self.stdout = process.stdout

    @classmethod
    async def start(cls, function: str, *words: str) -> "WorkerProcess":
        """Start it."""
        code = _START.format(function=function)
        pipe = asyncio.subprocess.PIPE
        with no_interrupt_for_children():
            process = await asyncio.create_subprocess_exec(
                sys.executable, "-c", code, json.dumps(sys.path), *words,
                stdin=pipe, stdout=pipe, stderr=asyncio.subprocess.DEVNULL, limit=LONGEST_ANSWER,
            )  # fmt: skip
        return cls(process)

    async def end(self) -> None:
        """End it, and wait until it has ended: the end of its input lets it go by itself."""
        self.stdin.close()
        for end in (self.process.terminate, self.process.kill):
            with suppress(TimeoutError):
                await asyncio.wait_for(self.process.wait(), BACK)
                return
            with suppress(ProcessLookupError):
                end()
        await self.process.wait()


# --- questions


class Questions:
    """One process that answers questions, one after the other, each in so many seconds."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.worker: WorkerProcess | None = None
        self._turn = asyncio.Lock()

    async def ask(self, question: str, **arguments: Any) -> dict[str, Any]:
        """Ask a question of `worker`, and wait for the answer; `Refused` says why there is none."""
        line = json.dumps({"question": question, **arguments}).encode() + b"\n"
        async with self._turn:
            if self.worker is None or self.worker.process.returncode is not None:
                self.worker = await WorkerProcess.start("answer_all")
            try:
                self.worker.stdin.write(line)
                await self.worker.stdin.drain()
                answer = await asyncio.wait_for(self.worker.stdout.readline(), self.seconds)
            except TimeoutError:
                await self.end()
                words = f"This takes more than {self.seconds:.0f} s. Run it with 'asperity run'."
                raise Refused([words]) from None
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

    async def end(self) -> None:
        """End the process."""
        if self.worker is not None:
            await self.worker.end()
            self.worker = None


# --- runs


@dataclass
class Job:
    """A run that is under way, or waits."""

    folder: Path
    task: asyncio.Task[None] | None = None
    worker: WorkerProcess | None = None
    message: str = ""
    done: int = 0
    total: int = 1
    first: int = 0  # of `done`, when this piece of work was first heard of
    since: float = 0.0

    def told(self) -> dict[str, Any]:
        """How far it is."""
        if self.worker is None:
            return {"state": "waiting", "message": "waits for the run before it"}
        spent = time.monotonic() - self.since
        rest = self.total - self.done
        known = self.done > self.first and rest > 0
        left = spent * rest / (self.done - self.first) if known else None
        far = {"message": self.message, "done": self.done, "total": self.total, "left": left}
        return {"state": "running", **far}

    async def roll(self) -> None:
        """Roll it, and keep what became of it."""
        discard(self.folder / OUTCOME)
        self.worker = await WorkerProcess.start("roll_run", str(self.folder))
        report = {}
        while "state" not in report and (line := await self.worker.stdout.readline()):
            report = json.loads(line)
            if "state" not in report:
                self.hear(**report)
        code = await self.worker.process.wait()
        if not (self.folder / RESULT).is_file():
            words = f"Its process ended (code {code}). Is there enough memory?"
            write_outcome(self.folder, report.get("state", "failed"), report.get("message", words))

    def hear(self, done: int, total: int, message: str) -> None:
        """Take down what its process reports."""
        if message != self.message:
            self.message = message
            self.first = done
            self.since = time.monotonic()
        self.done = done
        self.total = total


class Jobs:
    """All runs that are under way or wait, by the names of their folders."""

    def __init__(self) -> None:
        self._jobs: dict[str, Job] = {}
        self._turn = asyncio.Semaphore(1)

    def told(self, identifier: str) -> dict[str, Any]:
        """How far a run is; nothing if it is not under way."""
        job = self._jobs.get(identifier)
        return job.told() if job else {}

    def start(self, folder: Path) -> None:
        """Roll the case in a folder, when its turn comes."""
        if folder.name in self._jobs:
            return
        if len(self._jobs) > MOST_WAITING:
            received = f"{count_of(len(self._jobs), 'run')} that wait"
            allowed = f"at most {MOST_WAITING}"
            raise InputError("the runs", received, allowed, "Wait for some, or cancel them.")
        job = self._jobs[folder.name] = Job(folder)
        job.task = asyncio.create_task(self._roll(job))

    async def _roll(self, job: Job) -> None:
        try:
            async with self._turn:
                await job.roll()
        finally:
            if job.worker is not None:
                await job.worker.end()
            self._jobs.pop(job.folder.name, None)

    async def cancel(self, identifier: str) -> None:
        """End a run, or let it wait no longer; one that has just ended stays as it is."""
        if (job := self._jobs.get(identifier)) is not None:
            await self._stop(job)
            if not (job.folder / RESULT).is_file():
                write_outcome(job.folder, "cancelled")

    async def _stop(self, job: Job) -> None:
        if job.task is not None:
            job.task.cancel()
            await asyncio.gather(job.task, return_exceptions=True)
        self._jobs.pop(job.folder.name, None)

    async def end(self) -> None:
        """End all runs; they can go on when the server is there again."""
        await asyncio.gather(*map(self._stop, list(self._jobs.values())))
