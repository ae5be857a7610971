"""Runs under way: each in a process of its own, one after the other, with progress, and a way to cancel."""

from __future__ import annotations

import asyncio
import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asperity.errors import InputError
from asperity.serving.desk import Refused, end_apart, start_apart
from asperity.serving.kept_runs import RESULT, forget_outcome, write_outcome

MOST_WAITING = 20
"""Runs that may wait."""


@dataclass
class Job:
    """A run that is under way, or waits."""

    folder: Path
    task: asyncio.Task[None] | None = None
    process: asyncio.subprocess.Process | None = None
    message: str = ""
    done: int = 0
    total: int = 1
    first: int = 0  # of `done`, when this piece of work was first heard of
    since: float = 0.0

    def told(self) -> dict[str, Any]:
        """How far it is."""
        if self.process is None:
            return {"state": "waiting", "message": "waits for the run before it"}
        spent, rest = time.monotonic() - self.since, self.total - self.done
        known = self.done > self.first and rest > 0
        left = spent * rest / (self.done - self.first) if known else None
        return {
            "state": "running", "message": self.message, "done": self.done, "total": self.total, "left": left,
        }  # fmt: skip

    def hear(self, report: dict[str, Any]) -> None:
        """Take a report of the process."""
        if report["message"] != self.message:
            self.message, self.first, self.since = report["message"], report["done"], time.monotonic()
        self.done, self.total = report["done"], report["total"]


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
            received, allowed = f"{len(self._jobs)} runs that wait", f"at most {MOST_WAITING}"
            raise Refused([str(InputError("the runs", received, allowed, "Wait for some, or cancel them."))])
        job = self._jobs[folder.name] = Job(folder)
        job.task = asyncio.create_task(self._roll(job))

    async def _roll(self, job: Job) -> None:
        try:
            async with self._turn:
                forget_outcome(job.folder)
                job.process = await start_apart("rolling_apart", "roll_run", str(job.folder))
                outcome = await _heard(job)
                code = await job.process.wait()
            if not (job.folder / RESULT).is_file():
                words = f"Its process ended (code {code}). Is there enough memory?"
                write_outcome(job.folder, outcome.get("state", "failed"), outcome.get("message", words))
        finally:
            if job.process is not None:
                await end_apart(job.process)
            self._jobs.pop(job.folder.name, None)

    async def cancel(self, identifier: str) -> None:
        """End a run, or let it wait no longer; one that has just ended stays as it is."""
        job = self._jobs.get(identifier)
        if job is None:
            return
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


async def _heard(job: Job) -> dict[str, Any]:
    """Listen to the process of a job until it says how it ended, or says no more."""
    assert job.process is not None
    assert job.process.stdout is not None
    while line := await job.process.stdout.readline():
        report: dict[str, Any] = json.loads(line)
        if "state" in report:
            return report
        job.hear(report)
    return {}
