"""Work that holds the interpreter, shared out among processes forked from this one."""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import IO, Any, TypeVar

T = TypeVar("T")

_TICKET = 2
"""Bytes of an item's number, in the pipe that all processes take their next one from."""


def in_processes(task: Callable[[T], Any], items: Sequence[T], count: int) -> list[Any]:
    """Run a task on each item in `count` processes, this one among them; results in the order of the items.

    Results are what JSON carries. Each process takes the next item when it has done one. What a process does
    not tell, because it failed, is done here; and all of it where no process can be forked. Not for programs
    with threads: none of them lives on in a fork.
    """
    tickets, numbers = os.pipe()
    with os.fdopen(tickets, "rb", buffering=0) as waiting:
        with os.fdopen(numbers, "wb", buffering=0) as given:
            given.write(b"".join(k.to_bytes(_TICKET) for k in range(len(items))))
        others = _forks(task, items, waiting, min(count, len(items)) - 1)
        try:
            done = dict(_done(task, items, waiting))
            for _, told in others:
                done |= _heard(told)
        finally:
            for process, told in others:
                told.close()
                os.kill(process, signal.SIGKILL)
                os.waitpid(process, 0)
    return [done[k] if k in done else task(item) for k, item in enumerate(items)]


def _done(task: Callable[[T], Any], items: Sequence[T], waiting: IO[bytes]) -> Iterator[tuple[int, Any]]:
    """Do one item after the other, as long as there are any."""
    while ticket := waiting.read(_TICKET):
        k = int.from_bytes(ticket)
        yield k, task(items[k])


def _forks(
    task: Callable[[T], Any], items: Sequence[T], waiting: IO[bytes], count: int
) -> list[tuple[int, IO[str]]]:
    """Start so many processes, or as many as can be had."""
    found: list[tuple[int, IO[str]]] = []
    if hasattr(os, "fork"):
        with suppress(OSError):
            while len(found) < count:
                found.append(_fork(task, items, waiting))
    return found


def _fork(task: Callable[[T], Any], items: Sequence[T], waiting: IO[bytes]) -> tuple[int, IO[str]]:
    """Start a process that does items until none is left; its number, and what it tells at its end."""
    assert sys.platform != "win32"
    heard, told = os.pipe()
    try:
        process = os.fork()
    except OSError:
        os.close(heard)
        os.close(told)
        raise
    if process:
        os.close(told)
        return process, os.fdopen(heard, encoding="utf-8")
    try:
        os.close(heard)
        with os.fdopen(told, "w", encoding="utf-8") as answer:
            json.dump(list(_done(task, items, waiting)), answer)
    finally:
        os._exit(0)  # nothing of the program that it was forked from may go on


def _heard(told: IO[str]) -> dict[int, Any]:
    """Read what a process has done; nothing of one that did not come to its end."""
    try:
        return dict(json.load(told))
    except ValueError:
        return {}
