"""A speed that changes in the course of time: how far it has brought something, and when it is where."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from asperity.arguments import Array, ArrayLike, finite_array, require
from asperity.errors import InputError
from asperity.written_numbers import count_of, rounded

MOST_POINTS = 600
"""Points of a course: a case file holds so many."""
FEWEST_POINTS = 2
FEWEST_TURNS = 4.0
"""Turns of a record that is looked at over angle, at least."""


class SpeedCourse(float):
    """A speed that changes: straight between points in time, constant before the first and after the last.

    As a number it is its fastest, by which steps of time, loads and limits are chosen. Time counts from where
    a record starts; the run-in before it goes at the first speed.

    Parameters
    ----------
    times : array_like (n,)
        Rising, the first from zero on, s.
    speeds : array_like (n,)
        All above zero: m/s of what rolls, turns per second of what turns.

    Examples
    --------
    >>> run_up = SpeedCourse([0.0, 5.0], [10.0, 30.0])
    >>> f"{run_up:.0f} 1/s at most, {float(run_up.covered(5.0)):.0f} turns"
    '30 1/s at most, 100 turns'
    """

    times: Array
    speeds: Array

    def __new__(cls, times: ArrayLike, speeds: ArrayLike) -> SpeedCourse:
        """Take the points of a course that moves on all the time."""
        what = "times of a course (s)"
        allowed = "rising times, from zero on"
        at = finite_array(what, times, allowed, shape=(None,), rising=True, at_least=0.0)
        over = finite_array("speeds of a course", speeds, "one for each time", count=len(at))
        allowed = f"{FEWEST_POINTS} to {MOST_POINTS}"
        require(FEWEST_POINTS <= len(at) <= MOST_POINTS, "course", count_of(len(at), "point"), allowed)
        if over.min() <= 0.0:
            received = f"{over.min():g} at {at[over.argmin()]:g} s"
            remedy = "Begin and end it slowly: what stands still or turns back is not followed."
            raise InputError("speed", received, "speeds above zero all the time", remedy)
        course = super().__new__(cls, over.max())
        course.times = at
        course.speeds = over
        return course

    @property
    def slowest(self) -> float:
        """Its slowest speed."""
        return float(self.speeds.min())

    @property
    def end(self) -> float:
        """When it changes no more, s."""
        return float(self.times[-1])

    def at(self, time: ArrayLike) -> Array:
        """Speeds at some times, s."""
        return np.interp(np.asarray(time, dtype=float), self.times, self.speeds)

    def covered(self, time: ArrayLike) -> Array:
        """How far it has brought something since time zero, m or turns: the integral of the speed."""
        t = np.asarray(time, dtype=float)
        speeds = self.speeds
        times = np.concatenate([[0.0], self.times])  # at the first speed up to the first point
        held = np.concatenate([speeds[:1], speeds])
        done = np.concatenate([[0.0], np.cumsum(0.5 * (held[1:] + held[:-1]) * np.diff(times))])
        k = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 1)
        since = t - times[k]
        steady = (t < 0.0) | (k == len(times) - 1)
        rise = np.append(np.diff(held) / np.maximum(np.diff(times), np.finfo(float).tiny), 0.0)
        return done[k] + since * (held[k] + np.where(steady, 0.0, 0.5 * rise[k] * since))

    def reached(self, distance: float) -> float:
        """When it has brought something so far from where it was at time zero, s."""
        if distance <= 0.0:
            return distance / float(self.speeds[0])
        marks = np.append(self.covered(self.times), np.inf)
        k = int(np.searchsorted(marks, distance)) - 1
        start = 0.0
        speed = float(self.speeds[0])
        rise = 0.0
        left = distance
        if k >= 0:
            start = float(self.times[k])
            speed = float(self.speeds[k])
            left = distance - float(marks[k])
            if k + 1 < len(self.times):
                rise = float((self.speeds[k + 1] - self.speeds[k]) / (self.times[k + 1] - self.times[k]))
        # the smaller root of v t + a t²/2 = s, in the form that holds for a = 0, too
        return start + 2.0 * left / (speed + math.sqrt(max(speed**2 + 2.0 * rise * left, 0.0)))

    @property
    def points(self) -> list[list[float]]:
        """Its times and speeds, point by point."""
        return [[float(time), float(speed)] for time, speed in zip(self.times, self.speeds, strict=True)]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SpeedCourse) and self.points == other.points

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash((self.times.tobytes(), self.speeds.tobytes()))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.times.tolist()}, {self.speeds.tolist()})"

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return SpeedCourse, (self.times, self.speeds)


def covered(speed: float, time: float) -> float:
    """How far a speed, constant or not, has brought something since time zero; negative before it."""
    return float(speed.covered(time)) if isinstance(speed, SpeedCourse) else speed * time


def reached(speed: float, distance: float) -> float:
    """When a speed, constant or not, has brought something so far from where it was at time zero, s."""
    return speed.reached(distance) if isinstance(speed, SpeedCourse) else distance / speed


def slowest(speed: float) -> float:
    """A speed that is constant, or the slowest of one that is not."""
    return speed.slowest if isinstance(speed, SpeedCourse) else speed


def at_fastest(speed: float, unit: str = "m/s", factor: float = 1.0) -> str:
    """Of which speed a number is that takes one which changes at its fastest; nothing of a constant one."""
    return f", at the fastest, {rounded(factor * speed, 5)} {unit}" if isinstance(speed, SpeedCourse) else ""


def speed_at(speed: float, time: Array) -> Array:
    """A speed, constant or not, at some times (n,), s."""
    return speed.at(time) if isinstance(speed, SpeedCourse) else np.full(np.shape(time), speed)
