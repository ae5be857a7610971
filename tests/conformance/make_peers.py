"""Make `data/peers.json`, `plastic_peer.json`, `periodic_peer.json` with tamaas and ContactMechanics.

    benchmarks/peers.sh FOLDER && FOLDER/bin/python tests/conformance/make_peers.py

Runs in an environment that holds the two programs, without this project.
"""

import json
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

DATA = Path(__file__).parent / "data"
APPROACH = 0.9e-6
GRID = {"cells": 48, "stride": 5, "spacing": 8e-6, "radius": 25e-3, "modulus": 115e9, "approach": APPROACH}
HARDNESS = 0.6e9


def ball_on_cells(n, spacing, radius):
    x = (np.arange(n) - n // 2) * spacing
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)


def heights_of(problem):
    """Heights under all positions of the ball."""
    n, spacing = problem["cells"], problem["spacing"]
    rows = np.arange(n + 2 * problem["stride"])[:, None] * spacing
    columns = np.arange(n)[None, :] * spacing
    return sum(a * np.cos(kx * rows + ky * columns + phase) for a, kx, ky, phase in problem["waves"])


def gaps_of(problem):
    """Gaps of the three contacts."""
    n, heights = problem["cells"], heights_of(problem)
    body = ball_on_cells(n, problem["spacing"], problem["radius"])
    return [body - heights[m * problem["stride"] :][:n] for m in range(3)]


def waves():
    """Amplitude, wavenumbers along and across, and phase of each wave of the surface."""
    rng = np.random.default_rng(23)
    wavelength = np.exp(rng.uniform(np.log(40e-6), np.log(300e-6), 24))
    angle, phase = rng.uniform(0, np.pi, 24), rng.uniform(0, 2 * np.pi, 24)
    size = 0.2e-6 * wavelength / np.sqrt((wavelength**2).sum() / 2)
    number = 2 * np.pi / wavelength
    return np.stack([size, number * np.cos(angle), number * np.sin(angle), phase], 1).tolist()


def elastic(problem):
    """Forces by program."""
    from peers_worker import contact_mechanics, tamaas

    spacing, forces = problem["spacing"], {}
    body = ball_on_cells(problem["cells"], spacing, problem["radius"])
    asked = {
        "body": body, "heights": heights_of(problem), "offsets": problem["stride"] * np.arange(3),
        "approaches": np.full(3, APPROACH), "spacing": spacing, "modulus": problem["modulus"], "rtol": 1e-9,
        "smooth_force": 4 / 3 * problem["modulus"] * np.sqrt(problem["radius"]) * APPROACH**1.5,
    }  # fmt: skip
    for name, make in (("tamaas", tamaas), ("ContactMechanics", contact_mechanics)):
        solve, _ = make(asked, "cold")
        pressures = [solve(gap, i)[0] for i, gap in enumerate(gaps_of(problem))]
        forces[name] = [float(p.sum() * spacing**2) for p in pressures]
    return {"problem": problem, "versions": {name: version(name) for name in forces}, "forces": forces}


def plastic(problem):
    """Force and marks of the same contacts with hardness, by ContactMechanics."""
    from ContactMechanics import FreeFFTElasticHalfSpace
    from ContactMechanics.PlasticSystemSpecialisations import PlasticNonSmoothContactSystem
    from SurfaceTopography import PlasticTopography, Topography

    n, area = problem["cells"], problem["spacing"] ** 2
    size = (n * problem["spacing"], n * problem["spacing"])
    half_space = FreeFFTElasticHalfSpace((n, n), problem["modulus"], size)
    contacts = []
    for gap in gaps_of(problem):
        surface = PlasticTopography(Topography(-gap, size), HARDNESS)
        system = PlasticNonSmoothContactSystem(half_space, surface)
        within = {"pentol": 1e-10 * (APPROACH - gap.min()), "forcetol": 1e-9, "maxiter": 5000}
        found = system.minimize_proxy(offset=APPROACH, **within)
        assert found.success
        lowered, force = -np.asarray(surface.plastic_displ), np.maximum(found.jac, 0.0).sum()
        sums = {"force": force, "volume": lowered.sum() * area, "deepest": lowered.max()}
        contacts.append({name: float(value) for name, value in sums.items()})
    return {"version": version("ContactMechanics"), "hardness": HARDNESS, "contacts": contacts}


PERIOD = {"cells": [44, 32], "spacing": [2e-6, 3e-6], "modulus": 115e9}
MEAN_PRESSURES = [10e6, 100e6, 400e6, 1500e6]


def periodic_gap(problem):
    """Gap of a rough period of oblong cells, of waves that fit into it.

    Even numbers of cells: of an odd one, tamaas 2.9.0 takes the shortest waves along for shorter ones.
    """
    (n, m), rng = problem["cells"], np.random.default_rng(29)
    rows, columns, gap = np.arange(n)[:, None] / n, np.arange(m) / m, np.zeros((n, m))
    for along in range(-6, 7):
        for across in range(7):
            if along or across:
                phase = 2 * np.pi * (along * rows + across * columns + rng.uniform())
                gap += 0.1e-6 / np.hypot(along, across) ** 1.8 * np.cos(phase)
    return gap


def periodic():
    """Periodic contacts under mean pressures, by tamaas."""
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)
    n, gap, contacts = PERIOD["cells"], periodic_gap(PERIOD), []
    size = [count * width for count, width in zip(n, PERIOD["spacing"], strict=True)]
    for mean in MEAN_PRESSURES:
        model = tm.ModelFactory.createModel(tm.model_type.basic_2d, size, n)
        model.E, model.nu = PERIOD["modulus"], 0.0
        solver = tm.PolonskyKeerRey(model, -gap, 1e-13)
        solver.max_iter = 10000
        solver.solve(mean)
        pressure, moved = np.array(model.traction), np.array(model.displacement)
        approach = (moved - moved.mean() + gap)[pressure > 0].mean()
        found = {"approach": approach, "largest": pressure.max(), "cells": np.count_nonzero(pressure)}
        contacts.append({"mean": mean} | {name: float(value) for name, value in found.items()})
    return {"version": version("tamaas"), "contacts": contacts}


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
    problem = GRID | {"waves": waves()}
    for name, make in (("peers", elastic), ("plastic_peer", plastic)):
        (DATA / f"{name}.json").write_text(json.dumps(make(problem), indent=1))
    (DATA / "periodic_peer.json").write_text(json.dumps(periodic(), indent=1))
