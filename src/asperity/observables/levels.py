"""Levels in one-third octaves of a run: sound beside a track, contact force, acceleration."""

from contextlib import suppress
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.case.any_case import AnyCase
from asperity.case.in_memory import name_of
from asperity.case.measured import band_numbers, read_band_levels
from asperity.case.scene import Case
from asperity.case.table_headings import Column
from asperity.case.tables import TableSource, read_table
from asperity.observables.decay_rates import keys_of_track, no_track
from asperity.observables.observable import Collected, Measured, Observable, Predictable, Values
from asperity.scenes import schema
from asperity.schema import Entry, spectra
from asperity.spectra import energy_mean, in_bands

SOUND = "sound pressure level"
FORCE = "contact force level"
ACCELERATION = "acceleration level"
_FREQUENCY = Column("frequency", "Hz")
_BY_CHANCE = 1.0
"""Standard deviation of a level that one record gives, dB, where nothing tells it."""


def levels_in_bands(collected: Collected, name: str, at: Array) -> Array:
    """Levels of a run (..., n) in bands by their centres (n,), Hz; NaN in those that it has not."""
    return in_bands(at, collected[f"{name}_band"], collected[name])


def _collect(entry: Entry, tree: DataTree) -> Collected:
    """Levels of the main law, with their bands."""
    levels = tree[entry.path].isel(law=0)
    if "radiator" in levels.dims:
        levels = levels.sel(radiator="total")
    if "contact" in levels.dims:
        levels = levels.isel(contact=0)
    held = {entry.name: levels}
    with suppress(KeyError):  # as of a run that told none
        held[spectra.LEVEL_DEVIATION.name] = tree[spectra.LEVEL_DEVIATION.path]
    found = Collected()
    for name, each in held.items():
        found |= {name: np.asarray(each.values), f"{name}_band": np.asarray(each["band"].values)}
    return found


def _chance(collected: Collected, measured: Measured) -> Array:
    """Standard deviation of a level by the chance of one record (n,), dB; none where it is not known."""
    if spectra.LEVEL_DEVIATION.name not in collected:
        return np.zeros(len(measured.at))
    return levels_in_bands(collected, spectra.LEVEL_DEVIATION.name, measured.at)


# --- sound


def _no_passage(case: Any) -> str:
    if lacks := no_track(case):
        return lacks
    return "" if case.passage.passed is not None else "no pass-by time: noise.vehicle_length is not given"


def _sound(trial: Predictable, measured: Measured) -> Values:
    """Equivalent levels over the pass-by time."""
    passed = trial.whole.passage.passed
    exposure = levels_in_bands(trial.collected, schema.SOUND_EXPOSURE_LEVEL.name, measured.at)
    return exposure - 10.0 * np.log10(passed[1] - passed[0])


def _read_sound(table: TableSource) -> list[Measured]:
    return [Measured(SOUND, *read_band_levels(table), source=name_of(table))]


# --- force and acceleration


def _no_rolling(case: AnyCase) -> str:
    return "" if isinstance(case, Case) else f"no bodies that roll: it is of kind {case.kind}"


def _no_sensors(case: Any) -> str:
    if lacks := _no_rolling(case):
        return lacks
    sensed = case.rolled_over.sensor_positions and keys_of_track(case) is None
    return "" if sensed else "no accelerometers on what is rolled over"


def _force(trial: Predictable, measured: Measured) -> Values:
    return levels_in_bands(trial.collected, spectra.FORCE_LEVEL.name, measured.at)


def _acceleration(trial: Predictable, measured: Measured) -> Values:
    """Of the sensor nearest to the place of the response; without one the energy mean of all."""
    held = levels_in_bands(trial.collected, schema.ACCELERATION_LEVEL.name, measured.at)
    if measured.places is not None:
        sensors = np.array(trial.case.rolled_over.sensor_positions)
        apart = np.abs(sensors - measured.places[0])
        return held[apart.argmin()]
    return energy_mean(held, axis=0)


def _read_levels(what: str, reference: str, table: TableSource) -> list[Measured]:
    rows = read_table(table, (_FREQUENCY, Column("level", "dB", reference)))
    centres = 10.0 ** (0.1 * band_numbers(table, rows[:, 0]))
    return [Measured(what, centres, rows[:, 1], source=name_of(table))]


def _of_texture(case: Case) -> tuple[str, ...]:
    """Keys that raise or lower all levels."""
    surface = case.surface
    if surface.rms is not None:
        return ("surface.rms",)
    return ("surface.level",) if surface.spectrum is not None else ("speed",)


def _of_sound(case: Case) -> tuple[str, ...]:
    return ("noise.receiver_offset",)


def _of_beam(case: Case) -> tuple[str, ...]:
    losses = (f"{case.OVER}.loss_factor",) if "loss_factor" in case.rolled_over.keys else ()
    return (*_of_texture(case), *losses)


OBSERVABLES = (
    Observable(FORCE, "dB re 1 N", "frequency (Hz)", 0.0, _BY_CHANCE, _no_rolling, _force, _of_texture,
               r"dB re\.? ?1? ?N\b|force level", lambda table: _read_levels(FORCE, "1 N", table),
               lambda tree: _collect(spectra.FORCE_LEVEL, tree), ("measured.force_level",), _chance),
    Observable(ACCELERATION, "dB re 1e-6 m/s²", "frequency (Hz)", 0.0, _BY_CHANCE, _no_sensors, _acceleration,
               _of_beam, r"acceleration level|dB re\.? ?[^,;]*m/s(\^?2|²)",
               lambda table: _read_levels(ACCELERATION, "1 um/s^2", table),
               lambda tree: _collect(schema.ACCELERATION_LEVEL, tree), ("measured.acceleration_level",),
               _chance),
    Observable(SOUND, "dB re 20 µPa", "frequency (Hz)", 0.0, _BY_CHANCE, _no_passage, _sound, _of_sound,
               r"dB ?\(A\)|sound|pass.?by|L_?p|\bdB\b", _read_sound,
               lambda tree: _collect(schema.SOUND_EXPOSURE_LEVEL, tree), ("noise.measured_bands",), _chance),
)  # fmt: skip
