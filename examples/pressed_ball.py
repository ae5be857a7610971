"""
A ball on a rough surface
=========================

Press a steel ball on rough steel: the pressure, the force and the real area of contact. The ball touches
the asperities only, inside and around the circle that Hertz's theory finds for smooth bodies. They carry
the load on an area smaller than that circle.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity
from asperity.surfaces.synthesis import self_affine

radius, load, modulus = 25e-3, 30.0, 115e9  # a steel ball on steel: m, N, contact modulus E* in Pa
surface = self_affine(  # or asperity.read_surface("beam.x3p")
    (301, 301), (1.5e-6, 1.5e-6), rms=0.15e-6, hurst=0.8, longest=0.2e-3, shortest=10e-6, seed=4
)
x = surface.x - surface.x.mean()
ball = (x[:, None] ** 2 + x**2) / (2 * radius)
half_space = asperity.HalfSpace(surface.shape, surface.spacing, modulus)
contact = half_space.solve(ball - surface.heights, load=load)

# %%
# Cyan: Hertz's circle.

hertz_radius = (3 * load * radius / (4 * modulus)) ** (1 / 3)
figure, axes = plt.subplots(figsize=(6.4, 5.0), layout="constrained")
axes.contourf(x * 1e6, x * 1e6, surface.heights.T, 8, cmap="Greys_r", alpha=0.5)
pressure = np.ma.masked_equal(contact.pressure.T, 0.0) / 1e9
image = axes.pcolormesh(x * 1e6, x * 1e6, pressure, cmap="inferno")
axes.contour(x * 1e6, x * 1e6, np.hypot(x, x[:, None]), [hertz_radius], colors="c", linewidths=2)
axes.set(xlabel="x / µm", ylabel="y / µm", aspect="equal")
figure.colorbar(image, label="contact pressure / GPa")
plt.show()

# %%
# The load is met, on part of the circle.

share = contact.real_area / (np.pi * hertz_radius**2)
print(f"{contact.force:.2f} N on {contact.real_area * 1e12:.0f} µm², {share:.0%} of the Hertz circle")
assert abs(contact.force / load - 1.0) < 1e-5
assert 0.2 < share < 1.0
