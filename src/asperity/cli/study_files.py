"""What a study writes beside its table: means over seeds, an ensemble's band, a page of figures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import xarray

from asperity.comma_separated import write_csv
from asperity.files import lasting, write_bytes
from asperity.laws import spec_of
from asperity.reporting.law_entries import line_style, read_entries
from asperity.reporting.page import PageFigure, figures_page
from asperity.reporting.payload import chart_tables
from asperity.reporting.study_figures import ensemble_chart, key_caption, key_chart
from asperity.studies.ensemble import FEWEST, SCATTER, prediction_band
from asperity.studies.table import columns_of, long_columns
from asperity.terminal import say

SEED = "seed"
"""The key by which members differ by chance alone."""
NOT_ALWAYS = ("study_mean.csv", "ensemble.csv", "study.html")
"""What not every study writes: that of an earlier one goes."""


def write_mean(means: xarray.Dataset | None, directory: Path) -> dict[str, Path]:
    """Write mean and standard deviation over the seeds, if they were swept."""
    path = directory / "study_mean.csv"
    if means is None:
        return {}
    write_csv(path, *columns_of(means))
    over = f"{means.attrs['members']} values of {SEED}"
    say(f"Means:   {lasting(path).resolve()}, over {over}, ± their standard deviation")
    return {"mean": path}


def write_ensemble(bands: xarray.Dataset | None, directory: Path) -> dict[str, Path]:
    """Write mean and band over the seeds of a study, if it sweeps enough of them."""
    if bands is None:
        return {}
    file = directory / "ensemble.csv"
    swept = [str(name) for name in bands["force_level"].dims if name not in ("law", "band")]
    write_csv(file, *long_columns(bands, [*swept, "law", "band"]))
    say(f"Seeds:   {lasting(file).resolve()}")
    say(str(bands.attrs["meaning"]))
    return {"ensemble": file}


def band_over_seeds(table: xarray.Dataset) -> xarray.Dataset | None:
    """Mean and band of levels over the seeds of a study, if it sweeps enough of them."""
    return prediction_band(table) if table.sizes.get(SEED, 0) >= FEWEST else None


def write_study_page(
    table: xarray.Dataset,
    means: xarray.Dataset | None,
    bands: xarray.Dataset | None,
    names: Sequence[str],
    directory: Path,
) -> dict[str, Path]:
    """Write figures on a page: of quantities by name over each swept key, and of the band over seeds."""
    laws = read_entries(spec_of(str(law)).entry() for law in table["law"].values)
    looks = {name: line_style(law, 1.6) | {"marker": law.marker} for name, law in laws.items()}
    figures = _key_figures(table, means, names, looks)
    if bands is not None:
        chart = ensemble_chart(bands, looks)
        told = "Contact force over the seeds", str(bands.attrs["meaning"])
        figures.append(PageFigure("ensemble", *told, chart, chart_tables(chart), "ensemble.csv"))
    if not figures:
        return {}
    swept = " × ".join(f"{table.sizes[name]} {name}" for name in json.loads(table.attrs["sweep"]))
    done, count = int(table["completed"].sum()), table["completed"].size
    summary = swept if done == count else f"{swept}; {done} of {count} members completed"
    held = {
        "table (CSV)": "study.csv",
        "means over seeds (CSV)": "study_mean.csv",
        "band over seeds (CSV)": "ensemble.csv",
        "results (netCDF)": "study.nc",
    }
    files = {what: file for what, file in held.items() if (directory / file).exists()}
    path = directory / "study.html"
    write_bytes(path, figures_page("Study", summary, figures, files).encode())
    say(f"Page:    {lasting(path).resolve()}")
    return {"page": path}


def _key_figures(
    table: xarray.Dataset,
    means: xarray.Dataset | None,
    names: Sequence[str],
    looks: dict[str, dict[str, Any]],
) -> list[PageFigure]:
    """A figure for each swept key that is more than chance."""
    shown, scatter = table, None
    if means is not None:
        held = [str(name) for name in means.data_vars if str(name).endswith(SCATTER)]
        shown = means.drop_vars(held)
        scatter = means[held].rename({name: name.removesuffix(SCATTER) for name in held})
    swept = [key for key in json.loads(table.attrs["sweep"]) if shown.sizes.get(key, 0) > 1]
    charts = {key: key_chart(shown, scatter, key, looks, names) for key in swept}
    return [
        PageFigure(f"key-{key}", f"Over {key}", key_caption(shown, scatter, key), chart, chart_tables(chart))
        for key, chart in charts.items()
    ]
