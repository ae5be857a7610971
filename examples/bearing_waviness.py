"""
Which waviness is heard
=======================

A ball bearing is judged by the velocity of its outer ring in three bands (ISO 15242), while the inner ring
turns at 1800 1/min under an axial load. A raceway of n waves per turn moves the ring radially only where n is
one beside a multiple of the number of balls; waves of all other numbers cancel. What is heard of 0.1 µm?
"""

import matplotlib.pyplot as plt
import numpy as np

from asperity import BallBearing
from asperity.diagnostics import ISO_BANDS, band_velocities
from asperity.laws import HertzLaw
from asperity.rolling import BearingRings, roll_bearing
from asperity.scenarios.raceway_grids import raceway_on
from asperity.scenarios.raceway_laws import raceway_laws
from asperity.structures.ring import Ring
from asperity.surfaces.raceway import AroundTexture

bearing, load, speed, step = BallBearing.named("6205"), 150.0, 30.0, 3e-6
still = bearing.loaded(axial=load)
contact, heaviest, radius = bearing.outer_contact, still.outer_load.max(), bearing.raceway_radii[1]
spindle = Ring.rigid(2.0, still.contact_angle, radial_stiffness=1e9, axial_stiffness=1e9, damping_ratio=0.1)
rings = BearingRings(spindle, Ring.rigid(0.08, still.contact_angle))  # the outer ring is free
inner = HertzLaw(bearing.inner_contact.stiffness_constant, None, 50.0)


def velocities(waves: int) -> np.ndarray:
    """Of the outer ring in the bands, µm/s rms, with so many waves of 0.1 µm on its raceway."""
    wavy = raceway_on(contact, heaviest, radius, AroundTexture(waves=(waves,), amplitudes=(0.1e-6,)))
    outer = raceway_laws(["areal"], contact, wavy, heaviest, damping=50.0)["areal"]
    run = roll_bearing(
        bearing, rings, inner, outer, speed=speed, axial=load, duration=0.1, settling=0.03, time_step=step
    )
    return 1e6 * band_velocities(np.gradient(run.outer_motion[0], step), 1 / step)


orders = [7, 8, 9, 10, 11, 17, 18, 19, 26, 27, 28]
found = np.array([velocities(waves) for waves in orders])

# %%
# One beside 9, 18 and 27 is heard. The tone, i times the frequency at which balls pass, decides the band.

figure, axes = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
for place, (low, high) in enumerate(ISO_BANDS):
    axes.bar(
        np.arange(len(orders)) + 0.27 * (place - 1), found[:, place], 0.25, label=f"{low:g} to {high:g} Hz"
    )
axes.set_xticks(range(len(orders)), orders)
axes.set(xlabel="waves per turn of the outer raceway, 0.1 µm each", ylabel="radial velocity / (µm/s) rms")
axes.legend()
plt.show()

# %%
# The contacts are inclined by α: a wave of amplitude a moves the ring by a/cos α, as a whole.

turning = bearing.kinematics(speed, contact_angle=still.contact_angle)
eight, ten, wide = found[orders.index(8)], found[orders.index(10)], found[orders.index(28)]
expected = 2 * np.pi * turning.ball_pass_outer * 0.1 / np.cos(still.contact_angle) / np.sqrt(2)
print(f"8 and 10 waves: {eight[0]:.1f} and {ten[0]:.1f} µm/s; {expected:.1f} µm/s if the ring follows")
assert abs(ten[0] / expected - 1.0) < 0.02
assert ten.argmax() == 0  # 50 to 300 Hz
assert wide.argmax() == 1  # at three times the frequency
assert found[orders.index(9)].max() < 0.01 * ten[0]
