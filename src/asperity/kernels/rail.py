"""A rail under several contacts, compiled: what each force does at its own contact and at the others.

A *channel* goes from the contact where a force acts to one that feels it, and carries a moving kernel for
their distance, by poles or scattered. Contacts too far apart have none.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import ENTERED, INNER, LOOP, ONCE, REASSOCIATE, compiled


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
    """One channel, as views."""

    decay: NDArray
    residue: NDArray
    direct: NDArray  # as `now` of `Channels`
    scattered: NDArray
    first: float  # place of its source at step zero, in sleeper bays
    stride: float


class ChannelMotion(NamedTuple):
    """What is written for one channel."""

    rail: NDArray
    ring: NDArray


@compiled(**INNER)
def place(channel, step, cells):  # type: ignore[no-untyped-def]
    """Cell of the bay in which the contact is at a step, and the share of the cell behind it."""
    bays = channel.first + channel.stride * step
    at = (bays - np.floor(bays)) * cells
    cell = min(int(at), cells - 1)
    return cell, at - cell


@compiled(**INNER)
def direct_at(channel, step):  # type: ignore[no-untyped-def]
    """Displacement of the rail at a step for unit force there, m/N."""
    cell, share = place(channel, step, channel.direct.shape[0] - 1)
    return channel.direct[cell] + share * (channel.direct[cell + 1] - channel.direct[cell])


@compiled(**ENTERED)
def cubic_weights(t):  # type: ignore[no-untyped-def]
    """Lagrange weights of the nodes -1, 0, 1, 2 at a place t between 0 and 1."""
    before, after, beyond = t + 1.0, t - 1.0, t - 2.0
    return (
        -t * after * beyond / 6.0,
        before * after * beyond / 2.0,
        -before * t * beyond / 2.0,
        before * t * after / 6.0,
    )


@compiled(**INNER, **REASSOCIATE)
def advance_poles(channel, motion, step, force):  # type: ignore[no-untyped-def]
    """Advance the rail by one step under the force at its start, N; return its displacement, m.

    That is the displacement at the end without the force there.
    """
    cell, share = place(channel, step, channel.direct.shape[0] - 1)
    state, decay = motion.rail, channel.decay
    residue = channel.residue
    low, high = force * (1.0 - share), force * share
    poles = state.shape[0] // 2
    total = 0.0
    for p in range(poles):
        a, b, c, d = state[p], state[poles + p], decay[p], decay[poles + p]
        real = c * a - d * b + low * residue[cell, p] + high * residue[cell + 1, p]
        q = poles + p
        state[q] = c * b + d * a + low * residue[cell, q] + high * residue[cell + 1, q]
        state[p] = real
        total += real
    return total


@compiled(**INNER, **REASSOCIATE)
def scatter(channel, motion, step, force):  # type: ignore[no-untyped-def]
    """Add to the ring what a force at a step, N, will do; the displacement of the next step, m.

    The start positions of the kernel are interpolated by a periodic cubic.
    """
    rows, taps = channel.scattered.shape
    cell, t = place(channel, step, rows)
    before, after = channel.scattered[(cell + rows - 1) % rows], channel.scattered[(cell + 1) % rows]
    here, beyond = channel.scattered[cell % rows], channel.scattered[(cell + 2) % rows]
    w0, w1, w2, w3 = cubic_weights(t)
    w0, w1, w2, w3 = w0 * force, w1 * force, w2 * force, w3 * force
    ring, now = motion.ring, step % taps
    for k in range(1, taps - now):
        ring[now + k] += w0 * before[k] + w1 * here[k] + w2 * after[k] + w3 * beyond[k]
    for k in range(max(taps - now, 1), taps):
        ring[now + k - taps] += w0 * before[k] + w1 * here[k] + w2 * after[k] + w3 * beyond[k]
    ring[now] = 0.0
    return ring[(step + 1) % taps]


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
