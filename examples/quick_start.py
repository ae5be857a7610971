"""Press a steel ball on a rough steel surface: the pressure, the force and the real area of contact.

The ball touches the asperities only, inside and around the circle that Hertz's theory finds for smooth
bodies. What is asserted: they carry the load, on an area smaller than that circle.

Run: python quick_start.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from asperity import HalfSpace
from asperity.surfaces.synthesis import self_affine


def main(folder: Path = Path()) -> dict[str, float]:
    radius, load, modulus = 25e-3, 30.0, 115e9  # a steel ball on steel: m, N, contact modulus E* in Pa
    surface = self_affine(  # or asperity.read_surface("beam.x3p")
        (301, 301), (1.5e-6, 1.5e-6), rms=0.15e-6, hurst=0.8, longest=0.2e-3, shortest=10e-6, seed=4
    )
    x = surface.x - surface.x.mean()
    ball = (x[:, None] ** 2 + x**2) / (2 * radius)
    contact = HalfSpace(surface.shape, surface.spacing, modulus).solve(ball - surface.heights, load=load)
    hertz_radius = (3 * load * radius / (4 * modulus)) ** (1 / 3)
    share = contact.area / (np.pi * hertz_radius**2)
    print(f"{contact.force:.1f} N on {contact.area * 1e12:.0f} µm², {share:.0%} of the Hertz circle")

    figure = Figure(figsize=(6.4, 5.0), layout="constrained")
    axes, micrometres = figure.subplots(), 1e6 * x
    axes.contourf(micrometres, micrometres, surface.heights.T, 8, cmap="Greys_r", alpha=0.5)
    pressure = np.ma.masked_equal(contact.pressure.T, 0.0) / 1e9
    image = axes.pcolormesh(micrometres, micrometres, pressure, cmap="inferno")
    axes.contour(micrometres, micrometres, np.hypot(x, x[:, None]), [hertz_radius], colors="c", linewidths=2)
    figure.colorbar(image, label="contact pressure / GPa")
    axes.set(
        xlabel="x / µm", ylabel="y / µm", aspect="equal", title="Ball on rough steel; cyan: Hertz's circle"
    )
    figure.savefig(folder / "quick_start.png", dpi=110)

    assert abs(contact.force / load - 1.0) < 1e-5
    assert contact.area < np.pi * hertz_radius**2
    return {"force": contact.force, "area": contact.area, "share_of_hertz_circle": share}


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path())
