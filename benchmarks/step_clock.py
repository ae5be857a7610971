"""What a step of a run costs, from what the rolling reports as it goes."""

from __future__ import annotations

import time


class Clock:
    """CPU time against steps done: the start of a run is left out."""

    def __init__(self) -> None:
        self.marks: list[tuple[int, float]] = []

    def __call__(self, done: int, total: int, message: str) -> None:
        """Mark the steps done."""
        self.marks.append((done, time.process_time()))

    @property
    def seconds_per_step(self) -> float:
        """From the first report to the last, s."""
        (first, began), (last, ended) = self.marks[0], self.marks[-1]
        return (ended - began) / (last - first)
