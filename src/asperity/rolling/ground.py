"""Paths of contacts, and what they roll over: the modes of a structure, a rigid plane, or a rail."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import Array, ArrayLike, positive, real
from asperity.errors import InputError, LargeDeflectionWarning, percent
from asperity.kernels.rail import Channels
from asperity.rolling.resolution import PER_MODE, PER_SLEEPER
from asperity.rolling.steps import Limit, alternating_of_modes, padded, resolved_step
from asperity.speeds import SpeedCourse
from asperity.structures.beam import Beam, SupportedBeam
from asperity.structures.modal import HIGHEST, Modal
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import CELLS, RailBetween, RailPoles, over_the_period
from asperity.structures.track import Track
from asperity.written_numbers import rounded


@dataclass(frozen=True, eq=False)
class Path:
    """Positions of contacts that move at one speed, constant or not."""

    positions: Array  # (c, n), at every time step of run-in and record, m
    speed: float  # m/s, or the course of it
    time_step: float  # s
    settled: int = 0  # steps of the run-in; the record starts behind them

    @classmethod
    def laid(cls, start: float, speed: float, time_step: float, duration: float, settling: float) -> Path:
        """Lay out one contact: a run-in of `settling`, s, and from `start`, m, a record of `duration`, s."""
        for what, value in (("speed (m/s)", speed), ("duration (s)", duration), ("time step (s)", time_step)):
            positive(what, value)
        real("settling (s)", settling, "zero or a finite positive number", at_least=0.0)
        steps, settled = (int(np.floor(time / time_step * (1.0 + 1e-12))) for time in (duration, settling))
        if steps < 1:
            raise InputError("duration (s)", duration, f"at least one time step of {time_step:.6g} s")
        counted = np.arange(-settled, steps + 1)
        if isinstance(speed, SpeedCourse):
            positions = np.asarray(start + speed.covered(time_step * counted))
        else:
            positions = np.asarray(start + speed * time_step * counted)
        return cls(positions[None], speed, time_step, settled)

    def ahead(self, offsets: ArrayLike) -> Path:
        """Contacts that run ahead of the first one of this path by some distances (c,), m."""
        return replace(self, positions=self.positions[0] + np.asarray(offsets)[:, None])

    @property
    def total(self) -> int:
        """Time steps of run-in and record."""
        return self.positions.shape[1] - 1

    @property
    def starts(self) -> Array:
        """Positions of the contacts at step zero (c,), m."""
        return self.positions[:, 0]

    def rates(self, first: int, count: int) -> Array:
        """Speeds of the contacts at steps (count,), from one on, m/s; of a course alone."""
        assert isinstance(self.speed, SpeedCourse)
        return self.speed.at(self.time_step * (np.arange(first, first + count) - self.settled))

    @property
    def time(self) -> Array:
        """Times of the record, s, from zero."""
        return np.asarray(self.time_step * np.arange(self.total + 1 - self.settled))


PLACES = 256
"""Positions at which mode shapes are looked at."""
LARGEST_DEFLECTION = 0.02
"""Share of its length up to which a beam may be displaced: slopes are then below about 0.06."""


@dataclass(frozen=True, eq=False)
class Ground:
    """What is rolled over by n contacts on their paths."""

    natural: Array  # angular frequencies of its modes (s,), rad/s; none of a plane or a rail
    ratios: Array  # (s,), damping ratios
    shapes: Array  # (n, s), under the contacts at the start, kg^(−1/2)
    slopes: Array  # (n, s), likewise, per metre; of a speed that changes times this speed, per second
    sensors: Array  # (sensors, s)
    channels: Channels  # of a rail, else none
    softest: float  # largest static compliance under a contact on its path, m/N; infinite if nothing holds it
    alternating: float  # least alternating compliance of all contacts at once, m/N
    thrown: float  # that of what throws bodies apart: an endless rail carries impacts away
    limit: Limit  # what a time step must resolve
    yields: Array  # (n, n), mean static compliance of a rail, m/N; zero of modes
    bay: float = 0.0  # mass of a bay of rail, kg
    memory: int = 0  # time steps that a rail remembers


def ground_of(over: Modal | RailBetween | None, path: Path, sensors: Array) -> Ground:
    """Look at what is rolled over along a path, and at sensors (k,), m; refuse where it does not fit."""
    return _rail(over, path, sensors) if isinstance(over, RailBetween) else _modes(over, path, sensors)


def _modes(over: Modal | None, path: Path, sensors: Array) -> Ground:
    """A structure by its modes, or a plane that does not move, without any."""
    natural, ratios, n = np.zeros(0), np.zeros(0), len(path.positions)
    if over is not None:
        _refuse_to_leave(over, path)
        natural = 2.0 * np.pi * over.natural_frequencies
        ratios = over.damping_ratios
    elif sensors.size:
        raise InputError("sensors", f"{sensors.size} on a rigid plane", "none: it does not move")

    def shapes(x: Array) -> tuple[Array, Array]:
        none = np.zeros((x.size, natural.size))
        return over.shapes(x) if over is not None and x.size else (none, none)

    chosen = path.positions[:, :: max(1, (path.total + 1) // PLACES)].T
    along = shapes(chosen.ravel())[0].reshape(*chosen.shape, natural.size)
    each = alternating_of_modes(resolved_step(natural, ratios, path.time_step))
    least = float(np.linalg.eigvalsh((along * each) @ along.transpose(0, 2, 1)).min())
    softest = float(((along / natural) ** 2).sum(axis=2).max()) if natural.all() else np.inf
    frequencies = natural / (2.0 * np.pi)
    followed = frequencies[frequencies <= HIGHEST]  # others are meant to be static
    limit = "the highest mode of the structure", float(followed.max(initial=0.0)), PER_MODE
    channels = no_channels(n)
    under, slopes = shapes(path.starts)
    if isinstance(path.speed, SpeedCourse):
        slopes = slopes * path.rates(0, 1)
    seen = shapes(sensors)[0]
    yields = np.zeros((n, n))
    return Ground(natural, ratios, under, slopes, seen, channels, softest, least, least, limit, yields)


def no_channels(n: int) -> Channels:
    """Channels of a rail that is not there, for n contacts."""
    none = np.zeros(0, dtype=np.int64)
    first = np.zeros(n + 1, dtype=np.int64)
    decay, residue, now, scattered = map(np.zeros, ((0, 0), (0, 1, 0), (0, 1), (0, 1, 1)))
    kernels = decay, residue, now, scattered, np.zeros(0, dtype=bool)
    return Channels(none, none, none, first, np.zeros(n), 0.0, *kernels)


def _refuse_to_leave(over: Modal, path: Path) -> None:
    low, high = over.extent
    margin = 1e-9 * (high - low)
    for k, positions in enumerate(path.positions):
        if not (positions[0] >= low - margin and positions[-1] <= high + margin):
            raise InputError(
                f"path of contact {k + 1} (m)",
                f"{positions[0]:.6g} to {positions[-1]:.6g}",
                f"{low:.6g} to {high:.6g}, on the structure",
                "Choose start, duration, run-in and positions so that all contacts stay on it.",
            )


def _rail(rail: RailBetween, path: Path, sensors: Array) -> Ground:
    """A rail, by poles or scattered, between contacts at fixed distances."""
    if isinstance(path.speed, SpeedCourse):
        received = f"{path.speed.slowest:.6g} m/s to {path.speed:.6g} m/s on a rail"
        allowed = (
            "one constant speed: a rail's kernel is that of one, and its waves remember where they began"
        )
        raise InputError("speed", received, allowed, "Roll at several constant speeds.")
    kernel = rail.kernel
    n = len(path.positions)
    given, made = (path.speed, path.time_step), (kernel.speed, kernel.time_step)
    if not np.allclose(given, made, rtol=1e-9, atol=0.0):
        received = f"{given[0]:.6g} m/s in steps of {given[1]:.6g} s"
        allowed = f"{made[0]:.6g} m/s and {made[1]:.6g} s, for which the rail's kernel was computed"
        raise InputError("path", received, allowed, "Compute the moving kernel of this path.")
    if sensors.size:
        allowed = "none: a rail is known under the contacts alone"
        raise InputError("sensors", f"{sensors.size} on a rail", allowed)
    channels, weights = _channels(rail, path.starts)
    found = np.zeros((n, n))
    static = np.array([each.sum(axis=1).mean() for each in weights])
    found[channels.receiver, channels.source] = static[channels.table]
    squares, vectors = np.linalg.eigh(0.5 * (found + found.T))
    none = np.zeros(0)
    modes = np.zeros((n, 0))
    taps = kernel.weights.shape[1]
    softest = float(kernel.weights.sum(axis=1).max())
    least = float((kernel.weights @ (-1.0) ** np.arange(taps)).min())  # of all places in a bay
    limit = "the passing of sleepers v/L", kernel.speed / kernel.track.sleeper_spacing, PER_SLEEPER
    yields = np.asarray((vectors * squares.clip(0.0)) @ vectors.T)
    bay = kernel.track.mass_per_length * kernel.track.sleeper_spacing
    of_modes = none, none, modes, modes, np.zeros((0, 0))
    return Ground(*of_modes, channels, softest, least, 0.0, limit, yields, bay, taps)


def _channels(rail: RailBetween, starts: Array) -> tuple[Channels, list[Array]]:
    """Channels between all contacts within reach, and the weights of the kernels that they carry."""
    tables: list[RailPoles | MovingKernel] = [rail.direct]
    pairs = []
    for source, here in enumerate(starts):
        for receiver, there in enumerate(starts):
            found = rail.direct if source == receiver else rail.between(there - here)
            if found is not None:
                known = [index for index, table in enumerate(tables) if table is found]
                tables += [] if known else [found]
                pairs.append((source, receiver, known[0] if known else len(tables) - 1))
    source, receiver, table = np.array(pairs, dtype=np.int64).T.copy()
    none = np.zeros(0)
    weights = [each.kernel.weights for each in tables]
    bays, period = rail.kernel.track.cell_bays, rail.kernel.track.period
    laid = [
        (each.poles, over_the_period(each.residues, bays), np.zeros((1, 1)))
        if isinstance(each, RailPoles)
        else (none, np.zeros((CELLS * bays + 1, 0)), each.weights)
        for each in tables
    ]
    decay = padded([np.stack([poles.real, poles.imag]) for poles, _, _ in laid])
    residue = padded([np.stack([residues.real, residues.imag], axis=1) for _, residues, _ in laid])
    channels = Channels(
        source=source,
        receiver=receiver,
        table=table,
        first=np.searchsorted(source, np.arange(len(starts) + 1)),
        place=starts / period,
        stride=rail.kernel.speed * rail.kernel.time_step / period,
        decay=decay.reshape(len(tables), -1),
        residue=residue.reshape(len(tables), CELLS * bays + 1, -1),
        now=np.array([over_the_period(each[:, 0], bays) for each in weights]),
        scattered=padded([scattered for *_, scattered in laid]),
        scatters=np.array([not isinstance(each, RailPoles) for each in tables]),
    )
    return channels, weights


@dataclass(frozen=True)
class Small:
    """Lengths against which displacements have to be small, of what is rolled over."""

    name: str
    of: str  # what the length is
    length: float  # m
    meaning: str  # of being more
    check: str  # what to look at


def small_motion(over: Modal | RailBetween | Track | None) -> Small | None:
    """Against what displacements have to be small; None of a plane, and of what has no ends."""
    if isinstance(over, Beam | SupportedBeam):
        check = "load, section, length and support of the beam"
        return Small("beam", "its length", over.length, "Beam theory needs small slopes", check)
    if isinstance(over, RailBetween):
        return small_motion(over.kernel.track)
    if isinstance(over, Track):
        check = "load, rail, pads, ballast and subgrade"
        return Small("rail", "its bow under a load", over.bow_length, "Beam theory needs small slopes", check)
    if over is None or not np.isfinite(over.extent).all():
        return None
    (first, last), meaning = over.extent, "Modes are those of small motion"
    return Small("structure", "its length", last - first, meaning, "load, modes and mass")


def share_bent(over: Modal | RailBetween | Track | None, displaced: Array) -> float:
    """Largest displacement under contacts, m, over the length against which it has to be small."""
    small = small_motion(over)
    return 0.0 if small is None else float(np.abs(displaced).max(initial=0.0)) / small.length


def warn_if_bent(over: Modal | RailBetween | Track | None, displaced: Array) -> None:
    """Compare the displacement of what is rolled over under its contacts, m, with what its theory allows."""
    share = share_bent(over, displaced)
    small = small_motion(over)
    if small is not None and share > LARGEST_DEFLECTION:
        deflection = rounded(float(np.abs(displaced).max()))
        meaning = f"{small.meaning[0].lower()}{small.meaning[1:]}"
        LargeDeflectionWarning.warn(
            f"the {small.name} is displaced by up to {deflection} m under the contact, {percent(share)} of "
            f"{small.of}: {meaning}, as up to {percent(LARGEST_DEFLECTION)}; check {small.check}"
        )
