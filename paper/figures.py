"""The figures of the paper: ``python paper/figures.py [FOLDER]``."""

from __future__ import annotations

import csv
import runpy
import sys
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt

from asperity.reference.law_accuracy import law_map

HERE = Path(__file__).parent
LAWS = ("table", "areal", "shifted", "hertz-filtered", "linear-filtered", "printed", "hertz", "linear")
KEPT = 0.01
"""Share of the time out of contact up to which contact counts as kept."""


def laws(file: Path) -> None:
    """Draw the errors of all laws over the points of the map."""
    points = law_map().points
    figure, panels = plt.subplots(1, 2, figsize=(8.4, 3.4), sharex=True, sharey=True, layout="constrained")
    groups = ([p for p in points if p.loss < KEPT], [p for p in points if p.loss >= KEPT])
    for axes, group, title in zip(panels, groups, ("contact kept", "contact lost"), strict=True):
        errors = [[p.errors[law] for p in group if law in p.errors] for law in LAWS]
        axes.boxplot(errors, orientation="horizontal", whis=(0, 100), tick_labels=LAWS)
        axes.set(title=f"{title}: {len(group)} points", xlabel="error / dB", xscale="log")
        axes.set_xticks([0.1, 1.0, 10.0], ["≤ 0.1", "1", "10"])
    panels[0].invert_yaxis()
    figure.savefig(file, dpi=200)


def rail(file: Path) -> None:
    """Draw what the example of the wheel on the rail draws."""
    runpy.run_path(str(HERE.parent / "examples/wheel_on_rail.py"))
    plt.gcf().savefig(file, dpi=200)


def measured(file: Path) -> None:
    """Draw the sections with rail dampers less the one without: measured, predicted, and kept back."""
    with (HERE.parent / "docs/evidence/railway_sections.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    titles = list(dict.fromkeys(row["section"] for row in rows))
    figure, panels = plt.subplots(1, len(titles), figsize=(8.4, 2.8), sharey=True, layout="constrained")
    for axes, title in zip(panels, titles, strict=True):
        own = [row for row in rows if row["section"] == title]
        band, middle, low, high = (
            [float(row[name]) for row in own]
            for name in ("band (Hz)", "predicted (dB)", "low (dB)", "high (dB)")
        )
        axes.fill_between(band, low, high, alpha=0.25, lw=0)
        axes.semilogx(band, middle)
        told = [
            (b, float(row["measured (dB)"])) for b, row in zip(band, own, strict=True) if row["measured (dB)"]
        ]
        if told:
            axes.semilogx(*zip(*told, strict=True), "ko", ms=3)
        axes.axhline(0.0, color="0.5", lw=0.6)
        axes.set(title=title, xlabel="band / Hz")
        axes.set_xticks([250.0, 1000.0, 4000.0], ["250", "1000", "4000"])
        axes.minorticks_off()
    panels[0].set_ylabel("less reference / dB")
    figure.savefig(file, dpi=200)


def main(folder: Path = HERE) -> None:
    """Draw all figures into a folder."""
    mpl.use("agg")
    laws(folder / "laws.png")
    rail(folder / "rail.png")
    measured(folder / "measured.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE)
