"""Make `data/plastic_peer.json`: the contacts of `data/peers.json` with hardness, by ContactMechanics.

    benchmarks/peers.sh FOLDER && FOLDER/bin/python tests/conformance/make_plastic_peer.py

Runs in an environment that holds the program, without this project.
"""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path

import numpy as np
from ContactMechanics import FreeFFTElasticHalfSpace
from ContactMechanics.PlasticSystemSpecialisations import PlasticNonSmoothContactSystem
from SurfaceTopography import PlasticTopography, Topography

DATA = Path(__file__).parent / "data"
HARDNESS = 0.6e9


def main() -> None:
    problem = json.loads((DATA / "peers.json").read_text())["problem"]
    n, spacing, stride = problem["cells"], problem["spacing"], problem["stride"]
    x = (np.arange(n) - n // 2) * spacing
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * problem["radius"])
    rows = np.arange(n + 2 * stride)[:, None] * spacing
    heights = sum(
        a * np.cos(kx * rows + ky * np.arange(n)[None, :] * spacing + phase)
        for a, kx, ky, phase in problem["waves"]
    )
    size = (n * spacing, n * spacing)
    half_space = FreeFFTElasticHalfSpace((n, n), problem["modulus"], size)
    contacts = []
    for m in range(3):
        gap = body - heights[m * stride : m * stride + n]
        surface = PlasticTopography(Topography(-gap, size), HARDNESS)
        overlap = problem["approach"] - gap.min()
        system = PlasticNonSmoothContactSystem(half_space, surface)
        found = system.minimize_proxy(
            offset=problem["approach"], pentol=1e-10 * overlap, forcetol=1e-9, maxiter=5000
        )
        assert found.success
        lowered = -np.asarray(surface.plastic_displ)
        pressure = np.maximum(found.jac, 0.0) / spacing**2
        contacts.append(
            {
                "force": float(pressure.sum() * spacing**2),
                "volume": float(lowered.sum() * spacing**2),
                "deepest": float(lowered.max()),
            }
        )
    stored = {"version": version("ContactMechanics"), "hardness": HARDNESS, "contacts": contacts}
    (DATA / "plastic_peer.json").write_text(json.dumps(stored, indent=1))


if __name__ == "__main__":
    main()
