"""What the acceleration of a bearing says: velocities in bands, its envelope, and which part is heard."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from asperity import diagnostics
from asperity.arguments import Array
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.diagnostics import ISO_BANDS, LineFamily, Spectrum, band_velocities, one_anderon
from asperity.diagnostics.orders import envelope_order_spectrum
from asperity.rolling.bearing import RolledBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values, bearing, spectra
from asperity.speeds import SpeedCourse
from asperity.structures.rolling_bearing import PARTS

HARMONICS = 5
REACH = 1.2
"""How far the envelope spectrum is kept, beyond the highest harmonic of a tone."""
RESOLVED = 0.003
"""Share by which a line may lie beside the tone of pure rolling, beyond the slip of the cage."""
SILENT = 1e-5
"""Amplitude of a line, m/s², that no accelerometer feels: what is left of rounding and of the start."""


def heard_group(case: BearingUnderLoad, runs: Mapping[str, RolledBearing]) -> Values:
    """Lay out velocities in bands at all sensors; spectrum, envelope and lines in it at the first one."""
    rate = case.sampling_rate
    signals = [run.acceleration for run in runs.values()]
    families = case.kinematics.families
    highest = REACH * HARMONICS * max(tone for tone, _ in families.values())
    low, high = case.envelope_band or diagnostics.impulsive_band(signals[0][0], rate, highest)
    lines = [diagnostics.amplitude_spectrum(law[0], rate) for law in signals]
    frequency = lines[0][0]
    kept = (frequency > 0.0) & (frequency <= case.highest_frequency)
    struck = [envelope_at_fastest(case, law[0], (low, high)) for law in signals]
    slip = max(case.cage_slip) + RESOLVED
    found = [diagnostics.explained_lines(each, families, slip=slip, harmonics=HARMONICS) for each in struck]
    clear = [diagnostics.clear_families(each, SILENT) for each in found]
    judged = [
        [band_velocities(one * run.vibrates, rate, quantity="acceleration") for one in run.acceleration]
        for run in runs.values()
    ]
    for n, run in enumerate(runs.values()):
        if run.vibrates:
            continue
        # what rounding leaves is no result
        lines[n], struck[n] = ((at, np.full_like(size, np.nan)) for at, size in (lines[n], struck[n]))
        found[n] = {
            part: replace(each, **{what: np.nan * getattr(each, what) for what in LINES.values()})
            for part, each in found[n].items()
        }
    steady: Values = {}
    if not isinstance(case.speed, SpeedCourse):
        steady = {bearing.BAND_ANDERONS: np.array(judged) / one_anderon(case.speed)}
    return {
        **steady,
        spectra.LAW: list(runs),
        spectra.FREQUENCY: frequency[kept],
        bearing.VELOCITY_AMPLITUDE: [each[kept] / (2.0 * np.pi * frequency[kept]) for _, each in lines],
        bearing.SENSOR: case.sensors,
        bearing.JUDGED_BAND: [f"{first:g} to {last:g} Hz" for first, last in ISO_BANDS],
        bearing.BAND_VELOCITY: judged,
        bearing.ENVELOPE_LOW: low,
        bearing.ENVELOPE_HIGH: high,
        bearing.ENVELOPE_SPEED: float(case.speed),
        **envelope_group(list(runs), struck, found, clear, highest),
    }


def envelope_group(
    names: Sequence[str],
    struck: Sequence[Spectrum],
    found: Sequence[Mapping[str, LineFamily]],
    clear: Sequence[Sequence[str]],
    highest: float,
    units: str = bearing.ENVELOPE.units,
) -> Values:
    """Lay out spectra of envelopes by name up to a frequency, Hz, lines of the parts, and which are clear."""
    frequency = struck[0][0]
    within = frequency <= highest
    envelopes = np.array([each[within] for _, each in struck])
    return {
        bearing.LAW: names,
        bearing.ENVELOPE_FREQUENCY: frequency[within],
        bearing.ENVELOPE: bearing.ENVELOPE.variable(envelopes, units=units),
        bearing.HARMONIC: 1 + np.arange(HARMONICS),
        **{entry: [_of_lines(each, what) for each in found] for entry, what in LINES.items()},
        bearing.LINES_FOUND: [[float(part in each) for part in PARTS] for each in clear],
    }


def envelope_at_fastest(case: BearingUnderLoad, signal: Array, band: tuple[float, float]) -> Spectrum:
    """Spectrum of the envelope of a signal; of a run-up over angle, orders as frequencies at the fastest."""
    rate = case.sampling_rate
    if not isinstance(case.speed, SpeedCourse):
        return diagnostics.envelope_spectrum(signal, rate, band)
    turns = case.speed.covered(np.arange(signal.size) / rate)
    if not np.ptp(signal):
        return diagnostics.envelope_spectrum(signal, rate, band)
    order, amplitude = envelope_order_spectrum(signal, rate, turns, band)
    kept = order * case.speed <= band[1] - band[0]
    return order[kept] * float(case.speed), amplitude[kept]


LINES = {
    bearing.LINE_FREQUENCY: "frequency",
    bearing.LINE_AMPLITUDE: "amplitude",
    bearing.LINE_SIDE_BANDS: "side_bands",
}


def _of_lines(found: Mapping[str, LineFamily], what: str) -> list[Array]:
    """Numbers of the lines of each part (parts, harmonics), of side bands the larger; NaN if not reached."""
    values = [getattr(found[part], what) for part in PARTS]
    each = [value.max(axis=1) if value.ndim == 2 else value for value in values]
    return [np.pad(value, (0, HARMONICS - len(value)), constant_values=np.nan) for value in each]


OBSERVER = Observer(
    "bearing_heard",
    DECLARED,
    lambda computed: heard_group(computed.case, computed.rolled),
    needs=("bearing",),
    sources=(
        "ISO 15242-2 (velocities in three bands).",
        "Sugawara Laboratories, units of measurement (anderon).",
        "R. B. Randall and J. Antoni, Mechanical Systems and Signal Processing 25 (2011) 485 (envelope).",
        "J. Antoni, Mechanical Systems and Signal Processing 21 (2007) 108 (spectral kurtosis, of the band).",
    ),
)
