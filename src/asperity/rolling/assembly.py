"""Bodies set on what they roll over: at rest, with contacts soft enough for the time step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.kernels.stepping import System
from asperity.laws.base import Law
from asperity.rolling import stability
from asperity.rolling.ground import Ground, ground_of
from asperity.rolling.path import Path
from asperity.rolling.rest import Rest, start_at_rest
from asperity.rolling.stepper import Stepper
from asperity.rolling.steps import alternating_of_modes, body_step, padded, resolved_step
from asperity.structures.body import Body
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween

RUNAWAY = 1e4
"""Times the load, or the largest force that the law was made for, that no contact force reaches."""


def assemble(
    over: Modal | RailBetween | None,
    bodies: Sequence[Body],
    laws: Sequence[Law],
    whole: Path,
    positions: Array,
    sensors: Array,
    highest_frequency: float | None,
) -> Stepper:
    """Set bodies at `positions` ahead of a path, m, at rest on what they roll over; see `roll_bodies`."""
    path = whole.ahead(_offsets(bodies, laws, positions))
    ground = ground_of(over, path, sensors)
    system = system_of(ground, bodies, path)
    prepared = [law.prepare(at) for law, at in zip(laws, path.positions, strict=True)]
    rest, motion = start_at_rest(ground, bodies, system, prepared)
    own = alternating(system)
    limits = _limits(ground, system, bodies, ground.alternating + own, rest, highest_frequency)
    stability.warn_if_coarse(path.time_step, limits)
    values = [stability.largest_values(*each) for each in zip(prepared, rest.stiffness.tolist(), strict=True)]
    stiffest, impacts, forces = np.array(values).T
    damping, largest = np.array([law.damping for law in laws]), RUNAWAY * max(*rest.force, *forces)
    least, thrown = ground.alternating + own, ground.thrown + own
    softer = stability.softening(least, thrown, stiffest, impacts, damping, rest.stiffness, path.time_step)
    if softer.any():
        system = system._replace(softening=softer)
        rest, motion = start_at_rest(ground, bodies, system, prepared)
    return Stepper(over, bodies, laws, path, prepared, system, motion, largest, ground.softest)


def _offsets(bodies: Sequence[Body], laws: Sequence[Law], positions: Array) -> Array:
    """Where the contacts are ahead of the path (n,), m."""
    if not len(bodies):
        raise InputError("bodies", "none", "one or more")
    if positions.shape != (len(bodies),) or not np.isfinite(positions).all():
        allowed = f"{len(bodies)} finite numbers, one for each body"
        raise InputError("positions of the bodies (m)", positions.tolist(), allowed)
    offsets = np.concatenate([at + body.places for at, body in zip(positions, bodies, strict=True)])
    if len(laws) != len(offsets):
        raise InputError("laws", len(laws), f"{len(offsets)}, one for each contact")
    return offsets


def system_of(ground: Ground, bodies: Sequence[Body], path: Path) -> System:
    """Constants for the kernels, with contacts as they are."""
    b, h, channels = len(bodies), path.time_step, ground.channels
    loads = np.concatenate([body.static_loads for body in bodies])
    n, mean = len(loads), float(np.clip(loads, 0.0, None).mean())
    if not mean > 0.0:
        raise InputError("loads of the bodies (N)", "none that presses", "forces that press them down")
    of = np.repeat(np.arange(b), [len(body.places) for body in bodies])
    frequencies = padded([2.0 * np.pi * body.natural_frequencies for body in bodies])
    natural = np.concatenate([ground.natural, frequencies.ravel()])
    damping_ratios = padded([body.damping_ratios for body in bodies])
    ratios = np.concatenate([ground.ratios, damping_ratios.ravel()])
    coefficients = resolved_step(natural, ratios, h)
    shapes = padded([row for body in bodies for row in body.shapes])
    rows = padded([row for body in bodies for row in body.contacts])
    step = padded([body_step(body, h) for body in bodies])  # (b, 2, d, 4, d)
    constant = np.einsum("bxijk,bk->bxi", step[..., 2:, :], padded([body.pressing for body in bodies]))
    before, now = np.einsum("nxijk,nk->jnxi", step[of][..., 2:, :], rows).reshape(2, n, -1)
    answers = coefficients[3, len(ground.natural) :].reshape(b, -1)[of]
    return System(
        coefficients=coefficients,
        stiffness=natural**2,
        damping=2.0 * ratios * natural,
        sensors=ground.sensors,
        core_step=step[..., :2, :].reshape(b, now.shape[1], now.shape[1]),
        core_pressed=-constant.reshape(b, -1),
        core_damping=padded([body.damping for body in bodies]),
        body=of,
        core_shapes=rows,
        core_before=before,
        core_now=now,
        shapes=shapes,
        own=np.sum(rows * now[:, : rows.shape[1]], axis=1) + np.sum(shapes**2 * answers, axis=1),
        loads=np.maximum(loads, mean) if n > 1 else loads,
        ones=np.ones(len(natural)),
        softening=np.zeros(n),
        time_step=float(h),
        speed=float(path.speed),
        coupled=bool(len(channels.source) > n or (n > 1 and ground.natural.size > 0) or n > b),
        channels=channels,
    )


def alternating(system: System) -> Array:
    """Least alternating compliance of the body at each contact (n,), m/N: of all its contacts at once."""
    found, (d, f) = np.zeros(len(system.body)), (system.core_shapes.shape[1], system.shapes.shape[1])
    modes = alternating_of_modes(system.coefficients)[len(system.stiffness) - f * len(system.core_step) :]
    for b, step in enumerate(system.core_step):
        at = np.flatnonzero(system.body == b)
        core = np.linalg.solve(np.eye(2 * d) + step, (system.core_now - system.core_before)[at].T)[:d]
        shapes = system.shapes[at]
        matrix = system.core_shapes[at] @ core + (shapes * modes[b * f : (b + 1) * f]) @ shapes.T
        found[at] = float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min())
    return found


def _limits(
    ground: Ground,
    system: System,
    bodies: Sequence[Body],
    least: Array,
    rest: Rest,
    highest_frequency: float | None,
) -> Iterator[stability.Limit]:
    """What the time step must resolve, with the least alternating compliances at the contacts, m/N."""
    if ground.bay:
        on_bay = np.sqrt(float(rest.stiffness.max()) / ground.bay) / (2.0 * np.pi)
        yield "the contact resonance on a bay of rail", on_bay, 5.0
    else:
        direct = system.own + ground.shapes**2 @ system.coefficients[3, : len(ground.natural)]
        resonances = stability.contact_resonance(rest.stiffness, direct, least, system.time_step)
        yield "the contact resonance", float(resonances.max()), 10.0
    yield ground.limit
    natural = np.concatenate([body.natural_frequencies for body in bodies])
    asked = natural[natural <= (highest_frequency or np.inf)]  # of others nobody asked
    yield "the highest mode of a body", float(asked.max(initial=0.0)), 4.0
    yield "the highest frequency asked for", highest_frequency or 0.0, 5.0 if ground.bay else 10.0
