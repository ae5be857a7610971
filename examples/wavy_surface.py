"""
From first crests to full contact
=================================

Two surfaces without end are pressed together, one of them wavy along and across, Δ cos(2πx/λ) cos(2πy/λ).
The grid is one period: ``boundary="periodic"``. Light loads rest on Hertz's circles, one on a crest; at p* =
√2 π E* Δ/λ the contact is complete (Johnson, Greenwood and Higginson, 1985). A random surface of the same rms
slope begins with less, in proportion to the load, overtakes, and leaves its deepest valleys open at p*.
"""

import matplotlib.pyplot as plt
import numpy as np

from asperity import HalfSpace

MODULUS, LENGTH, CELLS, AMPLITUDE = 115e9, 1e-3, 128, 0.2e-6  # Pa, m, cells, m
full = np.sqrt(2) * np.pi * MODULUS * AMPLITUDE / LENGTH
wave = np.cos(2 * np.pi * np.arange(CELLS) / CELLS)
half_space = HalfSpace((CELLS, CELLS), LENGTH / CELLS, MODULUS, boundary="periodic")
loads = np.array([0.003, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.97, 1.0])
wavy = [half_space.solve(-AMPLITUDE * np.outer(wave, wave), load=p * full * LENGTH**2) for p in loads]

# %%
# A self-affine surface, its waves from λ/4 to λ/16, of the same rms slope √2 πΔ/λ: p* is E* times that.

k = np.hypot(np.fft.fftfreq(CELLS, 1 / CELLS)[:, None], np.fft.rfftfreq(CELLS, 1 / CELLS))
filtered = np.where((k >= 4) & (k <= 16), np.maximum(k, 1.0) ** -1.8, 0.0)
spectrum = np.fft.rfft2(np.random.default_rng(1).standard_normal((CELLS, CELLS))) * filtered
heights, curved = np.fft.irfft2(spectrum), np.fft.irfft2(spectrum * (2 * np.pi * k / LENGTH) ** 2)
heights *= full / MODULUS / np.sqrt((heights * curved).mean())
rough = [half_space.solve(-heights, load=p * full * LENGTH**2) for p in loads]

# %%
# Share in contact against the mean pressure, and the pressure of the wavy surface at half of p*.

p = np.linspace(0.0, 1.0, 200)
figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 3.9), layout="constrained")
left.plot(loads, [c.real_area / LENGTH**2 for c in wavy], "o", label="wavy")
left.plot(loads, [c.real_area / LENGTH**2 for c in rough], "s", label="random, the same rms slope")
left.plot(p, np.pi * (3 * p / (8 * np.pi)) ** (2 / 3), "--", label="Hertz on each crest")
left.plot(p, 1 - 1.5 / np.pi * (1 - p), ":", label="circles not in contact")
left.set(xlabel="mean pressure / p*", ylabel="share in contact", ylim=(0, 1.02))
left.legend()
half = wavy[list(loads).index(0.5)].pressure / full
image = right.imshow(half.T, origin="lower", extent=(0, 1, 0, 1))
right.set(xlabel="x / λ", ylabel="y / λ", title="mean pressure p*/2")
figure.colorbar(image, label="pressure / p*")
plt.show()

assert wavy[-1].pressure.max() < 2.001 * full
assert abs(wavy[-1].approach) < 1e-4 * AMPLITUDE  # the mean planes, gap and all, have met
assert abs(wavy[1].real_area / LENGTH**2 / (np.pi * (0.03 / (8 * np.pi)) ** (2 / 3)) - 1) < 0.1
assert rough[0].real_area < wavy[0].real_area
assert rough[4].real_area > wavy[4].real_area
assert rough[-1].real_area < 0.99 * wavy[-1].real_area
