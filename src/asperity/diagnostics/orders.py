"""Signals over the angle of what turns: orders, and what follows a changing speed told from what stays.

A line that follows the speed is one over orders, events in a turn, however the speed changes; over frequency
it is smeared. A resonance stays at its frequency and is smeared over orders.
"""

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, ArrayLike, finite_array, positive, require
from asperity.diagnostics.envelopes import Spectrum, amplitude_spectrum, band_envelope, checked_signal
from asperity.spectra import hann_window
from asperity.speeds import FEWEST_TURNS
from asperity.written_numbers import count_of, rounded

FINER = 1.25
"""Samples in a turn, over those that the record has where it is slowest."""
PER_OCTAVE = 24
"""Bands of an octave in which lines and resonances are told apart."""
ROUNDS = 60
"""Times that what follows and what stays are found in turn, each from what the other leaves."""
FLOOR = 1e-6
"""Of the largest amplitude, below which it is not told apart."""


def turns_of(speeds: ArrayLike, rate: float) -> Array:
    """Turns since the first sample (n,), of speeds (n,), 1/s, straight between samples at a rate, Hz."""
    at = finite_array("speeds (1/s)", speeds, "finite numbers above zero", shape=(None,), above=0.0)
    done = np.cumsum(0.5 * (at[1:] + at[:-1])) / positive("sampling rate (Hz)", rate)
    return np.concatenate([[0.0], done])


LEAST_CHANGE = 1.1
"""Factor between the speeds of a run-up, at least, to tell what follows them from what stays."""
EDGES = 5
"""Pulses of a tacho, at least."""
QUANTILES = (0.02, 0.98)
"""Between which a tacho's low and high level lie …"""
HYSTERESIS = (0.3, 0.7)
"""… and shares of their distance: a pulse has come when it was below the one and is above the other."""
UNEVEN = 1.5
"""Factor between two pulses beside each other from which on one was missed, or one too many."""


def turns_of_pulses(pulses: ArrayLike, per_turn: float = 1.0) -> Array:
    """Turns at each sample (n,) of a tacho that gives so many pulses in a turn; NaN beyond its pulses.

    A pulse comes where its rising flank crosses the middle between the low and the high level; between pulses
    the angle grows smoothly (monotone cubic interpolation).
    """
    from scipy.interpolate import PchipInterpolator

    values = finite_array("tacho", pulses, "finite numbers", shape=(None,))
    low, high = np.quantile(values, QUANTILES)
    low, high = (float(values.min()), float(values.max())) if high <= low else (float(low), float(high))
    require(high > low, "tacho", "the same number throughout", "pulses", "Is it the column of the tacho?")
    share = (values - low) / (high - low)
    state = np.where(share > HYSTERESIS[1], 1, np.where(share < HYSTERESIS[0], -1, 0))
    marked = np.flatnonzero(state)
    after = marked[1:][(state[marked[1:]] == 1) & (state[marked[:-1]] == -1)]
    crossed = []
    for place in after:  # back to where the flank passes the middle
        while share[place - 1] >= 0.5:
            place -= 1
        crossed.append(place - 1 + (0.5 - share[place - 1]) / (share[place] - share[place - 1]))
    at = np.array(crossed)
    require(len(at) >= EDGES, "tacho", count_of(len(at), "pulse"), f"at least {EDGES}")
    apart = np.diff(at)
    worst = int(np.argmax(np.abs(np.log(apart[1:] / apart[:-1]))))
    factor = max(apart[worst + 1] / apart[worst], apart[worst] / apart[worst + 1])
    received = f"pulses {rounded(factor, 3)} times as far apart as the next, near sample {at[worst + 1]:.0f}"
    require(factor < UNEVEN, "tacho", received, f"less than {UNEVEN:g} times", "Is one missing, or doubled?")
    count = np.arange(values.size)
    turns = PchipInterpolator(at, np.arange(len(at)) / positive("pulses in a turn", per_turn))(count)
    return np.where((count >= at[0]) & (count <= at[-1]), turns, np.nan)


def over_angle(signal: ArrayLike, turns: ArrayLike, *, per_turn: float | None = None) -> tuple[Array, float]:
    """Values of a signal at equal steps of angle, and how many there are in a turn.

    Parameters
    ----------
    signal : array_like (n,)
        At equal steps of time.
    turns : array_like (n,)
        At the same times, rising.
    per_turn : float, optional
        Values in a turn; by default by the samples where a turn takes longest.

    Returns
    -------
    values : ndarray (m,)
        By cubic splines, from the first sample on; finer than the samples where a turn takes longest, so that
        nothing of the signal is folded.
    per_turn : float
        Values in a turn.
    """
    from scipy.interpolate import make_interp_spline

    values = finite_array("signal", signal, "a series of finite numbers", shape=(None,))
    allowed = "as many turns as samples, each more than the one before"
    angle = finite_array("turns", turns, allowed, count=values.size, rising=True)
    whole = float(angle[-1] - angle[0])
    require(whole >= FEWEST_TURNS, "turns", f"{rounded(whole)} of the record", f"{FEWEST_TURNS:g} at least")
    per_turn = finest(angle) if per_turn is None else positive("values in a turn", per_turn)
    at = angle[0] + np.arange(int(whole * per_turn) + 1) / per_turn
    return make_interp_spline(angle, values, k=3)(at), per_turn


def finest(turns: Array) -> float:
    """Values in a turn with which nothing of a signal is folded that has samples at turns (n,)."""
    return float(np.ceil(FINER / np.diff(turns).min()))


def order_spectrum(signal: ArrayLike, turns: ArrayLike) -> Spectrum:
    """Amplitudes of lines of a signal over orders: events in a turn.

    Parameters
    ----------
    signal, turns
        As of `over_angle`.

    Returns
    -------
    order, amplitude : ndarray (f,)
        As `asperity.diagnostics.amplitude_spectrum` has them over frequency.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity.diagnostics.orders import order_spectrum, turns_of
    >>> turns = turns_of(np.linspace(10.0, 30.0, 8192), 4096.0)
    >>> order, amplitude = order_spectrum(np.cos(2 * np.pi * 3.5 * turns), turns)
    >>> print(f"{order[amplitude.argmax()]:.2f} in a turn, {amplitude.max():.2f}")
    3.50 in a turn, 1.00
    """
    return amplitude_spectrum(*over_angle(signal, turns))


def envelope_order_spectrum(
    signal: ArrayLike, rate: float, turns: ArrayLike, band: tuple[float, float]
) -> Spectrum:
    """Amplitudes of lines in the envelope of a signal over orders.

    What rings does so in a band of frequencies, Hz, that stays; how often it is struck follows the speed.
    """
    values, rate = checked_signal(signal, rate)
    return amplitude_spectrum(*over_angle(band_envelope(values, rate, *band), turns))


@dataclass(frozen=True, eq=False)
class RunUp:
    """A signal in pieces of a run-up: amplitudes over frequency at the speed of each.

    Attributes
    ----------
    speed : ndarray (p,)
        In the middle of each piece, turns per second, in the order of time.
    frequency : ndarray (f,)
        Hz.
    amplitude : ndarray (p, f)
        Of lines, by Hann windows, in the unit of the signal.
    """

    speed: Array
    frequency: Array
    amplitude: Array


def run_up(signal: ArrayLike, rate: float, speeds: ArrayLike, *, resolution: float) -> RunUp:
    """Cut a signal into pieces that overlap by half, each with its spectrum and its speed.

    Parameters
    ----------
    signal : array_like (n,)
        In any unit.
    rate : float
        Samples per second, Hz.
    speeds : array_like (n,)
        At each sample, turns per second.
    resolution : float
        Distance of lines, Hz; pieces are the inverse of it long.

    Returns
    -------
    RunUp
    """
    values, rate = checked_signal(signal, rate)
    at = finite_array("speeds (1/s)", speeds, "one for each sample, above zero", count=values.size, above=0.0)
    size = 2 * max(round(0.5 * rate / positive("resolution (Hz)", resolution)), 8)
    shortest = f"{2 * size} samples"
    require(2 * size <= values.size, "signal", count_of(values.size, "sample"), f"{shortest}, two pieces")
    window = hann_window(size, centred=True)
    starts = np.arange(0, values.size - size + 1, size // 2)
    pieces = np.lib.stride_tricks.sliding_window_view(values, size)[starts]
    amplitude = np.abs(np.fft.rfft(pieces * window)) * (2.0 / window.sum())
    frequency = np.fft.rfftfreq(size, 1.0 / rate)
    return RunUp(at[starts + size // 2], np.asarray(frequency), np.asarray(amplitude))


@dataclass(frozen=True, eq=False)
class ToldApart:
    """What of a run-up follows the speed and what stays, as factors: amplitude ≈ follows × stays.

    Attributes
    ----------
    order : ndarray (o,)
        Centres of bands, events in a turn.
    follows : ndarray (o,)
        In the unit of the signal: what excites, as a geometric mean over all pieces.
    frequency : ndarray (f,)
        Centres of bands, Hz.
    stays : ndarray (f,)
        Pure numbers about one: what resonates, and where.
    unexplained : float
        Rms of what the two leave, dB.
    """

    order: Array
    follows: Array
    frequency: Array
    stays: Array
    unexplained: float


def resonances_apart(found: RunUp, *, lowest: float) -> ToldApart:
    """Tell what follows the speed from what stays at its frequency, in bands of 1/24 octave.

    With logarithms of amplitude, frequency f and speed n, ``ln A = a(ln f) + b(ln f − ln n)``: a sum of two
    functions of one number each, found by turns, each as the mean of what the other leaves (backfitting).
    Both are known but for a constant, which b has, where the speed changes by more than a band.

    Parameters
    ----------
    found : RunUp
        Speeds must differ by a tenth at least.
    lowest : float
        Frequency from which on it is looked at, Hz: bands must hold a line, some 40 times the resolution.

    Returns
    -------
    ToldApart
    """
    share = found.speed.max() / found.speed.min()
    allowed = "speeds that differ by a tenth at least: at one speed nothing tells them apart"
    require(share >= LEAST_CHANGE, "run-up", f"speeds within a factor of {rounded(share, 4)}", allowed)
    highest = float(found.frequency[-1])
    require(lowest < 0.5 * highest, "lowest (Hz)", lowest, f"less than {rounded(0.5 * highest)}")
    bands = np.floor(PER_OCTAVE * np.log2(np.maximum(found.frequency, 1e-300) / lowest)).astype(int)
    kept = bands >= 0
    starts = np.flatnonzero(np.diff(bands[kept], prepend=-1))
    numbers = bands[kept][starts]
    lengths = np.diff(np.append(starts, np.count_nonzero(kept)))
    power = np.add.reduceat(found.amplitude[:, kept] ** 2, starts, axis=1) / lengths
    levels = 0.5 * np.log(np.maximum(power, FLOOR**2 * power.max()))
    shift = np.round(PER_OCTAVE * np.log2(found.speed / found.speed.min())).astype(int)
    orders = numbers[None, :] - shift[:, None]
    first = int(orders.min())
    place = (orders - first).ravel()
    count = np.bincount(place)
    stays = np.zeros(len(numbers))
    for _ in range(ROUNDS):
        follows = np.bincount(place, (levels - stays).ravel()) / np.maximum(count, 1)
        stays = (levels - follows[place].reshape(levels.shape)).mean(axis=0)
        stays -= stays.mean()
    left = levels - stays - follows[place].reshape(levels.shape)
    there = np.flatnonzero(count)
    middle = 2.0 ** (0.5 / PER_OCTAVE)
    order = lowest * 2.0 ** ((there + first) / PER_OCTAVE) * middle / found.speed.min()
    centres = lowest * 2.0 ** (numbers / PER_OCTAVE) * middle
    unexplained = float(20.0 / np.log(10.0) * np.sqrt(np.mean(left**2)))
    return ToldApart(order, np.exp(follows[there]), centres, np.exp(stays), unexplained)
