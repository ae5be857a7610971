"""Checks of the track: closed forms, and a superposition of supports in full precision."""

from functools import partial

import mpmath as mp
import numpy as np
from ledger import Check

from asperity.structures.track import Track
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
