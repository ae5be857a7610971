"""A pass-by beside the limit for its type of vehicle: met or not, by how much, and what decides."""

from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reference.tsi_noise import PassByLimit
from asperity.reporting import data
from asperity.reporting.tables import Cell, ReportTable, table, text_cells
from asperity.scenes import schema
from asperity.schema import Entry

_ABBREVIATED = ("emu", "dmu")
_PLACES = {"": schema.NORMALISED_LEVEL, ", 3.5 m high": schema.NORMALISED_LEVEL_ABOVE}


def _vehicle(tree: DataTree) -> str:
    told = str(data.stated(tree, schema.VEHICLE) or "")
    return told.upper() if told in _ABBREVIATED else told.replace("-", " ")


def _levels(tree: DataTree, entry: Entry = schema.NORMALISED_LEVEL) -> dict[str, float]:
    """Normalised levels of the main law by what radiates, as far as they are known; the whole last.

    Where something moves sideways, that is of the whole, and the wheel under both forces.
    """
    found = data.stored_variable(tree, entry)
    if found is None or not (laws := data.laws(tree, entry)):
        return {}
    of_law = data.of_law(tree, entry, laws[0])
    levels = zip(map(str, found["radiator"].values), of_law.tolist(), strict=True)
    known = {name: level for name, level in levels if np.isfinite(level)}
    if schema.WITH_SIDEWAYS in known:
        known = {n: each for n, each in known.items() if n not in ("total", "wheel")}
        known = {"wheel" if n == schema.WHEEL_BOTH else n: each for n, each in known.items()}
    return known


def _result(tree: DataTree, level: float) -> tuple[str, bool | None]:
    """Whether the limit is met, and by how much; None where nothing can be said."""
    limit = data.number(tree, schema.TSI_LIMIT)
    if limit is None:
        return "no limit holds for this receiver and speed", None
    met, margin = PassByLimit(limit, 0.0, 0.0).met(level), limit - level
    if met and margin < 0.0:
        return f"met as a whole decibel, {-margin:.1f} dB over the {limit:g} dB(A) allowed", met
    return f"{abs(margin):.1f} dB {'below' if met else 'over'} the {limit:g} dB(A) allowed", met


def limit_sentence(tree: DataTree) -> str:
    """Say whether the rolling noise of the vehicle is within its limit; nothing without a type of vehicle."""
    *parts, whole = _levels(tree).items() or [("", np.nan)]
    speed = data.number(tree, schema.REFERENCE_SPEED)
    if not parts or speed is None:
        return ""
    alone = "alone" if "wheel" in dict(parts) else "without the wheel"
    most = max(parts, key=lambda part: part[1])[0]
    failed = [str(each.get("condition")) for each in _conditions(tree) if not each.get("met")]
    told = f" Not as a test asks: {', '.join(failed)}." if failed else ""
    if above := list(_levels(tree, schema.NORMALISED_LEVEL_ABOVE).values()):
        told = f" At 3.5 m height it has {above[-1]:.1f} dB(A), {_result(tree, above[-1])[0]}.{told}"
    result, verb = _result(tree, whole[1])[0], "decide" if most.endswith("s") else "decides"
    return (
        f"TSI Noise, {_vehicle(tree)}: rolling noise {alone} has {whole[1]:.1f} dB(A) at "
        f"{3.6 * speed:.0f} km/h, {result}; the {most} {verb}.{told}"
    )


def _conditions(tree: DataTree) -> list[dict[str, Any]]:
    return data.json_list(tree, schema.REFERENCE_CONDITIONS)


def _verdict(met: object) -> Cell:
    return Cell("–") if met is None else Cell("yes") if met else Cell("no", "off")


def limits_table(tree: DataTree) -> ReportTable | None:
    """Level and limit of the vehicle, by source, and the conditions of ISO 3095."""
    conditions, speed = _conditions(tree), data.number(tree, schema.REFERENCE_SPEED)
    rows: list[dict[str, Any]] = []
    for place, entry in _PLACES.items():
        if speed is not None and (levels := _levels(tree, entry)):
            *parts, (_, whole) = levels.items()
            told, met = _result(tree, whole)
            here = f"{whole:.1f} dB(A): {', '.join(f'{name} {level:.1f}' for name, level in parts)}"
            what = f"L_pAeq,Tp at {3.6 * speed:.0f} km/h{place}"
            rows.append({"condition": what, "here": here, "asked": told, "met": met})
    if not rows:
        return None
    rows += conditions
    columns = {
        "what": text_cells(row.get("condition") for row in rows),
        "here": text_cells(row.get("here") for row in rows),
        "asked": text_cells(row.get("asked") for row in rows),
        "met": [_verdict(row.get("met")) for row in rows],
    }
    note = (
        f"{_vehicle(tree)}, main law: rolling noise alone, to which traction and air add. Normalised by "
        "30 lg v, from 250 km/h on by 50 lg v, of wagons to 0.225 axles per metre, and compared as a whole "
        "decibel (Regulation (EU) No 1304/2014, points 4.2.3 and 6.2.2.3). Where roughness or decay rate are "
        "not as asked, a measured level would be marked non-comparable."
    )
    return table("limits", "Limit of TSI Noise, and conditions of a test", columns, note)
