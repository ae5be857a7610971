"""A rail sideways as two beams, head and foot, that a web joins which bends: what a rigid section leaves out.

Head and foot bend by Timoshenko and twist, each by itself; the web between them is a strip of plate across
the rail, clamped into both, with its mass. Held rigid it leaves a rail that bends and twists as a whole, and
cannot warp freely: then head and foot bend against each other. The whole is written a second time, beside
`asperity.structures.rail_web`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from asperity.structures.lateral_rail import LateralTrack

YOUNG, SHEAR, DENSITY = 210e9, 80.769e9, 7850.0
FOOT_TOP, HEAD_BOTTOM, TOP = 31.5e-3, 121.0e-3, 172.0e-3
"""Heights above the bottom, m, between which the web stands, and of the top of the head: a 60E1."""
THICKNESS = 16.5e-3
"""Of the web, m."""
HEAD, FOOT = 150e-3, 11e-3
"""Heights of the middles of head and foot, m."""
CENTROID, TWIST = 81e-3, 48e-3
"""Heights of the rail's centroid, and of the centre about which it twists, m."""
AREA, INERTIA, TORSION = 76.7e-4, 512.7e-8, 221.2e-8
"""m², and m⁴: of the whole rail sideways, and against twist."""
FOOT_TWISTS = 0.28
"""Share of the foot in the stiffness against twist: three rectangles, the web's divided among both."""
SHEAR_STIFFNESS = SHEAR * AREA * 0.538
FREE = 6
"""Motions of a section: head and foot each sideways, by bending alone, and in twist."""
HEAD_MOVES, HEAD_BENDS, HEAD_TWISTS, FOOT_MOVES, FOOT_BENDS, FOOT_TWIST = range(FREE)


@dataclass(frozen=True)
class Beam:
    """Head or foot: area, m², second moments sideways and upright, m⁴, and shares of twisting and shear."""

    area: float
    sideways: float
    upright: float
    twists: float
    shears: float


def beams():
    """Head and foot whose sums and moments are those that are printed of the whole rail."""
    web = THICKNESS * (HEAD_BOTTOM - FOOT_TOP)
    moment = AREA * CENTROID - web * 0.5 * (HEAD_BOTTOM + FOOT_TOP) - FOOT * (AREA - web)
    head = moment / (HEAD - FOOT)
    foot = AREA - web - head
    bends = INERTIA * (TWIST - FOOT) / (HEAD - FOOT)
    shears = head / (head + foot)
    upright = [area**3 / width**2 / 12.0 for area, width in ((head, 72e-3), (foot, 150e-3))]
    return (
        Beam(head, bends, upright[0], 1.0 - FOOT_TWISTS, shears),
        Beam(foot, INERTIA - bends, upright[1], FOOT_TWISTS, 1.0 - shears),
    )


def web_matrices(stiffer):
    """Stiffness and mass per length of the web between motions of head and foot, (6, 6) both."""
    height = HEAD_BOTTOM - FOOT_TOP
    bends = stiffer * YOUNG * THICKNESS**3 / 12.0 / (1.0 - 0.3**2)
    stiffness = np.array(
        [
            [12.0, 6.0 * height, -12.0, 6.0 * height],
            [6.0 * height, 4.0 * height**2, -6.0 * height, 2.0 * height**2],
            [-12.0, -6.0 * height, 12.0, -6.0 * height],
            [6.0 * height, 2.0 * height**2, -6.0 * height, 4.0 * height**2],
        ]
    )
    mass = np.array(
        [
            [156.0, 22.0 * height, 54.0, -13.0 * height],
            [22.0 * height, 4.0 * height**2, 13.0 * height, -3.0 * height**2],
            [54.0, 13.0 * height, 156.0, -22.0 * height],
            [-13.0 * height, -3.0 * height**2, -22.0 * height, 4.0 * height**2],
        ]
    )
    ends = np.zeros((4, FREE))  # the web below: sideways, slope; above: sideways, slope
    ends[0, [FOOT_MOVES, FOOT_TWIST]] = 1.0, FOOT_TOP - FOOT
    ends[1, FOOT_TWIST] = 1.0
    ends[2, [HEAD_MOVES, HEAD_TWISTS]] = 1.0, HEAD_BOTTOM - HEAD
    ends[3, HEAD_TWISTS] = 1.0
    own = DENSITY * THICKNESS * height / 420.0
    return ends.T @ stiffness @ ends * bends / height**3, ends.T @ mass @ ends * own


def free_waves(omega, losses, stiffer=1.0):
    """Six waves of the rail without supports: k (f, 6), rad/m, shapes (f, 6, 6), by columns, amplitudes.

    The answer to a force all along the rail, exp(−ikx), is D(q)⁻¹ with q = k²: for each beam S q on what
    moves less what bends alone, EI q² − ρI ω² q on that, GJ q − ρI_p ω² on the twist; and the web.
    The rows of what bends have q as a factor: without it D is linear in q, so that six roots are eigenvalues.
    """
    stiffness, mass = web_matrices(stiffer)
    square = omega[:, None, None] ** 2
    rest = losses[:, None, None] * stiffness - square * mass  # q⁰ of D
    slope = np.zeros((len(omega), FREE, FREE), dtype=complex)  # q of D
    bends = np.zeros(FREE)  # q² of D
    for first, beam in zip((HEAD_MOVES, FOOT_MOVES), beams(), strict=True):
        moves, alone, twists = range(first, first + 3)
        shear = losses * SHEAR_STIFFNESS * beam.shears
        rest[:, moves, moves] -= omega**2 * DENSITY * beam.area
        rest[:, twists, twists] -= omega**2 * DENSITY * (beam.sideways + beam.upright)
        slope[:, moves, moves] += shear
        slope[:, moves, alone] -= shear
        slope[:, alone, moves] -= shear
        slope[:, alone, alone] += shear - omega**2 * DENSITY * beam.sideways
        slope[:, twists, twists] += losses * SHEAR * TORSION * beam.twists
        bends[alone] = YOUNG * beam.sideways
    alone = [HEAD_BENDS, FOOT_BENDS]
    curved = losses[:, None, None] * np.diag(bends)
    constant, linear = rest.copy(), slope.copy()
    constant[:, alone], linear[:, alone] = slope[:, alone], curved[:, alone]
    q, shapes = np.linalg.eig(-np.linalg.solve(linear, constant))
    derived = slope[:, None] + 2.0 * q[..., None, None] * curved[:, None]
    scale = np.einsum("fai,fiab,fbi->fi", shapes, derived, shapes)
    k = np.sqrt(q)
    k = np.where(k.imag > 0.0, -k, k)
    return k, shapes, -0.5j / (k * scale)


def head_over_distance(track: LateralTrack, frequency, distances, place=TOP, stiffer=1.0):
    """Motion of the head at mid-span and so many m behind it per force there, (x, f), m/N, at a height, m.

    Floquet's waves of six free ones on equal supports that hold the foot, as in
    `asperity.structures.lateral_rail.lateral_waves`, where three are.
    """
    omega, spacing = 2.0 * np.pi * frequency, track.track.sleeper_spacing
    losses = np.broadcast_to(track.track.rail.losses.at(omega), omega.shape)
    k, shapes, amplitudes = free_waves(omega, losses, stiffer)
    support = replace(track, web_thickness=np.inf).support(omega)
    sideways = support[0, 0]
    rolls = support[1, 1] - track.foot_depth**2 * sideways
    below = shapes[:, FOOT_MOVES] - FOOT * shapes[:, FOOT_TWIST]
    turned = shapes[:, FOOT_TWIST]
    held = sideways[:, None, None] * below[:, :, None] * below[:, None]
    held = held + rolls[:, None, None] * turned[:, :, None] * turned[:, None]
    amplitude, phase = 1j * amplitudes, k * spacing
    sine = np.sin(phase)
    matrix = amplitude[:, :, None] * held * sine[:, None]
    matrix += np.cos(phase)[:, :, None] * np.eye(FREE)
    c, z = np.linalg.eig(matrix)
    root = np.sqrt(c - 1.0) * np.sqrt(c + 1.0)
    multipliers = 1.0 / np.where(np.real(root * np.conj(c)) < 0.0, c - root, c + root)
    norm = np.sum(z**2 * (sine / amplitude)[:, :, None], axis=1)
    coefficients = -2.0 / ((multipliers - 1.0 / multipliers) * norm)
    head = shapes[:, HEAD_MOVES] + (place - HEAD) * shapes[:, HEAD_TWISTS]

    def heard(x, factor):
        waves = np.sin(k * (spacing - x))[:, :, None] + factor[:, None] * np.sin(k * x)[:, :, None]
        return np.einsum("fi,fij,fij->fj", head, z, waves)

    sent, found = coefficients * heard(0.5 * spacing, 1.0 / multipliers), []
    for distance in np.asarray(distances) + 0.5 * spacing:
        bays = np.floor(distance / spacing + 1e-9)
        inside = max(distance - bays * spacing, 0.0)
        found.append(np.sum(heard(inside, multipliers) * sent * multipliers**bays, axis=1))
    return np.array(found)
