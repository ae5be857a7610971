"""What is measured at a ball bearing: tones of its parts, velocities in bands, lines of the envelope."""

from contextlib import suppress
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.case.any_case import AnyCase
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.case.in_memory import name_of
from asperity.case.table_headings import Column
from asperity.case.tables import TableSource, read_table
from asperity.diagnostics import ISO_BANDS
from asperity.observables.observable import Collected, Measured, Observable, Predictable, Values, reader
from asperity.schema import bearing
from asperity.structures.rolling_bearing import PARTS

TONE = "bearing tone"
VELOCITY = "bearing band velocity"
LINE = "envelope line"
NEAR = 0.02
"""By which part a line may lie beside the frequency that was measured: cages slip."""
CHANCE_OF_LINE = 0.4
"""dB, of a line by one record: under a radial load balls come and go, from another phase in each. So much do
lines of an outer fault of a 6205 differ between records of 0.2 s under loads beside each other, the fifth by
0.5 dB and the first by 0.1 dB; an axial load leaves less."""
_FREQUENCY = Column("frequency", "Hz")


def _no_bearing(case: AnyCase) -> str:
    return "" if isinstance(case, BearingUnderLoad) else f"no bearing: it is of kind {case.kind}"


# --- tones: the ring that turns, and the cage and the parts it is met by


def _tones(case: BearingUnderLoad) -> Array:
    """Tones of outer raceway, inner raceway, balls, and turns of the cage, Hz."""
    turning = case.kinematics
    return np.array([*(turning.tone(part) for part in PARTS), turning.cage])


def _tone(trial: Predictable, measured: Measured) -> Values:
    """The tones nearest to those that were measured."""
    tones = _tones(trial.case)
    apart = np.abs(np.log(measured.at[:, None] / tones))
    return tones[apart.argmin(axis=1)]


def _read_tones(table: TableSource) -> list[Measured]:
    frequency = read_table(table, (Column("tone", "Hz"),))[:, 0]
    return [Measured(TONE, frequency, frequency, source=name_of(table))]


def _of_angle(case: BearingUnderLoad) -> tuple[str, ...]:
    return ("axial",) if case.axial else ("speed",)


# --- what vibrates


def _collect_velocity(tree: DataTree) -> Collected:
    found = {bearing.BAND_VELOCITY.name: tree[bearing.BAND_VELOCITY.path]}
    with suppress(KeyError):  # as of a record too short to tell it
        found[bearing.BAND_DEVIATION.name] = tree[bearing.BAND_DEVIATION.path]
    return {name: np.asarray(each.isel(law=0, ring_sensor=0).values) for name, each in found.items()}


def _in_iso_bands(values: Array, at: Array) -> Array:
    """Of the band of ISO 15242-2 that holds each frequency; NaN outside of all."""
    found = np.full(at.shape, np.nan)
    for value, (low, high) in zip(values, ISO_BANDS, strict=True):
        found[(at >= low) & (at < high)] = value
    return found


def _velocity(trial: Predictable, measured: Measured) -> Values:
    return _in_iso_bands(trial.collected[bearing.BAND_VELOCITY.name], measured.at)


def _chance_of_velocity(collected: Collected, measured: Measured) -> Array:
    """Standard deviation of a velocity by the chance of one record (n,), dB."""
    if bearing.BAND_DEVIATION.name not in collected:
        return np.zeros(len(measured.at))
    return 20.0 / np.log(10.0) * _in_iso_bands(collected[bearing.BAND_DEVIATION.name], measured.at)


def _collect_line(tree: DataTree) -> Collected:
    envelope = tree[bearing.ENVELOPE.path].isel(law=0)
    frequency = np.asarray(envelope["envelope_frequency"].values)
    found = {"envelope": np.asarray(envelope.values), "envelope_frequency": frequency}
    facts = tree[bearing.ENVELOPE_LOW.group].attrs
    ends = [facts[each.name] for each in (bearing.ENVELOPE_LOW, bearing.ENVELOPE_HIGH) if each.name in facts]
    return found | ({"envelope_band": np.array(ends)} if ends else {})


def _chosen_band(trial: Predictable) -> dict[str, Any]:
    """The band of the envelope, where the run chose it: another one has other lines, by tens of decibels."""
    if trial.case.envelope_band is not None or "envelope_band" not in trial.collected:
        return {}
    return {"envelope_band": tuple(trial.collected["envelope_band"].tolist())}


def _line(trial: Predictable, measured: Measured) -> Values:
    """The largest amplitude near each frequency; NaN beyond the envelope that was computed."""
    lines = trial.collected["envelope_frequency"]
    amplitude = trial.collected["envelope"]
    found = []
    for at in measured.at:
        near = np.abs(lines - at) <= NEAR * at
        found.append(amplitude[near].max() if near.any() else np.nan)
    return np.array(found)


def _chance_of_line(collected: Collected, measured: Measured) -> Array:
    """Standard deviation of a line by the chance of one record (n,), dB."""
    return np.full(len(measured.at), CHANCE_OF_LINE)


def _of_load(case: BearingUnderLoad) -> tuple[str, ...]:
    return tuple(name for name in ("radial", "axial") if getattr(case, name)) or ("radial",)


OBSERVABLES = (
    Observable(TONE, "Hz", "frequency (Hz)", 20.0, 0.01, _no_bearing, _tone, _of_angle,
               r"\btones? ?\(", _read_tones, keys=("measured.tone",)),
    Observable(VELOCITY, "m/s", "frequency (Hz)", 20.0, 1.0, _no_bearing, _velocity, _of_load,
               r"velocity", reader(VELOCITY, _FREQUENCY, Column("velocity", "m/s")), _collect_velocity,
               ("measured.band_velocity",), _chance_of_velocity, jumps=True),
    Observable(LINE, "m/s²", "frequency (Hz)", 20.0, 1.0, _no_bearing, _line, _of_load,
               r"envelope|amplitude.*m/s(\^?2|²)", reader(LINE, _FREQUENCY, Column("amplitude", "m/s^2")),
               _collect_line, ("measured.envelope_line",), _chance_of_line, _chosen_band, jumps=True),
)  # fmt: skip
