"""Labelled signals in the common schema of the package bearing-datasets, which opens them as its own.

A folder holds ``metadata.parquet``, one row for each signal, ``manifest.json``, and ``signals/``, here with a
file for each recording.
"""

import io
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asperity import __version__, files
from asperity.arguments import Array
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.speeds import SpeedCourse, covered, speed_at
from asperity.studies.kept_signals import refuse_without
from asperity.written_numbers import rounded

SCHEMA_VERSION = 2
"""Of the tables of bearing-datasets since 0.2."""
SIGNALS, TABLE, MANIFEST = "signals", "metadata.parquet", "manifest.json"
FAULTY = {"outer": "outer", "inner": "inner", "ball": "rolling_element"}
PLACE = "test_bearing"
SHAFT = "rig_shaft"
OWN = {
    "load_axial_n": "axial load, N",
    "fault_shape": "shape of the largest fault; 'none' if healthy",
    "fault_width_mm": "its width across the path, mm; 0 if healthy",
    "fault_depth_mm": "its depth, or the height of a particle, mm; 0 if healthy",
    "fault_angle_deg": "angle of its middle around, from the radial load, deg; 0 if healthy",
    "bearing_elements": "number of balls or rollers",
    "bearing_element_diameter_mm": "diameter of one of them, mm",
    "bearing_pitch_diameter_mm": "diameter of the circle of their centres, mm",
    "bearing_contact_angle_deg": "contact angle under the load, deg",
    "noise": "white noise that was added",
    "path": "path from the outer ring to the sensor that was added",
    "seed": "seed of what was drawn by chance: roughness, waviness, slip",
    "law": "law of the contact force",
    "case": "the whole case that was computed, in TOML",
}
"""Columns beside the standard ones, with what they hold."""
_KEPT = b"asperity"
"""Where the rows of a recording stand in its file."""


def check_installed() -> None:
    """Refuse where what writes Parquet is missing."""
    refuse_without("pyarrow", "parquet", "format of the signals", "parquet")


def recording_path(digest: str) -> str:
    """Path of the signals of a recording in the folder of its set."""
    return f"{SIGNALS}/part-{digest}.parquet"


def write_recording(file: Path, case: BearingUnderLoad, signal: Array) -> None:
    """Write the signals (sensors, n) of a case to a file, and a tacho where its speed changes."""
    import pyarrow as pa
    from pyarrow import parquet

    rows, channels = recording_of(file, case, signal)
    ids = pa.array([row["signal_id"] for row in rows])
    table = pa.table({"signal_id": ids, "signal": pa.array(channels)})
    table = table.replace_schema_metadata({_KEPT: json.dumps(rows).encode()})
    _write(file, table, parquet)


def recording_of(
    file: Path, case: BearingUnderLoad, signal: Array
) -> tuple[list[dict[str, Any]], list[Array]]:
    """Rows of the table for the signals of a case, and the signals: those (sensors, n), and a tacho."""
    recording = file.stem.removeprefix("part-")
    channels = {
        f"sensor_{rounded(math.degrees(angle), 6)}_deg": signal[n] for n, angle in enumerate(case.sensors)
    }
    of_channel = dict.fromkeys(channels, ("acceleration", "m/s^2", PLACE, "outer_ring", "radial"))
    if isinstance(case.speed, SpeedCourse):
        channels["tacho"] = speed_at(case.speed, np.arange(signal.shape[1]) / case.sampling_rate)
        of_channel["tacho"] = ("speed", "Hz", SHAFT, "none", "none")
    about = _about(case)
    rows = []
    for number, (name, values) in enumerate(channels.items()):
        quantity, unit, place, mounting, axis = of_channel[name]
        rows.append(
            about
            | {
                "signal_id": f"{recording}/{name}", "recording_id": recording, "channel": name,
                "sensor_location": place, "sensor_mounting": mounting, "axis": axis, "quantity": quantity,
                "unit": unit, "fs": float(case.sampling_rate), "n_samples": len(values),
                "sensor_at_fault": place in about["fault_location"].split("+"), "signal_file": file.name,
                "signal_row_group": 0, "signal_row": number,
            }
        )  # fmt: skip
    return rows, [np.asarray(each, dtype=float) for each in channels.values()]


def _write(file: Path, table: Any, parquet: Any) -> None:
    image = io.BytesIO()
    parquet.write_table(table, image, compression="zstd")
    files.write_bytes(file, image.getvalue())


def write_metadata(folder: Path, labels: Sequence[Mapping[str, Any]]) -> None:
    """Write the table of all signals, and what the package wants to know of the set, to its folder."""
    import pyarrow as pa
    from pyarrow import parquet

    rows = []
    for label in labels:
        kept = parquet.read_schema(folder / label["file"]).metadata[_KEPT]
        rows += [{"dataset": folder.name} | row | _of_label(label, row) for row in json.loads(kept)]
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    _write(folder / TABLE, pa.table(columns), parquet)
    manifest = {
        "dataset": folder.name,
        "title": "Signals of rolling bearings, computed by asperity",
        "citation": f"Computed by asperity {__version__}.",
        "package_version": f"asperity {__version__}",
        "schema_version": SCHEMA_VERSION,
        "n_recordings": len(labels),
        "n_signals": len(rows),
        "columns": OWN,
    }
    files.write_bytes(folder / MANIFEST, json.dumps(manifest, indent=1).encode())


def _of_label(label: Mapping[str, Any], row: Mapping[str, Any]) -> dict[str, Any]:
    """What the study says of a recording, beside its case."""
    noise = "none"
    if (rms := label.get("noise_rms [m/s2]")) is not None:
        noise = f"{rms} m/s^2 rms"
    if (below := label.get("noise_below [dB]")) is not None:
        noise = f"{below} dB below"
    named = str(label.get("variant", row["fault_type"]))
    return {"native_label": named, "noise": noise, "path": str(label.get("path", "none"))}


def _about(case: BearingUnderLoad) -> dict[str, Any]:
    """What the schema, and `OWN`, tell of a case."""
    faults = [(each.part, each.fault) for each in case.faults.values()]
    there = [(FAULTY[on], fault) for on, fault in faults if on and fault]
    parts = list(dict.fromkeys(part for part, _ in there))
    fault = max((fault for _, fault in there), key=lambda each: each.length or 0.0, default=None)
    bearing = case.bearing.bearing
    turning = case.kinematics
    speed = float(case.speed)
    mean = covered(case.speed, case.duration) / case.duration
    diameter = 1e3 * bearing.ball_diameter
    pitch = 1e3 * bearing.pitch_diameter
    designation = case.bearing.name or (
        f"{turning.balls} {case.fault.ELEMENT}s of {rounded(diameter, 5)} mm on {rounded(pitch, 5)} mm"
    )
    sizes = {name: 1e3 * float(getattr(fault, name, None) or 0.0) for name in ("length", "width", "depth")}
    return {
        "fault_type": "+".join(parts) or "normal",
        "fault_location": "+".join(PLACE for _ in parts) or "none",
        "speed_rpm": 60.0 * mean,
        "speed_profile": _profile(case.speed),
        "load": float(case.radial),
        "load_unit": "N",
        "fault_origin": "artificial" if parts else "none",
        "fault_size_mm": sizes["length"],
        "bearing_id": f"{designation}, seed {case.seed}",
        "bearing_model": designation,
        "bpfo": turning.tone("outer") / speed,
        "bpfi": turning.tone("inner") / speed,
        "bsf": turning.spin / speed,
        "ftf": turning.cage / speed,
        "load_axial_n": float(case.axial),
        "fault_shape": fault.shape if fault else "none",
        "fault_width_mm": sizes["width"],
        "fault_depth_mm": sizes["depth"],
        "fault_angle_deg": math.degrees(fault.angle) if fault else 0.0,
        "bearing_elements": turning.balls,
        "bearing_element_diameter_mm": diameter,
        "bearing_pitch_diameter_mm": pitch,
        "bearing_contact_angle_deg": math.degrees(case.static.contact_angle),
        "seed": case.seed,
        "law": case.laws[0],
        "case": case.text,
    }


def _profile(speed: float) -> str:
    """How a speed changes, in the words of the schema."""
    if not isinstance(speed, SpeedCourse):
        return "constant"
    steps = np.diff(speed.speeds)
    return "increasing" if (steps >= 0.0).all() else "decreasing" if (steps <= 0.0).all() else "varying"
