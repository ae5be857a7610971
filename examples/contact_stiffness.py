"""
Stiffness of a rough contact
============================

A steel ball is pressed on twelve samples of a rough steel surface. All share one datum d₀: the state is r =
approach + d₀, zero where the highest sample is first touched, and the contact stiffness is k_c(r) = F(r)/r
(Eq. 2.3 of the thesis). Smooth bodies first touch at r = d₀, so Hertz's stiffness starts there.

What holds, and is asserted below: past its first touch Hertz's stiffness overtakes the rough one within an
rms height of the texture and stays above it; the rough one rises more smoothly; and whatever the datum, the
rough contact is the softer one under equal load.

What does *not* hold is that roughness lowers the force at equal approach of the mean planes: peaks touch
early.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity

RMS = 0.5e-6  # m
case = asperity.BallOnBeam(
    laws=["shifted-unfiltered"],
    start="0.5 m",
    duration="10 ms",
    settling=0,
    surface={"rms": RMS, "longest": "0.4 mm", "shortest": "32 um"},
    ball={"radius": "25 mm", "load": "5 N"},
    contact={
        "spacing": "10 um",
        "window": "0.79 mm",
        "samples": 12,
        "sample_length": "1.6 mm",
        "approaches": list(np.arange(-1.0e-6, 2.6e-6, 0.25e-6)),  # from the mean plane under the patch
    },
    numerics={"force_accuracy": 1e-3},
)
contact = asperity.run(case)["contact"].to_dataset()
state = contact.approach.values + contact.attrs["datum"]
rough = contact.stiffness.values

# %%
# Left: Hertz's contact is drawn at r − d₀; the spread is that between the samples. Right: under equal load
# the tangent stiffness dF/dr does not depend on the datum.

ball = asperity.Hertz(contact.attrs["contact_modulus"], 25e-3, 25e-3)
hertz = ball.stiffness_constant * np.sqrt(np.maximum(contact.approach.values, 0.0))
load = contact.force.values
shown = load > 0.5  # N
smooth = np.array([ball.tangent_stiffness(ball.approach(force)) for force in load[shown]])

figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 3.9), layout="constrained")
spread = contact.stiffness_std.values
left.fill_between(state * 1e6, (rough - spread) / 1e6, (rough + spread) / 1e6, alpha=0.25, lw=0)
left.plot(state * 1e6, rough / 1e6, label="rough, 12 samples ± std")
left.plot(state * 1e6, hertz / 1e6, "--", label="Hertz at r − d₀")
left.axvline(contact.attrs["datum"] * 1e6, color="0.5", lw=0.8)
left.set(xlabel="state r / µm", ylabel="contact stiffness F/r / (MN/m)", xlim=(0, None), ylim=(0, None))
right.loglog(load[shown], contact.tangent_stiffness.values[shown] / 1e6, label="rough, mean")
right.loglog(load[shown], smooth / 1e6, "--", label="Hertz")
right.set(xlabel="load / N", ylabel="tangent stiffness dF/dr / (MN/m)")
left.legend()
right.legend()
plt.show()

# %%
# The statements, held to the numbers.

step = round(RMS / (state[1] - state[0]))
rise = {name: np.max(k[step:] - k[:-step]) for name, k in (("rough", rough), ("hertz", hertz))}
last_below = np.flatnonzero(hertz <= rough)[-1]
softening = contact.tangent_stiffness.values[shown] / smooth
print(f"steepest rise over an rms height: {rise['rough']:.3g} N/m, Hertz's {rise['hertz']:.3g} N/m")
print(f"tangent stiffness over Hertz's at 5 N: {np.interp(5.0, load[shown], softening):.2f}")
assert state[last_below + 1] - contact.attrs["datum"] <= RMS
assert rise["rough"] < 0.5 * rise["hertz"]
assert softening.max() < 1.0
assert np.interp(5.0, load[shown], softening) < 0.9
