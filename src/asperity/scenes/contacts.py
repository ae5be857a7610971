"""What is looked at where bodies roll on several contacts: each of them, and each way a body moves."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from asperity.scenarios.tree import drawn, spectrum_segment
from asperity.scenes import schema
from asperity.scenes.compute import Computed
from asperity.schema import Entry
from asperity.spectra import psd

MOST_NAMED = 4
"""Contacts that the verdict names."""
EQUAL = 1e-6
"""Relative difference of distances that are equal."""


def lost_contacts(computed: Computed) -> str:
    """Say which other contacts are lost, by the main law; a blank comes first."""
    share = 1.0 - next(iter(computed.chain.runs.values())).every.in_contact.mean(axis=1)
    lost = [f"{k + 1} ({100.0 * share[k]:.3g} %)" for k in range(1, len(share)) if share[k] > 0.0]
    if not lost:
        return ""
    named = ", ".join(lost[:MOST_NAMED]) + (" and others" if len(lost) > MOST_NAMED else "")
    return f" Of the {len(share) - 1} other contacts, {len(lost)} are lost at times: {named}."


def _motion(computed: Computed) -> NDArray[np.float64]:
    """Degrees of freedom of all bodies (laws, d, n), positive downwards, m."""
    levers = np.array(list(computed.scene.degrees.values()))[:, None]
    runs = computed.chain.runs.values()
    return np.stack([-levers * np.concatenate(run.every.degrees_of_freedom) for run in runs])


def contacts_in_time(computed: Computed) -> dict[Entry, object]:
    """Lay out the motion of every contact and body."""
    offsets, stacked = computed.scene.offsets, computed.of_contacts
    return {
        schema.CONTACT: np.arange(1, len(offsets) + 1),
        schema.OFFSET: offsets,
        schema.STATIC_LOAD: computed.scene.loads,
        schema.CONTACT_FORCES: stacked("contact_force"),
        schema.APPROACHES: stacked("relative_displacement"),
        schema.OVER_DISPLACEMENTS: stacked("over_displacement"),
        schema.ROLLING_DISPLACEMENTS: stacked("rolling_displacement"),
        schema.LOSS_SHARES: 1.0 - stacked("in_contact").mean(axis=-1),
        schema.DEGREE: list(computed.scene.degrees),
        schema.BODY_DISPLACEMENT: _motion(computed),
    }


def contacts_over_frequency(
    computed: Computed,
    frequency: NDArray[np.float64],
    density: NDArray[np.float64],
    level: NDArray[np.float64],
) -> dict[Entry, object]:
    """Lay out the spectra of every contact, of their sum, and of every body.

    Frequencies (f,), Hz, PSDs (laws, c, f), N²/Hz, and levels (laws, c, b), dB re 1 N, of the forces.
    """
    case, force = computed.case, computed.of_contacts("contact_force")
    step, highest = case.time_step, case.numerics.highest_frequency
    segment, shown = spectrum_segment(force.shape[-1], step), drawn(frequency, highest)
    curvature = np.pad(np.diff(_motion(computed), 2) / step**2, ((0, 0), (0, 0), (1, 1)), mode="edge")
    _, curved = psd(curvature, step, segment=segment)
    half = np.pi * frequency * step
    to_acceleration = (half / np.sin(np.maximum(half, 1e-12))) ** 4  # from second differences
    found: dict[Entry, object] = {
        schema.SPECTRA_CONTACT: np.arange(1, force.shape[1] + 1),
        schema.FORCE_PSDS: density[..., shown],
        schema.FORCE_LEVELS: level,
        schema.SUM_PSD: psd(force.sum(axis=1), step, segment=segment)[1][..., shown],
        schema.SPECTRA_DEGREE: list(computed.scene.degrees),
        schema.BODY_ACCELERATION_PSD: (curved * to_acceleration)[..., shown],
    }
    tones = passing_frequencies(computed.scene.offsets, case.speed, highest)
    return found | ({schema.PASSING_FREQUENCY: tones} if tones.size else {})


def passing_frequencies(offsets: Iterable[float], speed: float, highest: float) -> NDArray[np.float64]:
    """Multiples k v/L, Hz, of the frequency at which contacts at an equal distance L pass a place.

    Offsets in m, speed in m/s, up to the highest frequency, Hz; none where distances differ.
    """
    gaps = np.diff(np.sort(np.fromiter(offsets, dtype=float)))
    if not gaps.size or np.ptp(gaps) > EQUAL * gaps.mean():
        return np.zeros(0)
    first = speed / gaps.mean()
    return np.asarray(first * np.arange(1, int(highest / first) + 1))
