"""Signals of bearings whose fault is known: blows with slip and jitter in noise, written without the
package."""

import numpy as np

GEOMETRIES = {"6205": (9, 7.94 / 39.04), "6203": (8, 6.75 / 28.50)}
"""Number of balls, and diameter of a ball over that of the pitch circle."""
TURNING = {"outer": 0.0, "inner": 1.0, "ball": None, None: 0.0}


def orders(bearing, angle=0.0):
    """Blows per turn of the shaft by the part that is struck, and turns of the cage."""
    balls, ratio = GEOMETRIES[bearing] if isinstance(bearing, str) else bearing
    gamma = ratio * np.cos(angle)
    cage = 0.5 * (1.0 - gamma)
    return {
        "outer": balls * cage,
        "inner": balls * (1.0 - cage),
        "ball": (1.0 - gamma**2) / ratio,
        "cage": cage,
    }


def faulty_signal(
    part,
    speed,
    rate,
    duration,
    *,
    bearing="6205",
    angle=0.14,
    slip=0.005,
    jitter=0.01,
    resonance=0.28,
    damping=0.04,
    noise=0.5,
    shaft=0.2,
    foreign=(),
    hum=0.0,
    compliance=0.0,
    unlike=1.0,
    seed=0,
):
    """A record (n,) of a part that is struck, or of none, at a speed, Hz, and a sampling rate, Hz.

    Blows of height 1 ring at `resonance` times the rate; they are weighted by the load where their spot is,
    and come `slip` late on the mean and `jitter` of a period at random. Noise is an rms; `shaft` the
    amplitude of the shaft's first harmonic, falling; foreign lines are (Hz, amplitude); hum is that of 50 Hz
    and its odd multiples; compliance that of a sine at which the balls pass the load, and of the resonance
    that it modulates; every second blow of a ball, which meets the rings in turn, has the height `unlike`.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(int(duration * rate)) / rate
    signal = noise * rng.normal(size=time.size)
    order = orders(bearing, angle)
    for n in range(1, 9):
        signal += shaft / n * np.sin(2 * np.pi * n * speed * time + rng.uniform(0, 2 * np.pi))
    for frequency, amplitude in foreign:
        signal += amplitude * np.sin(2 * np.pi * frequency * time)
    for n in (1, 3, 5) if hum else ():
        signal += hum / n * np.sin(2 * np.pi * 50.0 * n * time)
    if compliance:
        passing = np.cos(2 * np.pi * order["outer"] * speed * time)
        carrier = np.convolve(rng.normal(size=time.size), _ring(rate, resonance, damping), "same")
        signal += compliance * passing + 0.3 * (1.0 + compliance * passing) * carrier / carrier.std()
    if part is None:
        return signal
    late = (
        1.0 + slip if part == "inner" else 1.0 - slip
    )  # the cage is slower: the inner ring meets more balls
    tone = order[part] * speed * late
    periods = 1.0 + jitter * rng.normal(size=int(duration * tone * 1.1) + 10)
    times = np.cumsum(periods) / tone
    times = times[times < time[-1]]
    turned = {"outer": 0.0, "inner": speed, "ball": order["cage"] * speed * (1.0 - slip)}[part]
    place = 2 * np.pi * turned * times + (0.0 if part == "outer" else rng.uniform(0, 2 * np.pi))
    weight = (
        np.maximum(1.0 - 0.5 / 0.7 * (1.0 - np.cos(place)), 0.0) ** 1.5
    )  # a load zone of some 130 degrees
    if part == "ball":
        weight = 0.25 + 0.75 * weight
        weight[1::2] *= unlike
    weight = weight * (1.0 + 0.1 * rng.normal(size=times.size))
    struck = np.zeros(time.size)
    np.add.at(struck, (times * rate).astype(int), weight)
    return signal + np.convolve(struck, _ring(rate, resonance, damping))[: time.size]


def _ring(rate, resonance, damping):
    """What a blow rings like: unit height, for some ten periods."""
    turns = np.arange(int(4.0 / (damping * 2 * np.pi * resonance)) + 2)
    return np.exp(-damping * 2 * np.pi * resonance * turns) * np.sin(2 * np.pi * resonance * turns)
