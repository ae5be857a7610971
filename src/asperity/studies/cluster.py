"""A Dask cluster as the place where the members of a study are computed, and whether it still answers."""

import logging
import time
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager, suppress
from typing import Any

from asperity.errors import ComputationError, InputError, reason

PATIENCE = 20.0
"""How long a scheduler may take to answer, s."""
SILENCE = 60.0
"""How long a scheduler may not answer until it is given up, s."""
GOODBYE = 5.0
"""How long leaving a scheduler may take, s."""


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Connect to a Dask cluster by the address of its scheduler, as ``"tcp://node7:8786"``.

    The executor computes on the workers of the cluster; the scheduler itself repeats what a lost worker had.
    A process computes one member at a time, whatever the number of its threads: start workers of one thread
    each, ``dask worker --nworkers -1 --nthreads 1``, with ``ASPERITY_THREADS=1`` in their environment.
    """
    allowed = "the address of a Dask scheduler that runs, as tcp://127.0.0.1:8786"
    try:
        from distributed import Client
    except ImportError:
        remedy = 'Install it: pip install "asperity[cluster]".'
        raise InputError("scheduler", "no package distributed", allowed, remedy) from None
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)  # what is lost is told in a sentence
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except Exception as error:  # of many kinds, a MemoryError where there is no route
        remedy = "Start one with 'dask scheduler', and workers with 'dask worker'."
        raise InputError("scheduler", f"'{address}' ({reason(error)})", allowed, remedy) from None
    try:
        yield client.get_executor(pure=False)
    finally:
        with suppress(Exception):  # a scheduler that is gone takes no leave
            client.close(timeout=GOODBYE)


class Heart:
    """Whether the scheduler behind an executor of Dask still answers; of other executors nothing is asked.

    Of `members` that it was given `finished` have ended, for the message.
    """

    def __init__(self, executor: Executor, members: int) -> None:
        self._client: Any = getattr(executor, "_client", None)
        self._heard = time.monotonic()
        self.members = members
        self.finished = 0

    def listen(self) -> bool:
        """Ask the scheduler for a sign; return whether it gave one, and fail if it gave none for long."""
        if not hasattr(self._client, "scheduler"):
            return True
        try:
            self._client.sync(self._client.scheduler.identity, callback_timeout=PATIENCE)
            self._heard = time.monotonic()
        except Exception:  # a lost connection shows itself in many ways
            silent = time.monotonic() - self._heard
            if silent >= SILENCE:
                what = (
                    f"the scheduler has not answered for {silent:.0f} s; {self.finished} of {self.members} "
                    "members had ended and are kept"
                )
                remedy = "the same study again when the scheduler runs, or without it: it goes on there"
                raise ComputationError(what, remedy) from None
            return False
        return True
