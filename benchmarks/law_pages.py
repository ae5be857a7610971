"""What the law accuracy map is published as: data in the package, a figure and tables in the docs."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from law_points import BALL, RECORD, SETTLING, WHEEL, Point

from asperity.reference.law_accuracy import LEAST, LawMap, MappedPoint, law_map_of, mapped_points
from asperity.scenarios.law_choice import estimate

ROOT = Path(__file__).parents[1]
DATA = ROOT / "src/asperity/reference/law_accuracy.json"
FRESH = ROOT / "benchmarks/law_accuracy_fresh.json"
"""Cases that are no points of the map: do its bands hold?"""
PAGE, FIGURE = ROOT / "docs/evidence/law_accuracy.md", ROOT / "docs/evidence/law_accuracy.png"
CLAIM = 0.8
"""Share of the cases in which the band shall hold."""
FEWEST = 20
"""Random points with a law from which they alone set its band."""
MOSTLY = 0.3
"""Share of the time out of contact from which contact counts as mostly lost."""
SHOWN = ("table", "areal", "shifted", "linear-dprs", "linear-filtered", "linear-remington")
LAWS = (
    "table", "areal", "shifted", "printed", "hertz-filtered", "hertz", "linear-dprs", "linear-filtered",
    "linear-remington", "linear-cnossos", "linear",
)  # fmt: skip
Record = Mapping[str, Any]


def publish(parts: Mapping[str, Sequence[Record]], own: Mapping[str, Mapping[str, float]]) -> None:
    """Write the data, draw the figure, fill the tables of the page; `own`: what grids change of `direct`."""
    bands = parts["fresh"][0]["paths"][0]["centres"]
    grid = [summary(record) for record in parts["map"]]
    aside, fresh = ([summary(record) for record in parts[part]] for part in ("aside", "fresh"))
    data: dict[str, Any] = {
        "bands": [round(band, 1) for band in bands],
        "claim": CLAIM,
        "spread": {},
        "points": [*grid, *aside],
    }
    unspread = law_map_of(data)
    data["spread"] = {law: spread(unspread, len(grid), law) for law in LAWS}
    for file, content in ((DATA, data), (FRESH, fresh)):
        text = json.dumps(content, separators=(",", ":")).replace('{"kind"', '\n{"kind"')
        file.write_text(text + "\n", encoding="utf-8")
    mapped = law_map_of(data)
    draw(data)
    fill(
        {
            "errors": errors_table(data),
            "points": points_table(data),
            "hits": hits_table(mapped, mapped_points(fresh)),
            "own": own_table(parts["fresh"], own),
        }
    )


def summary(record: Record) -> dict[str, Any]:
    """What the package keeps of a point."""
    point, paths = record["point"], record["paths"]
    places = record["places"]
    steps = paths[0]["steps"] * (RECORD + SETTLING) / RECORD
    found: dict[str, Any] = {
        "kind": point["kind"],
        "asked": {name: _short(point[name]) for name in ("roughness", "correlation")},
        "anisotropy": _short(point["anisotropy"]),
        "load": _short(point["load"]),
        "speed": _short(point["speed"]),
        "hurst": _short(point["hurst"]),
        "place": {name: _short(np.mean([place[name] for place in places])) for name in places[0]},
        "loss": _short(np.mean([path["laws"]["direct"]["loss"] for path in paths])),
        "dynamic": _short(np.mean([path["dynamic"] for path in paths]) / point["load"]),
        "area": _short(np.mean([path["area_ratio"] for path in paths])),
        "step": round(1e6 * _seconds(paths, "direct") / steps),
        "laws": {},
    }
    for law in LAWS:
        rolled = [path["laws"] for path in paths if law in path["laws"]]
        if rolled:
            found["laws"][law] = _error(rolled, law)
    return found


def _error(paths: Sequence[Record], law: str) -> float:
    """Level of a law less that of `direct`, of energies averaged over the paths, rms over the bands, dB."""
    own, reference = (np.array([path[name]["energy"] for path in paths]) for name in (law, "direct"))
    level = 10.0 * np.log10(own.mean(axis=0) / reference.mean(axis=0))
    return _short(np.sqrt(np.mean(level**2)))


def _seconds(paths: Sequence[Record], law: str) -> float:
    return float(np.mean([path["laws"][law]["seconds"] for path in paths]))


def _short(value: float) -> float:
    return float(f"{float(value):.3g}")


def spread(mapped: LawMap, grid: int, law: str) -> float:
    """Deviations within which the error of a law stayed as often as is claimed, at random points.

    These come after those of the grid, which counts too where they are few; each is estimated from all
    others. The quantile is that of conformal prediction: one more than the number of cases times the claim,
    rounded up, the claim raised by a standard deviation of the share of so many.
    """
    off = []
    drawn = sum(law in point.errors for point in mapped.points[grid:])
    for number in range(grid if drawn >= FEWEST else 0, len(mapped.points)):
        others = replace(mapped, points=mapped.points[:number] + mapped.points[number + 1 :])
        off += [abs(found) / deviation for found, deviation in missed(others, [mapped.points[number]], law)]
    off.sort()
    share = CLAIM + math.sqrt(CLAIM * (1.0 - CLAIM) / len(off))
    rank = min(math.ceil((len(off) + 1) * share), len(off))
    return round(off[rank - 1], 3)


def missed(mapped: LawMap, cases: Sequence[MappedPoint], law: str) -> list[tuple[float, float]]:
    """Logarithm of the error found over that expected, and the deviation of the estimate."""
    found = []
    for case in cases:
        if law in case.errors:
            expected, deviation = estimate(mapped, case.kind, case.place, law)
            found.append((math.log(case.errors[law]) - expected, deviation))
    return found


def draw(data: Record) -> None:
    """Draw the errors over roughness and correlation length, for each law and kind, and over k a of 5 kHz."""
    from matplotlib.colors import BoundaryNorm
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.5, 8.2), layout="constrained")
    panels = figure.subplots(3, len(SHOWN), sharex="row", sharey="row")
    norm = BoundaryNorm([0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0], 256)
    for row, kind in zip(panels, (BALL, WHEEL), strict=False):
        points = [p for p in data["points"] if p["kind"] == kind]
        for axes, law in zip(row, SHOWN, strict=True):
            image = _panel(axes, [p for p in points if law in p["laws"]], law, norm)
        row[0].set_ylabel(f"{'ball' if kind == BALL else 'wheel'}\nrms within the patch / approach")
        row[len(SHOWN) // 2].set_xlabel("correlation length / length of the contact", x=0.0)
    for axes, law in zip(panels[2], SHOWN, strict=True):
        _over_wavenumber(axes, [p for p in data["points"] if law in p["laws"]], law)
    panels[2][0].set_ylabel("contact kept\nerror / dB")
    panels[2][0].legend(fontsize=7, loc="upper left", handletextpad=0.1)
    panels[2][len(SHOWN) // 2].set_xlabel("k a of 5 kHz", x=0.0)
    for axes, law in zip(panels[0], SHOWN, strict=True):
        axes.set_title(law, fontsize=10)
    bar = figure.colorbar(image, ax=panels[:2], shrink=0.8, format="%g")
    bar.set_label("rms level difference to direct, 100 Hz to 5 kHz, dB")
    figure.savefig(FIGURE, dpi=110)


def _over_wavenumber(axes: Any, points: Sequence[Record], law: str) -> None:
    """One law: the errors of all points where contact is kept, over k a of the highest band."""
    for kind, name, colour, mark in ((BALL, "ball", "#c2410c", "o"), (WHEEL, "wheel", "#1d4ed8", "^")):
        kept = [p for p in points if p["kind"] == kind and p["loss"] < 0.01]
        x = [p["place"]["highest_wavenumber"] for p in kept]
        y = [max(p["laws"][law], LEAST) for p in kept]
        axes.plot(x, y, mark, color=colour, ms=3, alpha=0.7, label=name)
    axes.set(xscale="log", yscale="log", ylim=(0.08, 30))
    axes.set_xticks([1, 3, 10, 30], ["1", "3", "10", "30"])
    axes.set_yticks([0.1, 1, 10], ["0.1", "1", "10"])
    axes.minorticks_off()


def _panel(axes: Any, points: Sequence[Record], law: str, norm: Any) -> Any:
    """One law: a mark for each point, a cross where contact is mostly lost."""
    for lost, mark in ((False, "s"), (True, "x")):
        among = [p for p in points if (p["loss"] > MOSTLY) == lost]
        x = [p["place"]["correlation"] for p in among]
        y = [p["place"]["within"] for p in among]
        error = [p["laws"][law] for p in among]
        image = axes.scatter(x, y, c=error, norm=norm, cmap="YlOrRd", s=22, marker=mark)
    axes.set(xscale="log", yscale="log", facecolor="#e8eaed")
    axes.set_xticks([0.1, 1, 10], ["0.1", "1", "10"])
    axes.set_yticks([0.01, 0.1, 1, 10], ["0.01", "0.1", "1", "10"])
    axes.minorticks_off()
    return image


def fill(tables: Mapping[str, str]) -> None:
    """Put tables between their marks in the page."""
    text = PAGE.read_text(encoding="utf-8")
    for name, table in tables.items():
        marks = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        assert marks.search(text), f"{PAGE} has no place for the table {name}"
        text = marks.sub(lambda found, table=table: f"{found[1]}\n{table}\n{found[2]}", text, count=1)  # type: ignore[misc]
    PAGE.write_text(text, encoding="utf-8")


def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Write a Markdown table, all columns but the first to the right."""
    lines = [f"| {' | '.join(line)} |" for line in (headings, *rows)]
    lines.insert(1, f"|---|{'---:|' * (len(headings) - 1)}")
    return "\n".join(lines) + "\n"


def _decibels(value: float) -> str:
    return f"{value:.2f}" if value < 0.995 else f"{value:.1f}"


def errors_table(data: Record) -> str:
    """Median and largest error of each law over groups of points."""
    held = [p for p in data["points"] if p["loss"] < 0.01]
    among = {
        "within ≤ 0.1": [p for p in held if p["place"]["within"] <= 0.1],
        "0.1 to 0.3": [p for p in held if 0.1 < p["place"]["within"] <= 0.3],
        "above 0.3": [p for p in held if p["place"]["within"] > 0.3],
        "lost 1 to 30 %": [p for p in data["points"] if 0.01 <= p["loss"] <= MOSTLY],
        "mostly lost": [p for p in data["points"] if p["loss"] > MOSTLY],
    }
    rows = []
    for law in LAWS:
        row = [f"`{law}`"]
        for points in among.values():
            errors = [p["laws"][law] for p in points if law in p["laws"]]
            row.append(f"{_decibels(np.median(errors))} ({_decibels(max(errors))})" if errors else "–")
        rows.append(row)
    return table(["law", *(f"{name} [{len(points)}]" for name, points in among.items())], rows)


def points_table(data: Record) -> str:
    """Write all points: what was asked for, place, lost contact, errors."""
    shown = ("table", "areal", "shifted", "hertz-filtered", "linear-filtered", "linear-dprs")
    rows = []
    for p in sorted(data["points"], key=lambda p: (p["kind"], p["load"], p["speed"], *p["asked"].values())):
        place = p["place"]
        load = f"{p['load']:.3g} N" if p["load"] < 1e3 else f"{p['load'] / 1e3:.3g} kN"
        row = [f"{'ball' if p['kind'] == BALL else 'wheel'}, {load}", f"{p['speed']:.2g}"]
        row += [f"{value:.2g}" for value in p["asked"].values()] + [f"{p['anisotropy']:.2g}"]
        row += [f"{place[name]:.2g}" for name in ("within", "dynamic", "highest_wavenumber")]
        row += [f"{100 * p['loss']:.0f}"]
        row += [_decibels(p["laws"][law]) if law in p["laws"] else "" for law in shown]
        rows.append(row)
    headings = ["bodies", "m/s", "rms", "length", "lay", "within", "dynamic", "k a", "lost, %"]
    return table([*headings, *(f"`{law}`" for law in shown)], rows)


def hits_table(mapped: LawMap, fresh: Sequence[MappedPoint]) -> str:
    """How often the band held on the cases that were drawn afterwards."""
    rows, met, tried = [], 0, 0
    for law in LAWS:
        found = missed(mapped, fresh, law)
        factors = [mapped.spread[law] * deviation for _, deviation in found]
        held = sum(abs(off) <= factor for (off, _), factor in zip(found, factors, strict=True))
        met, tried = met + held, tried + len(found)
        middle = float(np.exp(np.mean([off for off, _ in found])))
        width = f"{np.exp(np.median(factors)):.2f}"
        rows.append([f"`{law}`", width, f"{held} of {len(found)}", f"{middle:.2f}"])
    share = f"{100 * met / tried:.0f} %" if tried else "–"
    rows.append(["all", "", f"{met} of {tried}, {share}", ""])
    return table(["law", "band: times, divided by", "held in", "found over expected"], rows)


def own_table(records: Sequence[Record], own: Mapping[str, Mapping[str, float]]) -> str:
    """Change of `direct` with half the step and half the cells: median and largest, by loss of contact."""
    rows = []
    for words, kind, least, most in (
        ("wheels", WHEEL, 0.0, 1.0),
        ("balls, contact lost for less than 1 % of the time", BALL, 0.0, 0.01),
        ("balls, lost for 1 to 10 %", BALL, 0.01, 0.1),
        ("balls, lost for longer", BALL, 0.1, 1.0),
    ):
        changes = []
        for record in records:
            name = Point(**record["point"]).name
            loss = np.mean([path["laws"]["direct"]["loss"] for path in record["paths"]])
            if name in own and record["point"]["kind"] == kind and least <= loss < most:
                changes.append(own[name])
        row = [words, str(len(changes))]
        for part in ("step", "grid"):
            values = [change[part] for change in changes]
            row.append(f"{np.median(values):.2g} ({max(values):.2g})")
        rows.append(row)
    return table(["contact", "cases", "half the step", "half the cells"], rows)
