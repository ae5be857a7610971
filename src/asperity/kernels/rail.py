"""A rail under several contacts, compiled: what each force does at its own contact and at the others.

A *channel* goes from the contact where a force acts to one that feels it, and carries a moving kernel for
their distance, by poles or scattered. Contacts too far apart have none.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import INNER, LOOP, ONCE, REASSOCIATE, compiled


class Channels(NamedTuple):
    """Channels p, in the order of their sources, of t kernels between n contacts."""

    source: NDArray  # (p,), contact where the force acts
    receiver: NDArray  # (p,), contact whose displacement it is
    table: NDArray  # (p,), kernel
    first: NDArray  # (n + 1,), first channel of each source, and their number
    place: NDArray  # (n,), of the contacts at step zero, in periods of the track
    stride: float  # distance rolled in a step, likewise; of a speed that changes the first
    rolled: NDArray  # (steps,), distance rolled at each step, likewise; none of a constant speed
    pace: (
        NDArray  # (steps,), where the speed is among those of the kernels, from 0 on; none of a constant one
    )
    rank: NDArray  # (p,), number of the speed of its kernel
    decay: NDArray  # (t, 2 q), poles of the kernels, per step: real parts, then imaginary parts
    residue: NDArray  # (t, cells + 1, 2 q), at equal places over a period, both ends included, m/N
    now: NDArray  # (t, cells + 1), displacement at the end of a step for unit force there, m/N
    scattered: NDArray  # (t, positions, taps), kernels that are scattered, m/N; of one tap if none is
    scatters: NDArray  # (t,), whether a kernel is scattered


@compiled(**INNER)
def place(channels, source, step, cells):  # type: ignore[no-untyped-def]
    """Cell of the period in which a contact is at a step, and the share of the cell behind it."""
    rolled = channels.stride * step
    if channels.rolled.size > 0 and step > 0:
        rolled = channels.rolled[step]
    periods = channels.place[source] + rolled
    at = (periods - np.floor(periods)) * cells
    cell = min(int(at), cells - 1)
    return cell, at - cell


@compiled(**INNER)
def share_of(channels, p, step):  # type: ignore[no-untyped-def]
    """Share of a channel in what a force at a step does: straight between the speeds of its kernels."""
    if channels.pace.size == 0:
        return 1.0
    return max(0.0, 1.0 - abs(channels.pace[max(step, 0)] - channels.rank[p]))


@compiled(**INNER, **REASSOCIATE)
def advance_poles(decay, residue, state, cell, share, force):  # type: ignore[no-untyped-def]
    """Advance the rail by one step under the force at its start, N; return its displacement, m.

    That is the displacement at the end without the force there. The force acts in a cell of the period, with
    a share of it behind.
    """
    low = force * (1.0 - share)
    high = force * share
    poles = state.shape[0] // 2
    total = 0.0
    for p in range(poles):
        q = poles + p
        a = state[p]
        b = state[q]
        c = decay[p]
        d = decay[q]
        real = c * a - d * b + low * residue[cell, p] + high * residue[cell + 1, p]
        state[q] = c * b + d * a + low * residue[cell, q] + high * residue[cell + 1, q]
        state[p] = real
        total += real
    return total


@compiled(**INNER, **REASSOCIATE)
def scatter(kernel, ring, cell, t, now, force):  # type: ignore[no-untyped-def]
    """Add to the ring, from the place `now` on, what a force will do, N.

    The start positions of the kernel are interpolated by a periodic cubic: Lagrange's weights of the nodes
    −1, 0, 1, 2 at a place t between 0 and 1.
    """
    rows, taps = kernel.shape
    before = kernel[(cell + rows - 1) % rows]
    after = kernel[(cell + 1) % rows]
    here = kernel[cell]
    beyond = kernel[(cell + 2) % rows]
    w0 = -t * (t - 1.0) * (t - 2.0) / 6.0 * force
    w1 = (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0 * force
    w2 = -(t + 1.0) * t * (t - 2.0) / 2.0 * force
    w3 = (t + 1.0) * t * (t - 1.0) / 6.0 * force
    for k in range(1, taps - now):
        ring[now + k] += w0 * before[k] + w1 * here[k] + w2 * after[k] + w3 * beyond[k]
    for k in range(max(taps - now, 1), taps):
        ring[now + k - taps] += w0 * before[k] + w1 * here[k] + w2 * after[k] + w3 * beyond[k]


@compiled(**ONCE)
def advance_channels(channels, motion, force, step):  # type: ignore[no-untyped-def]
    """Advance the rail over the step that ends at `step`, under the forces (n,) at its start, N.

    What the rail remembers, and its displacements at the end, without the forces there, are those of
    `asperity.kernels.stepping.Motion`.
    """
    taps = motion.ring.shape[1]
    for k in range(motion.rail_ahead.shape[0]):
        motion.rail_ahead[k] = 0.0
    for p in range(channels.source.shape[0]):
        source = channels.source[p]
        receiver = channels.receiver[p]
        t = channels.table[p]
        now, kernel = channels.now[t], channels.scattered[t]
        pushed = share_of(channels, p, step - 1) * force[source]
        if channels.scatters[t]:
            cell, share = place(channels, source, step - 1, kernel.shape[0])
            if pushed != 0.0:
                scatter(kernel, motion.ring[receiver], cell, share, (step - 1) % taps, pushed)
        else:
            cell, share = place(channels, source, step - 1, now.shape[0] - 1)
            motion.rail_ahead[receiver] += advance_poles(
                channels.decay[t], channels.residue[t], motion.rail[p], cell, share, pushed
            )
        cell, share = place(channels, source, step, now.shape[0] - 1)
        here = now[cell] + share * (now[cell + 1] - now[cell])
        motion.rail_now[p] = share_of(channels, p, step) * here
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
