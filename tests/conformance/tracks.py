"""Checks of the track: closed forms, and a superposition of supports in full precision."""

from functools import partial

import mpmath as mp
import numpy as np
from ledger import Check

from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.track import Track, decay_rate_of_responses
from superposed import free_rail, superposed, supports_by_hand

NORDBORG = {
    "bending_stiffness": 4.725e6, "mass_per_length": 60.0, "rail_loss_factor": 0.04, "pad_stiffness": 300e6,
    "pad_loss_factor": 0.15, "sleeper_mass": 150.0, "ballast_stiffness": 150e6, "ballast_loss_factor": 0.4,
    "sleeper_spacing": 0.6,
}  # fmt: skip


def receptances():
    track, places = Track(**NORDBORG), {"over a sleeper": (0.0, 0.0), "at mid-span": (0.3, 0.3)}
    source = "481 superposed supports of an Euler rail, solved densely; tolerance: the finite row"
    places["0.7 m away"] = 0.9, 0.2
    for frequency in (80.0, 500.0, 1100.0, 2500.0):
        w = 2 * np.pi * frequency
        row, support = 0.6 * np.arange(-240, 241), supports_by_hand(track, w)
        exact = superposed(free_rail(track, w), support, row, list(places.values()))
        for (where, at), expected in zip(places.items(), exact, strict=True):
            what, found = f"receptance {where}, {frequency:g} Hz: magnitude", track.receptance(frequency, *at)
            yield Check(what, abs(expected), abs(found), "nm/N", source=source, tolerance=1e-8)


def characteristic_frequencies():
    row = partial(Check, unit="Hz", tolerance=1e-9)
    bending, mass, length = mp.mpf(210e9) * mp.mpf("3.037e-5"), mp.mpf("60.2"), mp.mpf("0.6")
    pinned = mp.pi / (2 * length**2) * mp.sqrt(bending / mass)
    track = Track(**(NORDBORG | {"bending_stiffness": float(bending), "mass_per_length": 60.2}))
    what, found = "UIC60, 0.6 m, Euler: pinned–pinned frequency", track.pinned_pinned_frequency
    yield row(what, pinned, found, source="(π/2L²)√(B/m')")
    resonance = mp.sqrt((300e6 + 150e6) / mp.mpf(150)) / (2 * mp.pi)
    found = Track(**NORDBORG).antiresonance_frequency
    what = "sleeper on pad and ballast: anti-resonance"
    yield row(what, resonance, found, source="√((k_p + k_b)/m_s)/2π")


def winkler():
    """Sleepers close together without mass: a foundation of stiffness s."""
    spacing, s, bending, mass = 0.02, 90e6, 4.725e6, 60.0
    pad = 2 * s * spacing
    track = Track(
        bending_stiffness=bending, mass_per_length=mass, pad_stiffness=pad, pad_damping=20.0 * spacing,
        sleeper_mass=1e-9, ballast_stiffness=pad, ballast_damping=20.0 * spacing, sleeper_spacing=spacing,
    )  # fmt: skip
    row = partial(Check, body="rail on a foundation", tolerance=1e-3)
    beta, found = (mp.mpf(s) / (4 * mp.mpf(bending))) ** mp.mpf("0.25"), track.receptance(0.01, 0.0, 0.0)
    source = "Winkler, β/2s; tolerance: sleepers 20 mm apart"
    yield row("static compliance", beta / (2 * s), abs(found), "nm/N", source=source)
    critical = (4 * mp.mpf(s) * bending / mp.mpf(mass) ** 2) ** mp.mpf("0.25")
    source = "(4sB/m'²)^¼; tolerance: sleepers 20 mm apart"
    yield row("critical speed", critical, track.critical_speed, "m/s", source=source)


SOFT = {
    "bending_stiffness": 4.725e6, "mass_per_length": 60.0, "pad_stiffness": 20e6, "pad_damping": 2e3,
    "sleeper_mass": 150.0, "ballast_stiffness": 20e6, "ballast_damping": 40e3, "sleeper_spacing": 0.6,
}  # fmt: skip
"""A lossless rail on soft, viscous supports."""


def short_times():
    """Straight after an impulse the rail answers as a free beam."""
    track = Track(**SOFT)
    step = 2e-6
    kernel = moving_kernel(track, 25.0, step, positions=2, duration=4e-3)
    bending, mass = track.bending_stiffness, track.mass_per_length
    # hat of force about zero: ∫ √(|t − τ|) over the half after the force, Euler's √t law
    n = 12
    law = mp.quad(lambda s: (1 - abs(s)) * mp.sqrt((n - s) * step / (2 * mp.pi)), [-1, 0, 1]) * step
    law *= mp.mpf(bending) ** mp.mpf("-0.25") * mp.mpf(mass) ** mp.mpf("-0.75")
    source = "free beam, √(t/2π) B^−¼ m'^−¾ under a hat of force; tolerance: the supports"
    found = kernel.weights[0, n]
    yield Check("moving kernel after 24 µs", law, found, "pm/N", source=source, tolerance=0.03)


def decay_by_the_standard():
    distances = 0.6 * np.array(
        [*np.arange(0, 2.51, 0.25), 3, 3.5, 4, 5, 6, 7, 8, 10, 12, 16, 20, 24, 30, 36, 42, 48, 54, 66]
    )  # fmt: skip
    gamma = 0.35  # 1/m
    expected = 20 * gamma * mp.log10(mp.e)
    found = decay_rate_of_responses(distances, np.exp(-gamma * distances)[:, None])
    source = "20 γ lg e; tolerance: the sum of EN 15461 for an integral"
    yield Check("EN 15461: decay of e^(−0.35 x/m)", expected, found, "dB/m", source=source, tolerance=0.05)
