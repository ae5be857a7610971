"""Single numbers of a pass-by, by ISO 3095:2013: maximum with time weighting F, L_pAeq,Tp and TEL."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_banded

from asperity.errors import ComputationError, InputError

REFERENCE_PRESSURE = 20e-6
"""Pa."""
FAST = 0.125
"""Time constant of time weighting F, s (IEC 61672-1)."""
DROP = 10.0
"""What the level has risen by, and falls by, in the measurement time of TEL, dB (ISO 3095:2013)."""


@dataclass(frozen=True, eq=False)
class PassByLevels:
    """Levels of a pass-by by source, dB re 20 µPa, (s,) each; NaN where the train has no length."""

    maximum: NDArray[np.float64]  # L_pAFmax, with time weighting F
    equivalent: NDArray[np.float64]  # L_pAeq,Tp, from when the front is opposite to when the rear is
    transit_exposure: NDArray[np.float64]  # TEL: the energy of the whole measured time, over Tp


def pass_by_levels(time: ArrayLike, squared: ArrayLike, passed: tuple[float, float] | None) -> PassByLevels:
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
    PassByLevels

    Raises
    ------
    ComputationError
        If the record does not rise and fall by 10 dB.

    Notes
    -----
    TEL is 10 lg (1/Tp) ∫ p_A²/p_0² dt from when the level lies 10 dB below that of the front just opposite to
    when it lies 10 dB below that of the rear (ISO 3095:2013). No time weighting enters it.
    """
    instants, parts = np.asarray(time, dtype=float), np.asarray(squared, dtype=float)
    step = float(instants[-1] - instants[0]) / (len(instants) - 1)
    maximum = pressure_level(time_weighted(parts, step).max(axis=-1))
    if passed is None:
        unknown = np.full(maximum.shape, np.nan)
        return PassByLevels(maximum, unknown, unknown)
    duration = passed[1] - passed[0]
    measured = _measured(instants, parts[-1], passed)
    equivalent, exposed = (_integral(instants, parts, *each) / duration for each in (passed, measured))
    return PassByLevels(maximum, pressure_level(equivalent), pressure_level(exposed))


def time_weighted(squared: ArrayLike, step: float, time_constant: float = FAST) -> NDArray[np.float64]:
    """Squared pressure (..., t), Pa², with exponential time weighting, by default F.

    Exact for a squared pressure that is linear between its samples, `step` apart, s; it is steady before.
    """
    values = np.asarray(squared, dtype=float)
    if not (np.isfinite(step) and step > 0.0):
        raise InputError("time step (s)", step, "a finite positive number")
    kept = np.exp(-step / time_constant)
    mean = -np.expm1(-step / time_constant) * time_constant / step
    forced = (1.0 - mean) * values
    forced[..., 1:] += (mean - kept) * values[..., :-1]
    forced[..., 0] = values[..., 0]  # steady before
    bands = np.stack([np.ones(values.shape[-1]), np.full(values.shape[-1], -kept)])
    found = solve_banded((1, 0), bands, forced.reshape(-1, values.shape[-1]).T)  # y_n − kept y_n−1 = forced
    return np.asarray(found.T.reshape(values.shape))


def pressure_level(squared: ArrayLike) -> NDArray[np.float64]:
    """Level of a squared sound pressure, Pa², in dB re 20 µPa."""
    with np.errstate(divide="ignore"):
        return np.asarray(10.0 * np.log10(np.asarray(squared, dtype=float) / REFERENCE_PRESSURE**2))


def _measured(
    time: NDArray[np.float64], whole: NDArray[np.float64], passed: tuple[float, float]
) -> tuple[float, float]:
    """Times before the front and after the rear at which the level has fallen by `DROP`."""
    limits = np.interp(passed, time, whole) * 10.0 ** (-DROP / 10.0)
    before = np.flatnonzero((time < passed[0]) & (whole < limits[0]))
    after = np.flatnonzero((time > passed[1]) & (whole < limits[1]))
    if not before.size or not after.size:
        what = f"the level does not fall by {DROP:g} dB before and after the train"
        told = f"{what} between {time[0]:.3g} s and {time[-1]:.3g} s"
        raise ComputationError(told, "a record that begins earlier and ends later")
    rise, fall = (slice(at, at + 2) for at in (before[-1], after[0] - 1))
    start = np.interp(limits[0], whole[rise], time[rise])
    end = np.interp(-limits[1], -whole[fall], time[fall])
    return float(start), float(end)


def _integral(
    time: NDArray[np.float64], squared: NDArray[np.float64], start: float, end: float
) -> NDArray[np.float64]:
    """Integral of what is linear between its samples, (s,)."""
    within = (time > start) & (time < end)
    nodes = np.concatenate([[start], time[within], [end]])
    ends = np.stack([[np.interp(at, time, one) for at in (start, end)] for one in squared])
    values = np.concatenate([ends[:, :1], squared[:, within], ends[:, 1:]], axis=1)
    return np.asarray(np.trapezoid(values, nodes, axis=1))
