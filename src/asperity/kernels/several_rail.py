"""A rail under several contacts, compiled: what each force does at its own contact and at the others.

A *channel* goes from the contact where a force acts to one that feels it, and carries a moving kernel for
their distance, by poles or scattered. Contacts too far apart have none.
"""

from __future__ import annotations

from typing import NamedTuple

from numpy.typing import NDArray

from asperity.kernels.options import LOOP, ONCE, compiled
from asperity.kernels.rail import advance_poles, direct_at, scatter


class Channels(NamedTuple):
    """Channels p, in the order of their sources, of t kernels between n contacts."""

    source: NDArray  # (p,), contact where the force acts
    receiver: NDArray  # (p,), contact whose displacement it is
    table: NDArray  # (p,), kernel
    first: NDArray  # (n + 1,), first channel of each source, and their number
    place: NDArray  # (n,), of the contacts at step zero, in sleeper bays
    stride: float  # distance rolled in a step, in sleeper bays
    decay: NDArray  # (t, 2 q), poles of the kernels, per step: real parts, then imaginary parts
    residue: NDArray  # (t, cells + 1, 2 q), at equal places over a bay, both ends included, m/N
    now: NDArray  # (t, cells + 1), displacement at the end of a step for unit force there, m/N
    scattered: NDArray  # (t, positions, taps), kernels that are scattered, m/N; of one tap if none is
    scatters: NDArray  # (t,), whether a kernel is scattered


class Channel(NamedTuple):
    """What `asperity.kernels.rail` needs to know of one channel, as views."""

    decay: NDArray
    residue: NDArray
    direct: NDArray
    scattered: NDArray
    first: float
    stride: float


class ChannelMotion(NamedTuple):
    """What it writes for one channel."""

    rail: NDArray
    ring: NDArray


@compiled(**ONCE)
def advance_channels(channels, motion, force, step):  # type: ignore[no-untyped-def]
    """Advance the rail over the step that ends at `step`, under the forces (n,) at its start, N.

    What the rail remembers, and its displacements at the end, without the forces there, are those of
    `asperity.kernels.several.ContactsMotion`.
    """
    taps = motion.ring.shape[1]
    for k in range(motion.rail_ahead.shape[0]):
        motion.rail_ahead[k] = 0.0
    for p in range(channels.source.shape[0]):
        source, receiver, t = channels.source[p], channels.receiver[p], channels.table[p]
        channel = Channel(
            channels.decay[t],
            channels.residue[t],
            channels.now[t],
            channels.scattered[t],
            channels.place[source],
            channels.stride,
        )
        kept = ChannelMotion(motion.rail[p], motion.ring[receiver])
        if channels.scatters[t]:
            scatter(channel, kept, step - 1, force[source])
        else:
            motion.rail_ahead[receiver] += advance_poles(channel, kept, step - 1, force[source])
        motion.rail_now[p] = direct_at(channel, step)
    if taps > 1:
        for k in range(motion.rail_ahead.shape[0]):
            motion.ring[k, (step - 1) % taps] = 0.0
            motion.rail_ahead[k] += motion.ring[k, step % taps]


@compiled(**ONCE)
def press_rail(channels, motion, k, change):  # type: ignore[no-untyped-def]
    """Add to the force of a contact at the end of the step, N."""
    for p in range(channels.first[k], channels.first[k + 1]):
        motion.rail_ahead[channels.receiver[p]] += motion.rail_now[p] * change


@compiled(**ONCE)
def rail_compliance(channels, motion, k):  # type: ignore[no-untyped-def]
    """Displacement of the rail under a contact for one newton there at the end of the step, m/N."""
    total = 0.0
    for p in range(channels.first[k], channels.first[k + 1]):
        if channels.receiver[p] == k:
            total += motion.rail_now[p]
    return total


@compiled(**LOOP)
def preload_channels(channels, motion, force, steps, before):  # type: ignore[no-untyped-def]
    """Let constant forces (n,), N, roll up to step zero.

    The displacements then are without the forces at that step; those one step earlier are written to
    `before` (n,), m.
    """
    for step in range(1 - steps, 1):
        for k in range(before.shape[0]):
            before[k] = motion.rail_ahead[k]
        advance_channels(channels, motion, force, step)
