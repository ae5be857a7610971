"""Axles that pass a receiver beside the track, and the levels of a pass-by."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

from asperity.arguments import Array, ArrayLike
from asperity.errors import ComputationError
from asperity.spectra import level_of
from asperity.written_numbers import rounded

STEPS = 25
"""Of a record, per distance of the receiver."""


@dataclass(frozen=True)
class Receiver:
    """Distance from the middle of the track, height above the rail head, m; by default of ISO 3095:2013."""

    distance: float = 7.5
    height: float = 1.2


@dataclass(frozen=True, eq=False)
class AxleSource:
    """What one axle makes radiate: its wheels, or the track around them.

    Parameters
    ----------
    power : ndarray (..., b)
        Sound power in each band, W.
    length : array_like (b,) or float
        Along the rail, m: the power is spread as exp(−2|ξ|/ℓ)/ℓ, ξ from the axle. Of a wave with the decay
        rate Δ, dB/m, ℓ is 8.686/Δ. Zero for a source in one place.
    height : float
        Above the rail head, m.
    motion : str
        ``"vertical"`` or ``"lateral"`` of a rail, which may radiate as dipoles; else ``"all"``.
    """

    power: Array
    length: ArrayLike = 0.0
    height: float = 0.0
    motion: str = "all"


@dataclass(frozen=True, eq=False)
class Passage:
    """Axles that pass at one speed; time zero is when the first of them is opposite the receiver.

    Parameters
    ----------
    axles : sequence of float
        Distances behind the first axle, m, rising from zero.
    speed : float
        m/s.
    length : float, optional
        Of the whole train, m, equally far beyond both outer axles. Without it half a mean distance of the
        axles is added at each end; one axle alone has no length then.
    """

    axles: Sequence[float]
    speed: float
    length: float | None = None

    @property
    def passed(self) -> tuple[float, float] | None:
        """Times, s, at which front and rear of the train are opposite the receiver; None without a length."""
        last = float(self.axles[-1])
        count = len(self.axles)
        if self.length is None and count == 1:
            return None
        length = last * count / (count - 1) if self.length is None else self.length
        beyond = 0.5 * (length - last)
        return -beyond / self.speed, (last + beyond) / self.speed

    def times(self, receiver: Receiver, longest: float = 0.0) -> Array:
        """Times (t,), s, evenly spaced, of a record in which the level rises and falls by more than 10 dB.

        `longest` is the greatest length of a source, m.
        """
        start, end = self.passed or (0.0, 0.0)
        beyond = -start * self.speed
        lead = 10.0 * receiver.distance + 3.0 * longest + 3.0 * beyond  # at 1/d² −10 dB are at 2.2 `beyond`
        first = start * self.speed - lead
        last = end * self.speed + lead
        count = int(np.ceil((last - first) / receiver.distance * STEPS)) + 1
        return np.linspace(first, last, count) / self.speed


REFERENCE_PRESSURE = 20e-6
"""Pa."""
FAST = 0.125
"""Time constant of time weighting F, s (IEC 61672-1)."""
DROP = 10.0
"""What the level has risen by, and falls by, in the measurement time of TEL, dB (ISO 3095:2013)."""


def pass_by_levels(time: ArrayLike, squared: ArrayLike, passed: tuple[float, float] | None) -> Array:
    """Levels of a pass-by by source, of which the last is the whole.

    Parameters
    ----------
    time : array_like (t,)
        s, evenly spaced.
    squared : array_like (s, t)
        Squared sound pressure of each source, A-weighted, Pa²; the last decides what time is measured.
    passed : tuple of float, optional
        Times at which front and rear of the train are opposite, s; without them there is a maximum only.

    Returns
    -------
    ndarray (3, s)
        L_pAFmax, with time weighting F; L_pAeq,Tp, from when the front is opposite to when the rear is; and
        TEL, the energy of the whole measured time over Tp; dB re 20 µPa, NaN where the train has no length.

    Raises
    ------
    ComputationError
        If the record does not rise and fall by 10 dB.

    Notes
    -----
    TEL is 10 lg (1/Tp) ∫ p_A²/p_0² dt from when the level lies 10 dB below that of the front just opposite to
    when it lies 10 dB below that of the rear (ISO 3095:2013). No time weighting enters it.
    """
    instants = np.asarray(time, dtype=float)
    parts = np.asarray(squared, dtype=float)
    step = float(instants[-1] - instants[0]) / (len(instants) - 1)
    maximum = pressure_level(time_weighted(parts, step).max(axis=-1))
    if passed is None:
        return np.array([maximum, *np.full((2, len(parts)), np.nan)])
    duration = passed[1] - passed[0]
    measured = _measured(instants, parts[-1], passed)
    means = [integral(instants, parts, *each) / duration for each in (passed, measured)]
    return np.array([maximum, *map(pressure_level, means)])


def time_weighted(squared: ArrayLike, step: float, time_constant: float = FAST) -> Array:
    """Squared pressure (..., t), Pa², with exponential time weighting, by default F.

    Exact for a squared pressure that is linear between its samples, `step` apart, s; it is steady before.
    """
    values = np.asarray(squared, dtype=float)
    kept = np.exp(-step / time_constant)
    mean = -np.expm1(-step / time_constant) * time_constant / step
    forced = (1.0 - mean) * values
    forced[..., 1:] += (mean - kept) * values[..., :-1]
    forced[..., 0] = values[..., 0]  # steady before
    bands = np.stack([np.ones(values.shape[-1]), np.full(values.shape[-1], -kept)])
    found = solve_banded((1, 0), bands, forced.reshape(-1, values.shape[-1]).T)  # y_n − kept y_n−1 = forced
    return found.T.reshape(values.shape)


def pressure_level(squared: ArrayLike) -> Array:
    """Level of a squared sound pressure, Pa², in dB re 20 µPa."""
    return level_of(np.asarray(squared, dtype=float) / REFERENCE_PRESSURE**2)


def _measured(time: Array, whole: Array, passed: tuple[float, float]) -> tuple[float, float]:
    """Times before the front and after the rear at which the level has fallen by `DROP`."""
    limits = np.interp(passed, time, whole) * 10.0 ** (-DROP / 10.0)
    before = np.flatnonzero((time < passed[0]) & (whole < limits[0]))
    after = np.flatnonzero((time > passed[1]) & (whole < limits[1]))
    if not before.size or not after.size:
        problem = f"the level does not fall by {DROP:g} dB before and after the train"
        between = f"between {rounded(time[0])} s and {rounded(time[-1])} s"
        raise ComputationError(f"{problem} {between}", "a record that begins earlier and ends later")
    rise, fall = (slice(at, at + 2) for at in (before[-1], after[0] - 1))
    start = np.interp(limits[0], whole[rise], time[rise])
    end = np.interp(-limits[1], -whole[fall], time[fall])
    return float(start), float(end)


def integral(time: Array, squared: Array, start: float, end: float) -> Array:
    """Integral from a start to an end of what (s, t) is linear between its samples, (s,)."""
    nodes = np.concatenate([[start], time[(time > start) & (time < end)], [end]])
    return np.trapezoid([np.interp(nodes, time, one) for one in squared], nodes, axis=1)
