"""The result of bodies that roll, laid out as labelled groups."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from functools import partial

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.kinds.bodies import schema
from asperity.kinds.bodies.bodies import body_transfer, loads_of
from asperity.kinds.bodies.compute import Computed
from asperity.scenarios.contact_group import contact_group
from asperity.scenarios.surface_group import surface_group
from asperity.scenarios.tree import assembled, drawn, force_spectra, rolling_group, spectrum_segment
from asperity.scenarios.validity import findings, verdict, warn_of_findings
from asperity.schema import Entry, variables
from asperity.spectra import band_levels, psd

MOST_NAMED = 4
"""Contacts that the verdict names."""
EQUAL = 1e-6
"""Relative difference of distances that are equal."""


def layout(
    computed: Computed, caught: list[warnings.WarningMessage], *, brief: bool = False
) -> xarray.DataTree:
    """Lay out what was computed, with units and provenance; warnings of that may be added to `caught`.

    In brief without what only a report shows: what the path is like.
    """
    chain = computed.chain
    spectra = xarray.Dataset(
        force_spectra(chain, partial(body_transfer, computed.bodies)) | variables(_spectra(computed))
    )
    found = findings(chain)
    warn_of_findings(found)
    groups = {
        "/surface": surface_group(chain, brief=brief),
        "/contact": contact_group(chain, found),
        "/rolling": rolling_group(chain, _rolling(computed)),
        "/spectra": spectra,
    }
    several = len(computed.case.body.offsets) > 1
    told = verdict(chain, spectra, found, "first contact" if several else "body")
    title = computed.bodies.title
    told = f"{told}{_lost(computed)}"
    return assembled(chain, groups, caught, title=title, verdict=told, numerics=_numerics(computed))


def _lost(computed: Computed) -> str:
    """Say which other contacts are lost, by the main law; a blank comes first."""
    share = 1.0 - next(iter(computed.chain.runs.values())).every.in_contact.mean(axis=1)
    lost = [f"{k + 1} ({100.0 * share[k]:.3g} %)" for k in range(1, len(share)) if share[k] > 0.0]
    if not lost:
        return ""
    named = ", ".join(lost[:MOST_NAMED]) + (" and others" if len(lost) > MOST_NAMED else "")
    return f" Of the {len(share) - 1} other contacts, {len(lost)} are lost at times: {named}."


def _numerics(computed: Computed) -> Iterable[tuple[str, str]]:
    yield "contacts", f"{len(computed.case.body.offsets)}"
    for name, run in computed.chain.runs.items():
        yield f"energy residual, {name}", f"{run.every.energy.residual:.1e}"


def _stacked(computed: Computed, name: str) -> NDArray[np.float64]:
    return np.stack([getattr(run.every, name) for run in computed.chain.runs.values()])


def _motion(computed: Computed) -> NDArray[np.float64]:
    """Degrees of freedom of all bodies (laws, d, n), positive downwards, m."""
    levers = np.array(list(computed.bodies.degrees.values()))[:, None]
    runs = computed.chain.runs.values()
    return np.stack([-levers * np.concatenate(run.every.degrees_of_freedom) for run in runs])


def _rolling(computed: Computed) -> dict[Entry, object]:
    offsets = computed.case.body.offsets
    runs = [run.every for run in computed.chain.runs.values()]
    terms = list(runs[0].energy.shares())
    found: dict[Entry, object] = {
        schema.CONTACT: np.arange(1, len(offsets) + 1),
        schema.OFFSET: offsets,
        schema.STATIC_LOAD: loads_of(computed.bodies.rolling),
        schema.CONTACT_FORCES: _stacked(computed, "contact_force"),
        schema.APPROACHES: _stacked(computed, "relative_displacement"),
        schema.OVER_DISPLACEMENTS: _stacked(computed, "over_displacement"),
        schema.ROLLING_DISPLACEMENTS: _stacked(computed, "rolling_displacement"),
        schema.LOSS_SHARES: [1.0 - run.in_contact.mean(axis=1) for run in runs],
        schema.DEGREE: list(computed.bodies.degrees),
        schema.BODY_DISPLACEMENT: _motion(computed),
        schema.ENERGY_TERM: terms,
        schema.ENERGY: [[run.energy.shares()[term] for term in terms] for run in runs],
        schema.ENERGY_RESIDUAL: [run.energy.residual for run in runs],
    }
    if computed.bodies.sensors:
        found |= {
            schema.ROLLING_SENSOR: computed.bodies.sensors,
            schema.ACCELERATION: _stacked(computed, "acceleration"),
        }
    return found


def _spectra(computed: Computed) -> dict[Entry, object]:
    case, force = computed.case, _stacked(computed, "contact_force")
    step, highest = case.time_step, case.numerics.highest_frequency
    segment = spectrum_segment(force.shape[-1], step)
    frequency, density = psd(force, step, segment=segment)
    shown = drawn(frequency, highest)
    curvature = np.pad(np.diff(_motion(computed), 2) / step**2, ((0, 0), (0, 0), (1, 1)), mode="edge")
    _, curved = psd(curvature, step, segment=segment)
    half = np.pi * frequency * step
    to_acceleration = (half / np.sin(np.maximum(half, 1e-12))) ** 4  # from second differences
    found: dict[Entry, object] = {
        schema.SPECTRA_CONTACT: np.arange(1, force.shape[1] + 1),
        schema.FORCE_PSDS: density[..., shown],
        schema.FORCE_LEVELS: band_levels(frequency, density, high=highest)[1],
        schema.SUM_PSD: psd(force.sum(axis=1), step, segment=segment)[1][..., shown],
        schema.SPECTRA_DEGREE: list(computed.bodies.degrees),
        schema.BODY_ACCELERATION_PSD: (curved * to_acceleration)[..., shown],
    }
    if computed.bodies.sensors:
        density = psd(_stacked(computed, "acceleration"), step, segment=segment)[1]
        level = band_levels(frequency, density, schema.BODY_REFERENCE, high=highest)[1]
        found |= {
            schema.SPECTRA_SENSOR: computed.bodies.sensors,
            schema.ACCELERATION_PSD: density[..., shown],
            schema.ACCELERATION_LEVEL: level,
        }
    tones = passing_frequencies(case.body.offsets, case.speed, highest)
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
