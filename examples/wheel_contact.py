"""
Wheel on rail, pressed: stiffness and filters
=============================================

A railway wheel (radius 460 mm) stands on a rail head (radius 300 mm). The texture is self-affine, 1 µm rms,
waves of 2 to 30 mm. The contact stiffness k_c(r) = F/r rises more smoothly than Hertz's, and filtering
grows with the state: the patch of a larger state averages over longer waves.

On texture that is the same all across and small, the filter is sin q/q, q = 2π k a: it is drawn as a line
through the dots of the computed one, and is negative beyond q = π.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity
from asperity.surfaces.synthesis import self_affine

rough = asperity.WheelOnRail(
    laws=["shifted", "printed"],
    duration="20 ms",
    settling=0,
    surface={"rms": "1 um", "longest": "30 mm", "shortest": "2 mm"},
    contact={
        "spacing": "0.25 mm",
        "window": "20.25 mm",
        "samples": 3,
        "sample_length": "0.48 m",
        "approaches": ["1 um", "5 um", "15 um", "30 um", "70 um", "110 um"],
    },
)
contact = asperity.run(rough)["contact"].to_dataset()

# %%
# The stiffness where it rises, on more samples and finer states. They count from the first touch of samples
# and path.

steps = [f"{approach:g} um" for approach in (*np.arange(-1.0, 6.1, 0.5), 40, 110)]
finer = {"approaches": steps, "samples": 8, "sample_length": "42 mm", "datum": "path"}
rising = rough.with_(laws=["shifted-unfiltered"], contact=finer, numerics={"force_accuracy": 1e-3})
rise = asperity.run(rising)["contact"].isel(approach=slice(15)).to_dataset()

# %%
# The same wheel on a measured map, here one made in memory: a line of 0.3 µm rms, the same all across.

cell = 0.25e-3  # m
line = self_affine((1920, 81), (cell, cell), rms=0.3e-6, hurst=0.8, longest=30e-3, shortest=2e-3, seed=0)
uniform = asperity.HeightMap(np.repeat(line.heights[:, :1], 90, axis=1), (cell, cell))
same = asperity.run(rough.with_(surface={"rms": None, "longest": None, "shortest": None, "file": uniform}))
across = same["contact"].to_dataset()

# %%
# Left: stiffness. Middle: filters as estimated on the rough texture, referred to the tangent stiffness.
# Right: the signed filter of the uniform texture.

state = contact.approach.values + contact.attrs["datum"]
wavenumber, radius = across.wavenumber.values, across.contact_radius.values
figure, (first, second, third) = plt.subplots(1, 3, figsize=(11, 3.9), layout="constrained")
r = (rise.approach + rise.attrs["datum"]) * 1e6
first.plot(r, rise.stiffness / 1e9, "o-", ms=3, label="rough, 8 samples")
first.plot(r, rise.hertz_stiffness / 1e9, "s--", ms=3, label="Hertz at r − d₀")
first.set(xlabel="state r / µm", ylabel="contact stiffness F/r / (GN/m)", xlim=(0, None), ylim=(0, None))
for row in range(2, len(state)):  # below, hardly anything touches
    filtered = 20 * np.log10(contact["filter"][row])
    (drawn,) = second.semilogx(contact.wavenumber, filtered, label=f"r = {state[row] * 1e6:.0f} µm")
    lobe = wavenumber * radius[row] < 1.0
    third.semilogx(wavenumber[lobe], across.filter_signed[row, lobe], ".", color=drawn.get_color())
    third.semilogx(wavenumber[lobe], across.filter_theory[row, lobe], color=drawn.get_color(), lw=1.0)
second.set(xlabel="wavenumber / (cycles/m)", ylabel="contact filter |H| / dB", ylim=(-30, 5))
third.set(xlabel="wavenumber / (cycles/m)", ylabel="H of uniform texture; line: sin q/q")
first.legend()
second.legend(loc="lower left")
plt.show()

# %%
# The rough stiffness rises more smoothly than Hertz's, which starts with a vertical tangent: its steepest
# rise over an rms height is less than half. Filtering grows with the state, and the closed form holds
# within 0.02 rms over its main lobe from 15 µm on.

level = 20 * np.log10(contact["filter"][2:]).mean("wavenumber").values
lobes = [2 * wavenumber * a < 1.0 for a in radius]
apart = (across.filter_signed - across.filter_theory).values
apart = [float(np.sqrt(np.mean(row[lobe] ** 2))) for row, lobe in zip(apart[2:], lobes[2:], strict=True)]
print("mean level: " + ", ".join(f"{mean:.1f}" for mean in level) + " dB")
print("distance from sin q/q: " + ", ".join(f"{rms:.3f}" for rms in apart))
steepest = [float(np.max(k.values[2:] - k.values[:-2])) for k in (rise.stiffness, rise.hertz_stiffness)]
print(f"steepest rise over 1 µm: {steepest[0]:.3g} N/m, Hertz's {steepest[1]:.3g} N/m")
assert steepest[0] < 0.5 * steepest[1]
assert steepest[0] < 0.5 * 9.413e10 * np.sqrt(1e-6)  # K of a wheel of 0.46 m on a rail head of 0.30 m
assert np.all(np.diff(level) < 0.0)
assert max(apart) < 0.02
