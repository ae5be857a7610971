"""Make `data/peers.json`: forces of tamaas and ContactMechanics on a rough contact.

    benchmarks/peers.sh FOLDER && FOLDER/bin/python tests/conformance/make_peers.py

Runs in an environment that holds the two programs, without this project.
"""

from __future__ import annotations

import json
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from peers_worker import contact_mechanics, tamaas

CELLS, STRIDE, SPACING, RADIUS, MODULUS, APPROACH = 48, 5, 8e-6, 25e-3, 115e9, 0.9e-6


def main() -> None:
    rng = np.random.default_rng(23)
    wavelength = np.exp(rng.uniform(np.log(40e-6), np.log(300e-6), 24))
    angle, phase = rng.uniform(0, np.pi, 24), rng.uniform(0, 2 * np.pi, 24)
    size = 0.2e-6 * wavelength / np.sqrt((wavelength**2).sum() / 2)
    waves = np.stack(
        [size, 2 * np.pi / wavelength * np.cos(angle), 2 * np.pi / wavelength * np.sin(angle), phase], 1
    )
    x = (np.arange(CELLS) - CELLS // 2) * SPACING
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    rows = np.arange(CELLS + 2 * STRIDE)[:, None] * SPACING
    columns = np.arange(CELLS)[None, :] * SPACING
    heights = sum(a * np.cos(kx * rows + ky * columns + p) for a, kx, ky, p in waves)
    problem = {
        "body": body, "heights": heights, "offsets": np.array([0, STRIDE, 2 * STRIDE]),
        "approaches": np.full(3, APPROACH), "spacing": SPACING, "modulus": MODULUS, "rtol": 1e-9,
        "smooth_force": 4 / 3 * MODULUS * np.sqrt(RADIUS) * APPROACH**1.5,
    }  # fmt: skip
    forces = {}
    for name, make in (("tamaas", tamaas), ("ContactMechanics", contact_mechanics)):
        solve, _ = make(problem, "cold")
        pressures = [solve(body - heights[m : m + CELLS], i)[0] for i, m in enumerate(problem["offsets"])]
        forces[name] = [float(p.sum() * SPACING**2) for p in pressures]
    stored = {
        "problem": {
            "cells": CELLS, "stride": STRIDE, "spacing": SPACING, "radius": RADIUS, "modulus": MODULUS,
            "approach": APPROACH, "waves": waves.tolist(),
        },
        "versions": {name: version(name) for name in forces},
        "forces": forces,
    }  # fmt: skip
    (Path(__file__).parent / "data" / "peers.json").write_text(json.dumps(stored, indent=1))


if __name__ == "__main__":
    main()
