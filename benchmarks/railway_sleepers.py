"""What each assumption about sleepers and board does to the sound of sleepers, band by band, dB.

The program has pistons in a plane, each by itself, over ground, heard by a board that doubles the pressure.
"""

from __future__ import annotations

import numpy as np

from asperity.radiation.track import baffled_piston, cylinder, squared_sleeper_mobility, wavenumber
from asperity.spectra import HALF_BAND
from asperity.structures.track import Track

LENGTH, WIDTH = 1.3, 0.25
"""Of the top of half a sleeper, m, as the program has it."""
GAUGE = 1.5
"""m, between both halves."""
BURIED, SHOWS = 0.5, 0.05
"""Share of the top that ballast covers, and m by which a sleeper stands out of it, as they may be."""
EDGES = 0.7, 0.9, 0.7, 0.9
"""m from the microphone to the four edges of its board, in turn."""
LINES, BAYS, PLACES = 9, 60, 6
FAR = 20
"""Sleepers as far apart as this, and farther, are not coupled."""


def level(ratio):
    return 10.0 * np.log10(ratio)


def lines(band):
    """Frequencies in each band (bands, lines), Hz."""
    return band[:, None] * HALF_BAND ** (2.0 * (np.arange(LINES) + 0.5) / LINES - 1.0)


def coupling(k, length, width, apart=0.0, aside=0.0):
    """Mean of sin(kr)/kr over pairs of points of two equal rectangles, at wavenumbers (n,), rad/m.

    The one lies so far from the other across its length and along it, m. Over the differences x, y of points,
    each met (l − |x|)(w − |y|) times.
    """
    node, weight = np.polynomial.legendre.leggauss(32)
    x, y = (0.5 * side * (node + 1.0) for side in (length, width))
    met = np.outer((length - x) * weight, (width - y) * weight) / (length * width)
    mean = 0.0
    for one in (-1.0, 1.0):
        for other in (-1.0, 1.0):
            r = np.hypot((aside + one * x)[:, None], apart + other * y)
            mean = mean + 0.25 * np.einsum("xy,nxy->n", met, np.sinc(k[:, None, None] * r / np.pi))
    return mean


def rectangle(k, length, width):
    """Radiation ratio of a rigid rectangle in a plane, at wavenumbers (n,), rad/m: k² S/2π of its points."""
    return k**2 * length * width / (2.0 * np.pi) * coupling(k, length, width)


def of_shape(band):
    """Of a strip 1.3 m by 0.25 m in place of a circle of the same area."""
    k = wavenumber(band)
    return level(rectangle(k, LENGTH, WIDTH) / baffled_piston(k * np.sqrt(LENGTH * WIDTH / np.pi)))


def of_covering(band):
    """Of a top that ballast covers by half, at both ends of it, with what stands out of it at the sides."""
    k, bare = wavenumber(band), LENGTH * (1.0 - BURIED)
    return level(rectangle(k, bare, WIDTH) * bare / (rectangle(k, LENGTH, WIDTH) * LENGTH))


def of_dipole(band):
    """Of sleepers through which air goes round, as a long strip that oscillates, in place of pistons.

    Half of its power goes upwards. Its radius: that of the cylinder with the dipole of a flat strip.
    """
    k, area = wavenumber(band), 0.25 * np.pi * WIDTH**2
    radius = (area**2 / (8.0 * np.pi * WIDTH)) ** (1.0 / 3.0)
    return level(cylinder(k * radius) / baffled_piston(k * np.sqrt(LENGTH * WIDTH / np.pi)))


def of_neighbours(track: Track, band, both_rails=False):
    """Of strips that radiate together, as they move, in place of circles, each by itself.

    Power of pistons in a plane, sum of u_m u_n* over pairs with what couples them; both halves of a sleeper
    move alike where both rails do.
    """
    frequency = lines(band).ravel()
    k, spacing = wavenumber(frequency), track.sleeper_spacing
    omega = 2.0 * np.pi * frequency
    waves, count = track.waves(omega), 2 * BAYS + 1
    coupled = np.array([coupling(k, LENGTH, WIDTH, spacing * n) for n in range(FAR)])
    if both_rails:
        coupled = coupled + np.array([coupling(k, LENGTH, WIDTH, spacing * n, GAUGE) for n in range(FAR)])
    alone, together = 0.0, 0.0
    for place in spacing * (np.arange(PLACES) + 0.5) / PLACES:
        moved = np.stack([waves.receptance(spacing * n, place) for n in range(-BAYS, BAYS + 1)])
        for n in range(FAR):
            pairs = np.sum(moved[n:].conj() * moved[: count - n], axis=0).real
            together = together + (1.0 if n == 0 else 2.0) * coupled[n] * pairs
        alone = alone + np.sum(np.abs(moved) ** 2, axis=0)
    circle = baffled_piston(k * np.sqrt(LENGTH * WIDTH / np.pi))
    together = together * k**2 * LENGTH * WIDTH / (2.0 * np.pi)
    weight = omega**2 * track.support.sleeper_square(omega)
    sums = [(weight * each).reshape(len(band), LINES).sum(axis=1) for each in (together, circle * alone)]
    return level(sums[0] / sums[1])


def of_track(track: Track, other: Track, band):
    """Of the motion of sleepers under another track per force, over that under this."""
    frequency = lines(band).ravel()
    each = [
        squared_sleeper_mobility(one, frequency).reshape(len(band), LINES).mean(axis=1)
        for one in (other, track)
    ]
    return level(each[0] / each[1])


def of_board(band, elevation=0.0):
    """Of a board of finite size in place of one that doubles the pressure, for sound that comes upon it.

    Kirchhoff's: 2 less the wave from the edges, exp(−ikr), the mean over all directions of the edge; sound
    that comes from an angle, rad, off the normal has farther or nearer to each.
    """
    turn = 2.0 * np.pi * (np.arange(720) + 0.5) / 720
    across, up = np.cos(turn), np.sin(turn)
    right, top, left, bottom = EDGES
    r = np.minimum(
        np.where(across > 0.0, right, left) / np.abs(across), np.where(up > 0.0, top, bottom) / np.abs(up)
    )
    k = wavenumber(lines(band))[..., None]
    edge = np.exp(-1j * k * r * (1.0 + np.sin(elevation) * up)).mean(axis=-1)
    return level((np.abs(2.0 - edge) ** 2).mean(axis=1) / 4.0)
