"""What contacts roll over: the modes of structures, a rigid plane, or a rail."""

from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import Array, Flags
from asperity.errors import InputError, LargeDeflectionWarning, percent
from asperity.kernels.rail import Channels
from asperity.rolling.course import Course
from asperity.rolling.resolution import PER_MODE, PER_SLEEPER
from asperity.rolling.steps import Limit, alternating_of_modes, padded, resolved_step
from asperity.rolling.trajectory import Trajectory
from asperity.structures.beam import Beam, SupportedBeam
from asperity.structures.modal import HIGHEST, Modal
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import CELLS, RailBetween, RailPoles, over_the_period
from asperity.structures.track import Track
from asperity.written_numbers import between, rounded

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
    rates: Array  # (n, s), how fast they change there, per second
    sensors: Array  # (sensors, s)
    channels: Channels  # of a rail, else none
    softest: float  # largest static compliance under a contact on its path, m/N; infinite if nothing holds it
    alternating: Array  # (n,), least alternating compliance of all contacts at once, m/N
    thrown: Array  # (n,), that of what throws bodies apart: an endless rail carries impacts away
    limits: tuple[Limit, ...]  # what a time step must resolve
    on_rail: Flags  # (n,), which contacts are on a rail
    yields: Array  # (n, n), mean static compliance of a rail, m/N; zero of modes
    bay: float = np.inf  # mass of a bay of rail, kg
    memory: int = 0  # time steps that a rail remembers


def ground_of(course: Course, sensors: Array, steps: range | None = None) -> Ground:
    """Look at what is rolled over, under the contacts at some steps, of which the first is the start.

    Sensors are rows (k, s) over all modes; a contact is refused where it leaves what it rolls over.
    """
    if steps is None:
        steps = range(0, course.total + 1, max(1, (course.total + 1) // PLACES))
    _refuse_to_leave(course)
    mechanism = course.mechanism
    n = course.contacts
    natural = 2.0 * np.pi * mechanism.natural_frequencies
    ratios = mechanism.damping_ratios
    shapes, _ = course.shapes_at(steps)
    under, rates = course.shapes_at(steps[:1])
    each = alternating_of_modes(resolved_step(natural, ratios, course.time_step))
    least = float(np.linalg.eigvalsh((shapes * each) @ shapes.transpose(0, 2, 1)).min())
    softest = float(((shapes / natural) ** 2).sum(axis=2).max()) if natural.all() else np.inf
    frequencies = natural / (2.0 * np.pi)
    followed = frequencies[frequencies <= HIGHEST]  # others are meant to be static
    ground = Ground(
        natural=natural,
        ratios=ratios,
        shapes=under[0],
        rates=rates[0],
        sensors=sensors,
        channels=no_channels(n),
        softest=softest,
        alternating=np.full(n, least),
        thrown=np.full(n, least),
        limits=(("the highest mode of the structure", float(followed.max(initial=0.0)), PER_MODE),),
        on_rail=np.zeros(n, dtype=bool),
        yields=np.zeros((n, n)),
    )
    return ground if mechanism.rail is None else _on_rail(ground, mechanism.rail, course)


def no_channels(n: int) -> Channels:
    """Channels of a rail that is not there, for n contacts."""
    none = np.zeros(0, dtype=np.int64)
    first = np.zeros(n + 1, dtype=np.int64)
    decay, residue, now, scattered = map(np.zeros, ((0, 0), (0, 1, 0), (0, 1), (0, 1, 1)))
    kernels = decay, residue, now, scattered, np.zeros(0, dtype=bool)
    nothing = np.zeros(0)
    return Channels(none, none, none, first, np.zeros(n), 0.0, nothing, nothing, none, *kernels)


def _refuse_to_leave(course: Course) -> None:
    for k, contact in enumerate(course.mechanism.contacts):
        for side in contact.sides:
            structure = course.mechanism.structures[side.structure]
            if isinstance(structure, RailBetween):
                continue
            low, high = structure.extent
            margin = 1e-9 * (high - low)
            first, last = (
                float(side.trajectory.places(range(step, step + 1))[0]) for step in (0, course.total)
            )
            if not (first >= low - margin and last <= high + margin):
                raise InputError(
                    f"path of contact {k + 1} (m)",
                    f"{first:.6g} to {last:.6g}",
                    f"{low:.6g} to {high:.6g}, on the structure",
                    "Choose start, duration, run-in and positions so that all contacts stay on it.",
                )


def _on_rail(ground: Ground, rail: RailBetween, course: Course) -> Ground:
    """The same with a rail, by poles or scattered, between those contacts on it, at fixed distances."""
    kernel = rail.kernel
    n = course.contacts
    on_rail = course.mechanism.on_rail
    ways = [course.mechanism.contacts[k].sides[0].trajectory for k in np.flatnonzero(on_rail).tolist()]
    every = course.total + 1
    given = np.concatenate([way.rates(range(1 if way.spacing else every)) for way in ways])
    slowest = rail.at_speeds[0].kernel.speed
    same = given.min() >= slowest * (1.0 - 1e-9) and given.max() <= kernel.speed * (1.0 + 1e-9)
    if not (same and np.isclose(course.time_step, kernel.time_step, rtol=1e-9, atol=0.0)):
        other = given[np.abs(given - 0.5 * (slowest + kernel.speed)).argmax()]
        received = f"{other:.6g} m/s in steps of {course.time_step:.6g} s"
        made = f"{between(f'{slowest:.6g}', f'{kernel.speed:.6g}')} m/s and {kernel.time_step:.6g} s"
        allowed = f"{made}, for which the rail's kernel was computed"
        raise InputError("path", received, allowed, "Compute the moving kernel of this path.")
    starts = np.concatenate([way.places(range(1)) for way in ways])
    channels, weights = _channels(rail, starts, on_rail)
    if rail.slower:
        channels = _changing(channels, rail, ways[0], range(every))
    found = np.zeros((n, n))
    static = np.array([each.sum(axis=1).mean() for each in weights])
    shares = np.clip(1.0 - np.abs(channels.pace[:1] - channels.rank), 0.0, 1.0) if rail.slower else 1.0
    np.add.at(found, (channels.receiver, channels.source), shares * static[channels.table])
    squares, vectors = np.linalg.eigh(0.5 * (found + found.T))
    own = [each.kernel.weights for each in rail.at_speeds]
    taps = max(each.shape[1] for each in own)
    softest = float(max(each.sum(axis=1).max() for each in own))
    # of all places in a bay
    least = float(min((each @ (-1.0) ** np.arange(each.shape[1])).min() for each in own))
    limit = "the passing of sleepers v/L", kernel.speed / kernel.track.sleeper_spacing, PER_SLEEPER
    yields = (vectors * squares.clip(0.0)) @ vectors.T
    bay = kernel.track.mass_per_length * kernel.track.sleeper_spacing
    return replace(
        ground,
        channels=channels,
        softest=max(softest, ground.softest),
        alternating=np.where(on_rail, least, ground.alternating),
        thrown=np.where(on_rail, 0.0, ground.thrown),
        limits=(*ground.limits, limit),
        on_rail=on_rail,
        yields=yields,
        bay=bay,
        memory=taps,
    )


def _channels(rail: RailBetween, starts: Array, on_rail: Flags) -> tuple[Channels, list[Array]]:
    """Channels between all contacts within reach, and the weights of the kernels that they carry.

    Places of the contacts on the rail at the start, m, and which of all contacts (n,) these are.
    """
    tables: list[RailPoles | MovingKernel] = [rail.at_speeds[0].direct]
    pairs = []
    for source, here in enumerate(starts):
        for rank, at in enumerate(rail.at_speeds):
            for receiver, there in enumerate(starts):
                found = at.direct if source == receiver else at.between(there - here)
                if found is not None:
                    known = [index for index, table in enumerate(tables) if table is found]
                    tables += [] if known else [found]
                    pairs.append((source, receiver, known[0] if known else len(tables) - 1, rank))
    source, receiver, table, ranks = np.array(pairs, dtype=np.int64).T.copy()
    contacts = np.flatnonzero(on_rail)
    none = np.zeros(0)
    weights = [each.kernel.weights for each in tables]
    bays = rail.kernel.track.cell_bays
    period = rail.kernel.track.period
    place = np.zeros(on_rail.size)
    place[contacts] = starts / period
    laid = [
        (each.poles, over_the_period(each.residues, bays), np.zeros((1, 1)))
        if isinstance(each, RailPoles)
        else (none, np.zeros((CELLS * bays + 1, 0)), each.weights)
        for each in tables
    ]
    decay = padded([np.stack([poles.real, poles.imag]) for poles, _, _ in laid])
    residue = padded([np.stack([residues.real, residues.imag], axis=1) for _, residues, _ in laid])
    channels = Channels(
        source=contacts[source],
        receiver=contacts[receiver],
        table=table,
        first=np.searchsorted(contacts[source], np.arange(on_rail.size + 1)),
        place=place,
        stride=rail.kernel.speed * rail.kernel.time_step / period,
        rolled=none,
        pace=none,
        rank=ranks,
        decay=decay.reshape(len(tables), -1),
        residue=residue.reshape(len(tables), CELLS * bays + 1, -1),
        now=np.array([over_the_period(each[:, 0], bays) for each in weights]),
        scattered=padded([scattered for *_, scattered in laid]),
        scatters=np.array([not isinstance(each, RailPoles) for each in tables]),
    )
    return channels, weights


def _changing(channels: Channels, rail: RailBetween, way: Trajectory, steps: range) -> Channels:
    """Channels between contacts whose speed changes along a way: how far they have rolled, and how fast."""
    period = rail.kernel.track.period
    places = way.places(steps)
    rates = way.rates(steps)
    speeds = [each.kernel.speed for each in rail.at_speeds]
    return channels._replace(
        stride=float(rates[0]) * rail.kernel.time_step / period,
        rolled=np.asarray((places - places[0]) / period),
        pace=np.interp(rates, speeds, np.arange(len(speeds), dtype=float)),
    )


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
    first, last = over.extent
    meaning = "Modes are those of small motion"
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
