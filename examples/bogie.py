"""
A bogie on a track
==================

Two wheels on one rail feel each other: what one of them sends out reaches the other 2.5 m ahead or behind,
and between them waves stand. A single wheel knows nothing of that. How much does it change the force?
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity

bogie = asperity.Bodies(
    over="track",
    speed="120 km/h",
    duration="0.6 s",
    settling="0.2 s",
    laws=["hertz-filtered"],
    surface={"spectrum": "iso3095"},
    body={
        "type": "bogie", "distance": "2.5 m", "radius": "0.46 m", "transverse_radius": "inf",
        "mass": "600 kg", "masses": ["1500 kg"], "springs": ["0.6 MN/m"], "dampers": ["10 kN s/m"],
        "load": "60 kN",
    },
    track={"name": "nordborg", "pad_stiffness": "120 MN/m"},
    contact={"spacing": "0.5 mm", "window": "20 mm"},
    numerics={"highest_frequency": "2.5 kHz"},
)  # fmt: skip
wheel = {"type": "chain", "masses": ["750 kg"], "distance": None}  # half of it
runs = {"bogie": asperity.run(bogie), "single wheel": asperity.run(bogie.with_(body=wheel))}

# %%
# The receptance of the rail between the wheels says where: where it is large, one wheel shakes the other.

figure, (above, below) = plt.subplots(2, figsize=(8.0, 6.0), sharex=True, layout="constrained")
for name, run in runs.items():
    level = run["spectra"].to_dataset()["contact_force_level"].isel(law=0)
    for contact, style in zip(level, ("-", "--"), strict=False):
        above.semilogx(level["band"], contact, style, label=f"{name}, wheel {int(contact['contact'])}")
track, frequency = bogie.track.model(), np.geomspace(40, 2800, 400)
for distance, label in ((0.0, "under the force"), (2.5, "2.5 m away")):
    magnitude = np.abs(track.receptance(frequency, 0.3 + distance, 0.3))
    below.loglog(frequency, magnitude, label=label)
above.set(ylabel="contact force / dB re 1 N")
below.set(xlabel="frequency / Hz", ylabel="receptance of the rail / (m/N)")
above.legend()
below.legend()
plt.show()

# %%
# Band by band the second wheel changes the force; over all bands, hardly.

rear, alone = (
    run["spectra"].to_dataset()["contact_force_level"].isel(law=0, contact=0) for run in runs.values()
)
change = rear - alone
print(f"{float(change.min()):+.1f} to {float(change.max()):+.1f} dB in a band")
assert 0.3 < float(np.abs(change).max()) < 8.0
total = [10 * np.log10(float((10 ** (level / 10)).sum())) for level in (rear, alone)]
assert abs(total[0] - total[1]) < 1.5
