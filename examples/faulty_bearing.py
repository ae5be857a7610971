"""
A pit in a bearing
==================

A 6205 under 100 N has a pit of 0.5 mm on its outer raceway, in the middle of the load zone. The contact of
each ball loses a part of its width while it passes: what does that do to its force, and what does a sensor on
the housing say?
"""

import matplotlib.pyplot as plt
import numpy as np

from asperity import BallBearing
from asperity.diagnostics import envelope_spectrum
from asperity.laws import HertzLaw
from asperity.rolling import BearingRings, roll_bearing
from asperity.scenarios.raceway_grids import raceway_on
from asperity.scenarios.raceway_laws import raceway_laws
from asperity.structures.ring import Ring
from asperity.surfaces.faults import Fault

bearing, load, speed, step = BallBearing.named("6205"), 100.0, 1797 / 60, 3.2e-6
heaviest = bearing.loaded(load).outer_load.max()  # N, of one ball
contact, radius = bearing.outer_contact, bearing.raceway_radii[1]
surface = raceway_on(contact, heaviest, radius, faults=[Fault("pit", length=0.5e-3, depth=0.28e-3)])
outer = raceway_laws(["table"], contact, surface, heaviest, damping=50.0)["table"]  # scanned once
inner = HertzLaw(bearing.inner_contact.stiffness_constant, None, 50.0)
housing = Ring.rigid(0.3, radial_stiffness=0.3 * (2 * np.pi * 3000.0) ** 2, damping_ratio=0.03)  # 3 kHz
run = roll_bearing(
    bearing, BearingRings(Ring.rigid(0.5), housing), inner, outer, speed=speed, radial=load,
    duration=0.4, settling=0.03, time_step=step, sensors=[("outer", 0.0, "radial")],
)  # fmt: skip

# %%
# Each ball carries most in the middle of the load zone, where the pit is (angle 0).

figure, (above, below) = plt.subplots(2, figsize=(8.0, 6.4), layout="constrained")
angle = np.degrees((run.cage + np.pi) % (2 * np.pi) - np.pi)
shown = np.flatnonzero(np.abs(angle) < 80)
above.plot(angle[shown], run.outer_force[0, shown], ".", markersize=0.6)
above.set(xlabel="angle of the ball from the load / degrees", ylabel="force on the outer raceway / N")
frequency, amplitude = envelope_spectrum(run.acceleration[0], 1 / step, (2000.0, 4000.0))
turning = bearing.kinematics(speed, contact_angle=0.0)
below.plot(frequency, amplitude)
for order in range(1, 6):
    below.axvline(order * turning.ball_pass_outer, color="0.6", linestyle=":", linewidth=0.8)
below.set(xlim=(0, 600), xlabel="frequency / Hz", ylabel="envelope of the acceleration / (m/s²)")
plt.show()

# %%
# The envelope has its line where balls pass the outer raceway, and none where they pass the inner one.


def line(expected: float) -> tuple[float, float]:
    """Place and size of the highest line around, Hz and m/s²."""
    near = np.flatnonzero(np.abs(frequency - expected) < 10.0)
    at = near[amplitude[near].argmax()]
    return frequency[at], amplitude[at]


(at, outer_line), (_, inner_line) = line(turning.ball_pass_outer), line(turning.ball_pass_inner)
print(f"line at {at:.1f} Hz; expected {turning.ball_pass_outer:.1f} Hz")
assert abs(at - turning.ball_pass_outer) < 0.5
assert inner_line < 0.01 * outer_line
