"""
The contact filter of a ball
============================

A ball at constant state r = approach + d₀ is moved along rough strips, and its force is compared,
wavenumber by wavenumber, with that of a point force on the line textures under the patch (Eqs. 2.4 to 2.6).
A patch of semi-axis a = √(R approach) averages over its width, so the filter falls earlier the larger r is.

As printed, the filter is one at the longest waves. Referred to the tangent stiffness k_t it starts below
one on a texture that also varies across the path: what the patch averages across never reaches the force.
Where sin q/q, q = 2π k a, the closed form for texture that is uniform across, goes through zero, it has a
dip.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity

case = asperity.BallOnBeam(
    laws=["shifted", "printed"],
    start="0.5 m",
    duration="10 ms",
    settling=0,
    surface={"rms": "0.3 um", "longest": "1 mm", "shortest": "64 um"},
    ball={"radius": "25 mm", "load": "30 N"},
    contact={
        "spacing": "16 um",
        "window": "1.3 mm",
        "samples": 3,
        "sample_length": "11.5 mm",
        "approaches": ["1.7 um", "2.7 um", "4.7 um", "8.7 um"],
    },
)
contact = asperity.run(case)["contact"].to_dataset()
state = contact.approach.values + contact.attrs["datum"]
wavenumber = contact.wavenumber.values  # cycles/m

# %%
# Dotted: sin q/q, main lobe.

figure, panels = plt.subplots(1, 2, figsize=(9.6, 4.2), sharey=True, layout="constrained")
shown = {
    "as printed: one at the longest waves": "printed_filter",
    "referred to the tangent stiffness": "filter",
}
for axes, (title, name) in zip(panels, shown.items(), strict=True):
    for row, r in enumerate(state):
        (line,) = axes.semilogx(wavenumber, 20 * np.log10(contact[name][row]), label=f"r = {r * 1e6:.1f} µm")
        lobe = 2 * wavenumber * contact.contact_radius.values[row] < 0.99
        theory = 20 * np.log10(np.abs(contact.filter_theory.values[row, lobe]))
        axes.semilogx(wavenumber[lobe], theory, ":", color=line.get_color())
    axes.set(title=title, xlabel="wavenumber / (cycles/m)", ylim=(-40, 5), xlim=(100, 1e4))
panels[0].set_ylabel("contact filter |H| / dB")
panels[0].legend(loc="lower left")
plt.show()

# %%
# A larger state hears less of a fine texture: the wavenumbers at which the printed filter has fallen by 3
# and by 10 dB, and the mean level of the other one, are lower for each larger state. By 10 dB, in the middle
# of the main lobe, it falls where sin q/q does, at q = 2.32.


def falls_to(level: float) -> list[float]:
    """Wavenumber at which each printed filter first falls to a level in dB, cycles/m."""
    found = []
    for row in 20 * np.log10(contact.printed_filter.values):
        first = int(np.argmax(row < level))
        around = slice(first - 1, first + 1)
        found.append(float(np.interp(-level, -row[around], wavenumber[around])))
    return found


for level in (-3.0, -10.0):
    print(f"{level:g} dB at " + ", ".join(f"{k:.0f}" for k in falls_to(level)) + " cycles/m")
    assert np.all(np.diff(falls_to(level)) < 0.0)
assert np.allclose(falls_to(-10.0), 2.32 / (2 * np.pi * contact.contact_radius), rtol=0.1)
assert np.all(np.diff(20 * np.log10(contact["filter"]).mean("wavenumber")) < 0.0)
