"""
A linear guide on four balls
============================

The carriage of a linear guide rests on four balls in a row, each in a groove that is 4 % wider than the
ball. All of them meet the same ground raceway, one after the other: waves that fit the distance of the balls
move the carriage, others cancel. How far apart should they be?
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity

speed, balls = 1.0, 4
guide = asperity.Bodies(
    over="plane",
    speed=speed,
    duration=1.0,
    laws=["hertz-filtered"],  # the line of the raceway, filtered by the elliptic contact
    surface={"spectrum": "iso3095", "level": "-48 dB"},  # ground: 0.1 µm rms in all
    body={"type": "carriage", "contacts": balls, "distance": "8 mm", "masses": ["0.6 kg"], "mass": "1 g",
          "radius": "3 mm", "groove_radius": "3.12 mm", "load": "25 N", "inertia": "0.2 g m^2"},
    contact={"spacing": "8 um", "window": "0.9 mm", "damping": "20 N s/m"},
    numerics={"highest_frequency": "2 kHz"},
)  # fmt: skip
distances = {"8 mm": 8e-3, "11 mm": 11e-3}
runs = {name: asperity.run(guide.with_(body={"distance": name})) for name in distances}

# %%
# Balls that are 8 mm apart pass any place at k v/L, 125 Hz and its multiples (dotted): there the raceway
# lifts all of them together. Between these tones they cancel.

figure, axes = plt.subplots(figsize=(8.0, 4.4), layout="constrained")
for name, run in runs.items():
    spectra = run["spectra"].to_dataset().isel(law=0)
    carriage = spectra["body_acceleration_psd"].sel(degree="carriage")
    axes.semilogy(carriage["frequency"], carriage, label=f"balls {name} apart")
for tone in np.arange(1, 6) * speed / distances["8 mm"]:
    axes.axvline(tone, color="0.6", linestyle=":", linewidth=0.8)
axes.set(
    xlim=(50, 700),
    ylim=(1e-10, 1e-5),
    xlabel="frequency / Hz",
    ylabel="acceleration of the carriage / (m/s²)²/Hz",
)
axes.legend()
plt.show()

# %%
# A row of n balls takes sin(nx)/(n sin x) of a wave, x = πfL/v: all of it at the tones, nothing half way
# between them.

spectra = runs["8 mm"]["spectra"].to_dataset().isel(law=0)
carriage = 10 * np.log10(spectra["body_acceleration_psd"].sel(degree="carriage"))
first, orders = speed / distances["8 mm"], np.arange(1, 4)
at_tones = carriage.sel(frequency=orders * first, method="nearest")
between = carriage.sel(frequency=(orders + 0.5) * first, method="nearest")
fall = float(at_tones.mean() - between.mean())
print(f"the carriage shakes {fall:.0f} dB less between the tones")
assert fall > 10.0
rolling = runs["8 mm"]["rolling"].to_dataset().isel(law=0)
assert abs(float(rolling["contact_force"].sum("contact").mean()) / (balls * 25.0) - 1.0) < 1e-3
