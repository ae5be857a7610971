"""The cases of the law accuracy map: from numbers without dimension to a case that all laws roll."""

from __future__ import annotations

import math
import time
import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from practice_filters import practice
from scipy.integrate import quad_vec
from scipy.optimize import brentq
from scipy.special import j0

from asperity.case.cases import parse_case
from asperity.case.scene import Case
from asperity.errors import PhysicsWarning
from asperity.laws.layout import force
from asperity.progress import Progress
from asperity.reference.law_accuracy import HIGH, LOW
from asperity.running import prepare_case
from asperity.scenarios.geometry import geometry_of
from asperity.scenarios.law_choice import place_of
from asperity.scenes.compute import Computed, compute
from asperity.spectra import band_levels, psd
from asperity.surfaces.spectra import CORRELATION_THRESHOLD

BALL, WHEEL = "ball-on-beam", "wheel-on-rail"
SECTION = {BALL: "ball", WHEEL: "wheel"}
DIAMETER = {BALL: None, WHEEL: 0.92}  # of a wheel, m
LAWS = ("areal", "shifted", "printed", "hertz-filtered", "hertz", "linear-filtered", "linear")
SCANNED = "table"
"""Rolled over the first path of a point alone: its scan takes as long as `direct` over two."""
RECORD, SETTLING, SEGMENT = 0.125, 0.03, 0.1  # s: record and run-in of a path, segments of its spectra
CELLS, CELLS_PER_WAVE = 6, 4
"""Least cells in a semi-axis of the smooth contact; least cells of the shortest wave."""
FINEST = 2.0 / 3.0
"""Shortest wave over the semi-axis; `EXCITED` and short correlation lengths ask for shorter ones."""
EXCITED = 1.13 * HIGH
"""Frequency up to which waves excite the bodies, Hz: the edge of the highest band."""
LEAST_LENGTH = 0.5
"""Least correlation length, in shortest waves."""
LONGEST_STEP = 28e-6  # s
START = 0.3  # m, on the beam


@dataclass(frozen=True)
class Point:
    """What a point is made of; lengths are relative to the smooth contact under the load."""

    kind: str
    roughness: float  # rms over Hertz's approach
    correlation: float  # correlation length in the rolling direction over the length of the contact
    anisotropy: float  # correlation length along over that across
    load: float  # N
    speed: float  # m/s
    hurst: float = 0.8
    finest: float = FINEST  # shortest wave over the semi-axis, at most
    seeds: int = 2
    scanned: bool = True  # whether `table` is rolled

    @property
    def name(self) -> str:
        """Unique among points, fit for a file."""
        values = asdict(self).values()
        return "_".join(f"{value:.6g}" if isinstance(value, float) else str(value) for value in values)


def smooth_contact(kind: str, load: float) -> tuple[float, float]:
    """Approach and semi-axis in the rolling direction of smooth bodies under a load, N; m."""
    case = parse_case(f'kind = "{kind}"\n[surface]\nrms = "1 um"')
    hertz = geometry_of(case).hertz
    return hertz.approach(load), hertz.semi_axes(hertz.approach(load))[0]


def autocorrelation_at(lag: float, longest: float, shortest: float, hurst: float) -> float:
    """Autocorrelation of an isotropic self-affine surface at a lag; lengths in m."""
    low, high = 2.0 * math.pi / longest, 2.0 * math.pi / shortest

    def moments(q: float) -> NDArray[np.float64]:
        power = max(q, low) ** (-2.0 - 2.0 * hurst) * q
        return np.array([power, power * j0(q * lag)])

    whole, fallen = sum(quad_vec(moments, *ends)[0] for ends in ((0.0, low), (low, high)))
    return float(fallen / whole)


def longest_wave(length: float, shortest: float, hurst: float) -> float:
    """Roll-off wavelength that gives an isotropic correlation length, at least half the shortest wave; m."""

    def over(longest: float) -> float:
        return autocorrelation_at(length, longest, shortest, hurst) - CORRELATION_THRESHOLD

    return float(brentq(over, 1.0001 * shortest, 60.0 * length + 2.0 * shortest, rtol=1e-3))


def case_of(
    point: Point, seed: int, laws: Sequence[str], *, finer: float = 1.0, longest_step: float = LONGEST_STEP
) -> Case:
    """One path of a point; cells `finer` times as small, and no time step longer than that, s."""
    approach, semi_axis = smooth_contact(point.kind, point.load)
    section = SECTION[point.kind]
    relative = min(point.finest, CELLS_PER_WAVE * point.correlation)
    shortest = min(relative * semi_axis, point.speed / EXCITED)
    spacing = min(semi_axis / CELLS, shortest / CELLS_PER_WAVE) / finer
    passed = spacing / point.speed  # s
    length = 2.0 * semi_axis * point.correlation / math.sqrt(point.anisotropy)
    longest = longest_wave(max(length, LEAST_LENGTH * shortest), shortest, point.hurst)
    # rms of waves no longer than the window, by which the contact spreads
    within = point.roughness * min(1.0, point.correlation**-point.hurst)
    window = 2.0 * max(2.5, 1.1 * math.sqrt(2.0 + 5.0 * within)) * semi_axis
    start = f'start = "{START} m"' if point.kind == BALL else ""
    rigid = 'section = "rigid"' if point.kind == WHEEL else ""
    return parse_case(
        f"""
        kind = "{point.kind}"
        speed = "{point.speed} m/s"
        laws = [{", ".join(f'"{law}"' for law in laws)}]
        seed = {seed}
        duration = "{RECORD} s"
        settling = "{SETTLING} s"
        {start}
        [surface]
        rms = "{point.roughness * approach} m"
        hurst = {point.hurst}
        longest = "{longest} m"
        shortest = "{shortest} m"
        anisotropy = {point.anisotropy}
        [{section}]
        load = "{point.load} N"
        {rigid}
        [contact]
        spacing = "{spacing} m"
        window = "{window} m"
        samples = 3
        sample_length = "{6 * window} m"
        rim_cells = "covered"
        [numerics]
        time_step = "{passed / math.ceil(passed / longest_step)} s"
        """
    )


def computed_of(case: Case, progress: Progress) -> Computed:
    """Roll all laws of a case."""
    return compute(prepare_case(case), progress)  # type: ignore[no-any-return]


def solved(
    point: Point, seed: int, folder: Path, progress: Progress, **grid: float
) -> dict[str, NDArray[Any]]:
    """Roll `direct` over a path, unless the folder holds it for the very same case; `grid`: of `case_of`."""
    case, file = case_of(point, seed, ["direct"], **grid), folder / f"{point.name}_{seed}.npz"
    if file.exists():
        with np.load(file, allow_pickle=False) as kept:
            if str(kept["case"]) == case.text:
                return dict(kept)
    computed = computed_of(case, progress)
    run = computed.runs["direct"]
    found = {
        "case": np.array(case.text),
        "force": run.contact_force[0],
        "position": run.positions[0],
        "displacement": run.relative_displacement[0],
        "loss": np.array(1.0 - run.in_contact.mean()),
        "seconds": np.array(computed.seconds["law direct"]),
        "unconverged": np.array(run.unconverged_steps),
    }
    folder.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(file, **found)
    return found


def band_energies(
    contact_force: NDArray[np.float64], time_step: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centres of the one-third octaves of the map, Hz, and in each the mean square of a force, N²."""
    segment = round(SEGMENT / time_step)
    centres, levels = band_levels(*psd(contact_force, time_step, segment=segment), low=LOW, high=HIGH)
    return centres, 10.0 ** (levels / 10.0)


def rolled(case: Case, direct: Mapping[str, NDArray[Any]], progress: Progress) -> dict[str, Any]:
    """Roll one path with all laws of a case, and keep what the map needs of it."""
    computed, step, kept = computed_of(case, progress), case.time_step, {}
    reference, built = direct["force"], {name: computed.build(name) for name in computed.runs}
    centres, energy = band_energies(reference, step)
    kept["direct"] = {"mean": float(reference.mean())} | {
        name: float(direct[name]) for name in ("loss", "seconds", "unconverged")
    }
    kept["direct"]["energy"] = energy.tolist()
    for name, run in computed.runs.items():
        course = force(built[name], direct["position"], direct["displacement"])
        kept[name] = {
            "energy": band_energies(run.contact_force[0], step)[1].tolist(),
            "mean": float(run.contact_force.mean()),
            "loss": 1.0 - float(run.in_contact.mean()),
            "course": float(np.sqrt(np.mean((course - reference) ** 2)) / reference.std()),
            "seconds": computed.seconds[f"law {name}"],
            "unconverged": run.unconverged_steps,
        }
    return {
        "laws": kept,
        "steps": reference.size,
        "centres": centres.tolist(),
        "dynamic": float(reference.std()),
        "area_ratio": computed.reduction.pressed.area_ratio,
    }


def own_error(point: Point, first_seed: int, folder: Path, progress: Progress) -> dict[str, float]:
    """Change of `direct`, rms of its bands in dB, with half the time step and with cells half as large.

    Both are rolled with half the time step, or less, of the point; cells are compared at equal steps as far
    as a finer grid leaves them.
    """
    step = case_of(point, first_seed, ["direct"]).time_step
    ways: dict[str, dict[str, float]] = {
        "direct": {},
        "direct_half_step": {"longest_step": 0.51 * step},
        "direct_fine": {"longest_step": 0.51 * step, "finer": 2.0},
    }
    levels = {}
    for name, grid in ways.items():
        time_step = case_of(point, first_seed, ["direct"], **grid).time_step
        paths = [
            solved(point, first_seed + number, folder / name, progress, **grid)
            for number in range(point.seeds)
        ]
        energies = [band_energies(path["force"], time_step)[1] for path in paths]
        levels[name] = 10.0 * np.log10(np.mean(energies, axis=0))

    def change(finer: str, coarser: str) -> float:
        return float(np.sqrt(np.mean((levels[finer] - levels[coarser]) ** 2)))

    return {
        "step": change("direct_half_step", "direct"),
        "grid": change("direct_fine", "direct_half_step"),
    }


def place_on_map(point: Point, seed: int) -> dict[str, float]:
    """Place of one path of a point on the map."""
    prepared = prepare_case(case_of(point, seed, LAWS))
    transfer = prepared.scene.square_transfer
    place = place_of(prepared.textures.path, prepared.shape, prepared.case.speed, transfer)
    assert place is not None
    return asdict(place)


def compute_point(point: Point, first_seed: int, folder: Path, progress: Progress) -> dict[str, Any]:
    """Roll all paths of a point with every law, `table` over the first alone; a folder keeps `direct`."""
    paths, caught, began = [], Counter[str](), time.process_time()
    for number in range(point.seeds):
        names = (*LAWS, SCANNED) if number == 0 and point.scanned else LAWS
        seed = first_seed + number
        bare = case_of(point, seed, LAWS)
        with warnings.catch_warnings(record=True) as messages:
            warnings.simplefilter("always", PhysicsWarning)
            direct = solved(point, seed, folder, progress)
            with practice(geometry_of(bare), DIAMETER[point.kind]) as filters:
                paths.append(rolled(case_of(point, seed, (*names, *filters)), direct, progress))
        caught.update(message.category.__name__ for message in messages)
    return {
        "point": asdict(point), "seed": first_seed, "paths": paths, "warnings": caught,
        "processor": time.process_time() - began,
    }  # fmt: skip
