"""Numbers of docs/surfaces/real_surfaces.md: measured surfaces from their files to contact and noise.

    python benchmarks/real_surfaces.py FOLDER [NAME ...]     # writes NAME.json, and real_surfaces.png

FOLDER holds the measured files, which are no part of the project; docs/surfaces/real_surfaces.md says whose
they are. Files that are not there are left out. `al3d` and `plu` need the extra `[readers]`.
"""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import asperity
from asperity import HeightMap, read_surface
from asperity.case.cases import as_case
from asperity.contact.scan import first_touch
from asperity.errors import PhysicsWarning
from asperity.reduction.stiffness import patches
from asperity.reduction.texture import punch_weights
from asperity.reporting.chart import Axis, Chart, Field, Panel
from asperity.reporting.figure import write_chart
from asperity.running import prepare_case
from asperity.surfaces.cleaning import spikes
from asperity.surfaces.statistics import rms_slope

BALL: dict[str, Any] = {
    "kind": "ball-on-beam",
    "laws": ["areal"],
    "start": "0.45 m",
    "duration": "8 ms",
    "settling": "4 ms",
    "contact": {"samples": 2},
    "numerics": {"highest_frequency": "4 kHz"},
}
FILES: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    # name: file, what its file does not say, case
    "polished": (
        "aa5754_um.npz",
        {"array": "polished", "index": 0, "height_unit": "um", "pixel": "1.5625 um"},
        {
            "surface": {"shortest": "24 um"},
            "ball": {"load": "20 N"},
            "contact": {"spacing": "6 um", "window": "0.54 mm"},
        },
    ),
    "rubber": (
        "rubber_x3p.x3p",
        {},
        {
            "surface": {"shortest": "24 um", "form": "quadratic"},
            "ball": {"load": "20 N"},
            "contact": {"spacing": "6 um", "window": "0.66 mm"},
        },
    ),
    "plu": (
        "plu-1.plu",
        {},
        {
            "surface": {"shortest": "24 um", "form": "quadratic"},
            "ball": {"load": "5 N"},
            "contact": {"spacing": "6 um", "window": "0.42 mm"},
        },
    ),
    "al3d": (
        "al3d-1.al3d",
        {},
        {
            "speed": "0.1 m/s",
            "surface": {"shortest": "3 um", "form": "quadratic"},
            "ball": {"radius": "1 mm", "load": "0.05 N"},
            "contact": {"spacing": "0.75 um", "window": "51 um"},
        },
    ),
}
SAMPLES = 6
NOISE = (0.03e-6, 0.1e-6)  # m, rms of what is added to each point, as an instrument does
WHEEL: dict[str, Any] = {
    "kind": "wheel-on-rail",
    "laws": ["areal", "linear"],
    "speed": "40 m/s",
    "duration": "0.15 s",
    "settling": "0.1 s",
    "surface": {"spectrum": "iso3095", "level": "-6 dB"},
    "contact": {"spacing": "1 mm", "window": "24 mm", "samples": 2, "sample_length": "0.2 m"},
    "numerics": {"highest_frequency": "4 kHz"},
}


def case_of(surface: HeightMap, own: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A case over a map, which is complete, with what is its own."""
    merged = dict(BALL) | {"seed": 1}
    for key, value in {**own, **more}.items():
        merged[key] = {**merged.get(key, {}), **value} if isinstance(value, dict) else value
    merged["surface"] = {**merged["surface"], "file": surface}
    return merged


def pressed(surface: HeightMap, own: dict[str, Any]) -> dict[str, float]:
    """Contact of a ball with the samples that a case takes from a map, under its load."""
    prepared = prepare_case(as_case(case_of(surface, own)))
    shape, maps = prepared.shape, prepared.textures.maps
    weights = punch_weights(shape.spacing, shape.semi_axes)
    samples = patches([each.heights for each in maps], shape.body.shape, SAMPLES, weights)
    half_space = shape.half_space(None)
    smooth = half_space.solve(shape.body, load=shape.load)
    contacts = [half_space.solve(shape.body - sample, load=shape.load, rtol=1e-5) for sample in samples]
    datum = -min(float(first_touch(sample, shape.body).min()) for sample in samples)
    state = float(np.mean([contact.approach for contact in contacts])) + datum
    return {
        "Sdq": float(np.sqrt(np.mean([rms_slope(each) ** 2 for each in maps]))),
        "real contact area over smooth": float(np.mean([c.area for c in contacts])) / smooth.area,
        "k_c / (MN/m)": shape.load / state / 1e6,
        "dF/dr / (MN/m)": float(np.mean([c.stiffness for c in contacts])) / 1e6,
        "dF/dr of smooth bodies / (MN/m)": smooth.stiffness / 1e6,
        "largest pressure / GPa": float(np.mean([c.pressure.max() for c in contacts])) / 1e9,
    }


def walk(file: Path, hints: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    """One map from its file to the contact of a ball, step by step, and what instrument noise does to it."""
    raw = read_surface(file, **hints)
    clean = raw.without_spikes().filled()
    told: dict[str, Any] = {
        "points": list(raw.shape),
        "spacing / um": [1e6 * d for d in raw.spacing],
        "missing": raw.missing_share,
        "spikes": int(spikes(raw).sum()),
        "peak to valley / um": float(np.nanmax(raw.heights) - np.nanmin(raw.heights)) * 1e6,
    }
    forms = {"mean": 0, "plane": 1, "quadratic": 2}
    flat = {name: clean.levelled(degree) for name, degree in forms.items()}
    told["Sq / um"] = {name: float(each.heights.std()) * 1e6 for name, each in flat.items()}
    told["Sdq, from so many points on"] = {"2": rms_slope(flat["quadratic"])} | {
        str(n): rms_slope(flat["quadratic"].band_limited(shortest=n * max(clean.spacing))) for n in (4, 8, 16)
    }
    all_waves = {**own, "surface": {k: v for k, v in own["surface"].items() if k != "shortest"}}
    told["clean"] = pressed(clean, own)
    told["spikes kept"] = pressed(raw.filled(), own)
    told["all waves"] = pressed(clean, all_waves)
    for rms in NOISE:
        noise = rms * np.random.default_rng(1).standard_normal(clean.shape)
        noisy = HeightMap(clean.heights + noise, clean.spacing, clean.source)
        told[f"noise of {1e9 * rms:g} nm"] = pressed(noisy, own)
        told[f"noise of {1e9 * rms:g} nm, all waves"] = pressed(noisy, all_waves)
    told["rolled"] = {"clean": rolled(clean, own)}
    for rms in NOISE:
        noise = rms * np.random.default_rng(1).standard_normal(clean.shape)
        noisy = HeightMap(clean.heights + noise, clean.spacing, clean.source)
        told["rolled"][f"noise of {1e9 * rms:g} nm"] = rolled(noisy, own)
    return told


def rolled(surface: HeightMap, own: dict[str, Any]) -> dict[str, float]:
    """Force and noise of a ball rolling over a map: level of the beam's acceleration, of all bands."""
    tree = asperity.run(case_of(surface, own))
    level = tree["spectra/acceleration_level"].values[0]
    return {
        "force rms / N": float(tree["rolling/contact_force"].values[0, 0].std()),
        "out of contact": float(tree["rolling/contact_loss_share"].values[0, 0]),
        "acceleration / dB": float(10 * np.log10(np.nanmean(np.nansum(10 ** (level / 10), axis=-1)))),
    }


def walk_wheel(file: Path) -> dict[str, Any]:
    """Lines around a wheel, from their file to the change of rolling noise, step by step."""
    lines = np.load(file)["flat0p2mm"]
    told: dict[str, Any] = {
        "lines": list(lines.shape),
        "missing": float(np.isnan(lines).mean()),
        "rms / um": float(np.nanstd(lines)),
        "largest step / um": float(np.nanmax(np.abs(np.diff(lines, axis=1)))),
    }
    keys = {"line": file, "line_array": "flat0p2mm", "line_unit": "um", "line_spacing": "1 mm"}
    keys |= {"line_distance": "5 mm", "section": "rigid"}
    for name, processing in (("filled", ["fill"]), ("spikes, curvature", ["fill", "spikes", "curvature"])):
        tree = asperity.run(WHEEL | {"wheel": keys | {"processing": processing}})
        told[name] = of_wheel(tree)
    rng = np.random.default_rng(1)
    for rms in (0.3, 1.0):
        noisy = Path(file.name).with_suffix(f".{rms:g}.npz")
        np.savez(noisy, flat0p2mm=lines + rms * rng.standard_normal(lines.shape))
        tree = asperity.run(
            WHEEL
            | {"wheel": keys | {"line": noisy.absolute(), "processing": ["fill", "spikes", "curvature"]}}
        )
        told[f"noise of {rms:g} um"] = of_wheel(tree)
        noisy.unlink()
    return told


def of_wheel(tree: Any) -> dict[str, float]:
    """Force and sound power of the first law."""
    spectra = tree["spectra"]
    power = spectra["sound_power_level_a"].sel(source="total")
    return {
        "force rms / kN": float(tree["rolling/contact_force"].values[0, 0].std()) / 1e3,
        "out of contact": float(tree["rolling/contact_loss_share"].values[0, 0]),
        "sound power / dB(A)": float(power.values[0]),
        "linear / dB(A)": float(power.values[1]),
    }


def main(folder: Path, names: list[str]) -> None:
    warnings.simplefilter("ignore", PhysicsWarning)  # the page says what they say
    for name in names or [*FILES, "wheel"]:
        file = folder / (FILES[name][0] if name in FILES else "wheel_lines_um_1mm.npz")
        if not file.exists():
            print(f"{file}: not there, left out", file=sys.stderr)
            continue
        told = walk(file, *FILES[name][1:]) if name in FILES else walk_wheel(file)
        Path(f"{name}.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
        print(name, json.dumps(told, indent=1))
    draw(folder)


def draw(folder: Path) -> None:
    """The maps as they are rolled over: levelled, spikes gone, filled."""
    shown = [(name, *FILES[name][:2]) for name in FILES if (folder / FILES[name][0]).exists()]
    if not shown:
        return
    panels = []
    for name, file, hints in shown:
        surface = read_surface(folder / file, **hints).without_spikes().filled().levelled(2)
        heights = 1e6 * surface.heights
        reach = float(np.percentile(np.abs(heights), 99.5))
        length, width = (1e6 * side for side in surface.size)
        heights_from_above = Field((0.0, length), (0.0, width), heights, "height / µm", -reach, reach)
        x, y = Axis("x / µm", 0.0, length), Axis("y / µm", 0.0, width)
        panels.append(
            Panel(x, y, (heights_from_above,), title=name, height=2.9, equal=True, beside=len(panels) % 3 > 0)
        )
    write_chart(Chart(tuple(panels)), "", Path("real_surfaces.png"))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2:])
