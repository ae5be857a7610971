"""
A corrugated rail: state-dependent against linear contact
=========================================================

A rigid wheel under 65 kN rolls at 200 km/h on a rail with one wave, 60 mm long, on the track "x2000". What a
wave of length λ excites has the frequency v/λ (Eq. 1.2), here 926 Hz. Its amplitude grows from 1 to 60 µm.

A linear contact answers in proportion, for ever, and pulls where the force would change its sign. The
state-dependent one agrees with it on small waves, has a second harmonic in proportion to the amplitude, and
lets go. `printed` multiplies the wave by F/r, which between smooth bodies is two thirds of dF/dr: it has two
thirds of the force at any amplitude.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity

WAVE = 60e-3  # m
AMPLITUDES = np.array([1.0, 5.0, 10.0, 20.0, 40.0, 60.0])  # µm
case = asperity.WheelOnRail(
    speed="200 km/h",
    laws=["shifted", "printed", "linear-filtered", "linear"],
    duration="0.108 s",  # a hundred waves
    settling="0.2 s",
    surface={"corrugation": "1 um", "corrugation_wavelength": "60 mm"},
    wheel={"section": "rigid"},
    track={"points": ["3 m"]},
    numerics={"poles": 60},
)
runs = [asperity.run(case.with_(surface={"corrugation": f"{a} um"})) for a in AMPLITUDES]

# %%
# Amplitudes of the harmonics of v/λ, of the contact force and of the rail under the wheel.


def harmonic(name, law, order):
    """Amplitude of a harmonic of a quantity under the wheel, for each amplitude of the wave."""
    found = []
    for run in runs:
        signal = run[f"rolling/{name}"].sel(law=law).isel(contact=0)
        turns = np.exp(-2j * np.pi * order * case.speed / WAVE * signal.time.values)
        window = np.hanning(signal.size)
        found.append(2 * abs(np.sum(window * turns * (signal.values - signal.values.mean()))) / window.sum())
    return np.array(found)


force = {law: harmonic("contact_force", law, 1) for law in case.laws}
second = {law: harmonic("contact_force", law, 2) for law in case.laws}
rail = {law: harmonic("rail_displacement", law, 1) for law in case.laws}
figure, panels = plt.subplots(1, 3, figsize=(11, 3.9), layout="constrained")
for law in ("shifted", "printed", "linear-filtered"):
    last = runs[-1]["rolling/contact_force"].sel(law=law).isel(contact=0, time=slice(150))
    panels[0].plot((last.time - last.time[0]) * 1e3, last / 1e3, label=law)
    (line,) = panels[1].plot(AMPLITUDES, force[law] / 1e3, "o-", ms=3, label=law)
    panels[1].plot(AMPLITUDES, second[law] / 1e3, "s:", ms=3, color=line.get_color())
    panels[2].plot(AMPLITUDES, rail[law] * 1e6, "o-", ms=3)
panels[0].set(title="wave of 60 µm", xlabel="time / ms", ylabel="contact force / kN")
panels[1].set(title="at v/λ; dotted: at 2v/λ", xlabel="amplitude of the wave / µm", ylabel="force / kN")
panels[2].set(title="at v/λ", xlabel="amplitude of the wave / µm", ylabel="rail displacement / µm")
panels[1].legend()
plt.show()

# %%
# Small waves: the contact filter of smooth bodies is sin q/q, with a patch 2 × 6.2 mm long (Hertz), and the
# linear force lies between what the receptances at mid-span and over a sleeper say.

at = runs[0]["track"].to_dataset().interp(frequency=case.speed / WAVE)
ends = []
for place in ("support", "midspan"):
    rail_receptance = at[f"receptance_{place}"] * np.exp(1j * at[f"receptance_{place}_phase"])
    ends.append(1e-6 / abs(rail_receptance + at.contact_receptance - at.wheel_receptance))
assert min(ends) < force["linear"][0] < max(ends)
assert np.allclose(force["linear-filtered"] / force["linear"], np.sinc(2 * 6.203e-3 / WAVE), atol=0.002)
assert abs(force["shifted"][0] / force["linear-filtered"][0] - 1) < 0.001
assert abs(rail["shifted"][0] / rail["linear-filtered"][0] - 1) < 0.001

# %%
# What is not linear: `printed` at any amplitude, the second harmonic, and lost contact.

for quantity in (force, rail):
    assert abs(quantity["printed"] / quantity["shifted"] - 2 / 3)[:4].max() < 0.002
distortion = second["shifted"] / force["shifted"]
print("second harmonic: " + ", ".join(f"{share:.1%}" for share in distortion))
assert np.allclose(distortion[:4] / AMPLITUDES[:4], distortion[0] / AMPLITUDES[0], rtol=0.02)
assert max(second["linear"] / force["linear"]) < 1e-4
lost = runs[-1]["rolling/contact_loss_share"].isel(contact=0)
pushed = runs[-1]["rolling/contact_force"].isel(contact=0).min("time")
print(f"wave of 60 µm: without contact for {float(lost.sel(law='shifted')):.1%} of the time")
assert float(lost.sel(law="shifted")) > 0.01
assert float(pushed.sel(law="shifted")) >= 0.0 > float(pushed.sel(law="linear-filtered"))
