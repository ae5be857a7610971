"""Spectra of a bearing's signal: its lines, those of its envelope, and velocities in bands.

Long records are transformed by NumPy: SciPy keeps tables for the last lengths, thirty megabytes in all.
"""

import math
from collections.abc import Iterable

import numpy as np
from scipy import fft

from asperity.arguments import Array, ArrayLike, finite_array, one_of, positive, require
from asperity.spectra import band_energies, hann_window, psd
from asperity.written_numbers import count_of

ISO_BANDS = ((50.0, 300.0), (300.0, 1800.0), (1800.0, 10_000.0))
"""Hz, of a bearing at 1800 1/min (ISO 15242-2)."""
FLOOR = 1e-9
"""Of the largest line of a spectrum: what is lower, as behind a filter, is not made as large as the
others."""
Spectrum = tuple[Array, Array]


def checked_signal(signal: ArrayLike, rate: float, *, still: bool = False) -> tuple[Array, float]:
    """A signal (n,) without its mean, and its sampling rate, Hz, or what is wrong with either.

    One that is the same throughout is allowed where it may be ``still``.
    """
    values = finite_array("signal", signal, "a series of finite numbers", shape=(None,))
    require(values.size >= 64, "signal", count_of(values.size, "sample"), "at least 64")
    require(still or np.ptp(values) > 0.0, "signal", "the same number throughout", "a signal that varies")
    return values - values.mean(), positive("sampling rate (Hz)", rate)


def amplitude_spectrum(signal: ArrayLike, rate: float) -> Spectrum:
    """Amplitudes of the lines of a signal, by a Hann window over all of it.

    Parameters
    ----------
    signal : array_like (n,)
        In any unit.
    rate : float
        Samples per second, Hz.

    Returns
    -------
    frequency, amplitude : ndarray (f,)
        Hz, at half the step that the record resolves, and in the unit of the signal: a sine of amplitude A
        has A at its frequency, less at most 4 % between two places.
    """
    amplitude, step = _amplitudes(signal, rate)
    return _places(amplitude, step), amplitude


def _places(amplitude: Array, step: float) -> Array:
    """Frequencies (f,), Hz, of lines at a step."""
    frequency = np.arange(float(amplitude.size))
    frequency *= step
    return frequency


def _amplitudes(signal: ArrayLike, rate: float) -> tuple[Array, float]:
    """Amplitudes (f,) of `amplitude_spectrum`, and the step between them, Hz."""
    from scipy.fft import next_fast_len

    values, rate = checked_signal(signal, rate)
    size = next_fast_len(2 * values.size, real=True)
    window = hann_window(values.size, centred=True)
    weight = window.sum()
    values *= window
    del window  # here and below: records may be as long as memory allows
    lines = np.fft.rfft(values, size)
    del values
    amplitude = np.abs(lines)
    del lines
    amplitude *= 2.0
    amplitude /= weight
    return np.asarray(amplitude, dtype=np.float64), rate / size


def mean_spectrum(signals: Iterable[tuple[Array, float]], rate: float) -> tuple[Spectrum, float]:
    """Root mean square of the amplitude spectra of signals of one length, each over its level.

    Lines of blows that come by their own clock widen as a record grows longer; in pieces they stay lines.

    Parameters
    ----------
    signals : iterable of (ndarray (n,), float)
        With the level of each, in its unit: a louder one counts no more than the others.
    rate : float
        Samples per second, Hz.

    Returns
    -------
    spectrum : (ndarray, ndarray)
        As of `amplitude_spectrum`, of a signal that has the mean level.
    level : float
        The mean level.
    """
    step = 0.0
    power = np.zeros(0)
    levels = list[float]()
    for signal, level in signals:
        levels.append(level)
        amplitude, step = _amplitudes(signal, rate)
        amplitude *= levels[0] / level
        amplitude *= amplitude
        if power.size:
            amplitude += power
        power = amplitude
        del signal, amplitude  # not held beside the next one
    mean = float(np.mean(levels))
    power /= len(levels)
    np.sqrt(power, out=power)
    power *= mean / levels[0]
    return (_places(power, step), power), mean


def envelope_spectrum(signal: ArrayLike, rate: float, band: tuple[float, float] | None = None) -> Spectrum:
    """Amplitudes of the lines in the envelope of a signal: how often, and how evenly, it is struck.

    Parameters
    ----------
    signal, rate
        As of `amplitude_spectrum`: acceleration.
    band : (float, float), optional
        Part of its frequencies that is taken, as around a resonance, Hz; all by default.

    Returns
    -------
    frequency, amplitude : ndarray (f,)
        Hz, and in the unit of the signal; of the magnitude of the analytic signal, less its mean. Up to the
        width of the band.

    Notes
    -----
    R. B. Randall and J. Antoni, Mechanical Systems and Signal Processing 25 (2011) 485.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity.diagnostics import envelope_spectrum
    >>> time = np.arange(8192) / 8192
    >>> struck = (1 + 0.5 * np.cos(2 * np.pi * 40 * time)) * np.sin(2 * np.pi * 1500 * time)
    >>> frequency, amplitude = envelope_spectrum(struck, 8192, (1000, 2000))
    >>> print(f"{frequency[amplitude.argmax()]:.0f} Hz, {amplitude.max():.3f}")
    40 Hz, 0.500
    """
    values, rate = checked_signal(signal, rate)
    low, high = (0.0, 0.5 * rate) if band is None else band
    received = f"{low:g} to {high:g} Hz"
    allowed = f"rising, within 0 to {0.5 * rate:g} Hz"
    require(0.0 <= low < high <= 0.5 * rate, "band", received, allowed)
    frequency, amplitude = amplitude_spectrum(band_envelope(values, rate, low, high), rate)
    kept = frequency <= high - low
    return frequency[kept], amplitude[kept]


def band_envelope(values: Array, rate: float, low: float, high: float) -> Array:
    """Size (n,) of the analytic signal of what lies between two frequencies, Hz."""
    frequency = np.arange((values.size + 1) // 2) * (rate / values.size)
    first = np.searchsorted(frequency, low)
    last = np.searchsorted(frequency, high, side="right")
    del frequency
    lines = np.fft.rfft(values)
    lines[:first] = 0.0
    lines[last:] = 0.0
    envelope = np.fft.irfft(lines, values.size)
    lines *= -1j
    turned = np.fft.irfft(lines, values.size)  # by a quarter of a period
    del lines
    envelope *= envelope
    turned *= turned
    envelope += turned
    return np.asarray(np.sqrt(envelope, out=envelope))


def above_frequency(values: Array, rate: float, lowest: float) -> Array:
    """What of a signal (n,) lies above a frequency, Hz."""
    lines = np.fft.rfft(values)
    lines[: int(lowest * values.size / rate)] = 0.0
    return np.fft.irfft(lines, values.size)


def prewhitened(signal: ArrayLike, rate: float) -> Array:
    """A signal all of whose lines are equally high, so that only their phases are left: what is impulsive
    stays.

    Parameters
    ----------
    signal, rate
        As of `amplitude_spectrum`.

    Returns
    -------
    ndarray (n,)
        Of mean square 1 or less, without unit.

    Notes
    -----
    The cepstrum is set to zero but for its first value, whether it stems from discrete lines, as of gears and
    hum, or from resonances, which hide small blows in other bands. P. Borghesani, P. Pennacchi, R. B.
    Randall, N. Sawalhi and R. Ricci, Mechanical Systems and Signal Processing 36 (2013) 370; W. A. Smith and
    R. B. Randall, ibid. 64–65 (2015) 100, who find it to help with most records of faulty bearings.
    """
    values, _ = checked_signal(signal, rate)
    lines = np.fft.rfft(values)
    size = np.abs(lines)
    np.maximum(size, FLOOR * size.max(), out=size)
    lines /= size
    count = values.size
    del values, size
    white = np.fft.irfft(lines, count)
    white *= np.sqrt(count)
    return white


def band_velocities(
    signal: ArrayLike,
    rate: float,
    bands: tuple[tuple[float, float], ...] = ISO_BANDS,
    *,
    quantity: str = "velocity",
) -> Array:
    """Rms velocity of a signal in bands, by default those in which bearings are judged.

    Parameters
    ----------
    signal : array_like (n,)
        Velocity, m/s, or acceleration, m/s².
    rate : float
        Samples per second, Hz.
    bands : tuple of (float, float)
        Edges, Hz.
    quantity : {"velocity", "acceleration"}
        What the signal is.

    Returns
    -------
    ndarray (bands,)
        m/s, none of a signal that does not vary; NaN where the sampling does not reach the upper edge.

    Notes
    -----
    ISO 15242-2: the outer ring, radially, at 1800 1/min of the inner one under an axial load. Its bands have
    slopes at their edges; these end there.
    """
    values, rate = checked_signal(signal, rate, still=True)
    one_of("quantity", quantity, ("velocity", "acceleration"))
    frequency, density = psd(values, 1.0 / rate)
    if quantity == "acceleration":
        density = density / (2.0 * np.pi * np.maximum(frequency, frequency[1])) ** 2
    low, high = np.array(bands, dtype=float).T
    rms = np.sqrt(np.maximum(band_energies(frequency, density, low, high), 0.0))
    return np.where(high <= 0.5 * rate, rms, np.nan)


ANDERON = 25.4e-9
"""Way of one anderon, a microinch for each radian of a turn, m: of a band as wide as an octave."""


def one_anderon(speed: float, bands: tuple[tuple[float, float], ...] = ISO_BANDS) -> Array:
    """Rms velocities in bands that are one anderon.

    Parameters
    ----------
    speed : float
        Of the ring that turns, turns per second.
    bands : tuple of (float, float)
        Edges, Hz.

    Returns
    -------
    ndarray (bands,)
        m/s.

    Notes
    -----
    An anderon is a microinch of radial way for each radian of a turn, the rms of a band over the root of its
    octaves: Sugawara Laboratories, units of measurement (of their instruments), where the bands end at
    10 800 Hz and one is 7.698 µm/s at 1800 1/min in each of the three. That of ISO 15242 ends at 10 kHz.

    Examples
    --------
    >>> from asperity.diagnostics import one_anderon
    >>> " ".join(f"{each * 1e6:.3f}" for each in one_anderon(1800 / 60))
    '7.698 7.698 7.531'
    """
    low, high = np.array(bands, dtype=float).T
    return ANDERON * 2.0 * np.pi * positive("speed (1/s)", speed) * np.sqrt(np.log2(high / low))


PARTS = 8
"""Parts of a record by which it is known how sure a velocity in a band is."""


def band_deviations(
    acceleration: ArrayLike, rate: float, bands: tuple[tuple[float, float], ...] = ISO_BANDS
) -> Array:
    """Standard deviation of the rms velocity in bands by the chance of one record, over it.

    The mean square of so many parts of the record scatters about that of all of it. Lines that beat within
    a part, as those of waviness do, do not scatter; what is drawn anew with another seed is not in it.

    Parameters
    ----------
    acceleration : array_like (n,)
        m/s².
    rate : float
        Samples per second, Hz.
    bands : tuple of (float, float)
        Edges, Hz.

    Returns
    -------
    ndarray (bands,)
        NaN where the sampling does not reach the upper edge, the record is too short for the band, or
        nothing varies.
    """
    values, rate = checked_signal(acceleration, rate, still=True)
    spectrum = fft.rfft(values - values.mean())
    frequency = fft.rfftfreq(len(values), 1.0 / rate)
    velocity = spectrum / (2j * np.pi * np.maximum(frequency, frequency[1]))
    found = np.full(len(bands), np.nan)
    for n, (low, high) in enumerate(bands):
        within = (frequency >= low) & (frequency < high)
        squares = fft.irfft(velocity * within, len(values)) ** 2
        means = squares[: len(values) // PARTS * PARTS].reshape(PARTS, -1).mean(axis=1)
        if high <= 0.5 * rate and within.any() and squares.any():
            # the rms varies by half of what its square does
            found[n] = 0.5 * means.std(ddof=1) / math.sqrt(PARTS) / means.mean()
    return found
