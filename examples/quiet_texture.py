"""
The texture that rolls quietest
===============================

A ball rolls over a beam whose surface has to keep its rms height, as friction or oil may ask for. The
roughness is moved to the wavelengths λ that are heard least, at v/λ, within 10 dB either side of where it
was. The search rolls with `areal`; whether the texture is better is asked of `table`, which scans the
whole rough contact.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity

RMS = 0.1e-6  # m

case = asperity.BallOnBeam(
    start="0.2 m",
    duration="0.3 s",
    surface={"rms": RMS, "longest": "2 mm", "shortest": "0.1 mm"},
    ball={"load": "30 N"},
    contact={"spacing": "40 um", "window": "0.76 mm", "samples": 2},
    numerics={"highest_frequency": "2 kHz"},
)
found = asperity.optimise(case, rms_at_least=RMS, longest="10 mm", reach="10 dB")
changed = found.after.changed
print(found.sentence)

# %%
# Before and after, by both laws:

figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(7, 6))
frequency = case.speed / found.after.changed_wavelength
for name, bands, style in (("before", found.before, ":"), ("after", found.after, "-")):
    above.semilogx(frequency, bands.levels[changed], f"k{style}o", label=name)
    result = found.result_before if name == "before" else found.result_after
    for law, colour in (("table", "C2"), ("areal", "C0")):
        below.semilogx(frequency, found.band_levels(result, law), style, color=colour, label=f"{law}, {name}")
above.set(ylabel="roughness level / dB re 1 µm", title="Texture, by the frequency at which it is passed")
below.set(xlabel="frequency / Hz", ylabel=found.measure.units, title=found.measure.meaning)
above.legend(), below.legend()
figure.tight_layout()

# %%
# The rms height is kept, to a thousandth, and both laws say that the beam shakes less:

rms = 1e-6 * np.sqrt(np.sum(10.0 ** (found.after.levels[changed] / 10.0)))
assert abs(rms / RMS - 1.0) < 1e-3
assert found.changes["table"] < -6.0
