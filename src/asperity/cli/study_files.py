"""What a study writes beside its table: means over seeds, a figure for each swept key, an ensemble's band."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import xarray

from asperity.comma_separated import write_csv
from asperity.files import lasting, write_bytes
from asperity.laws import spec_of
from asperity.reporting.ensemble import ensemble_figure
from asperity.reporting.study_figures import key_figure
from asperity.studies.columns import columns_of, long_columns
from asperity.studies.ensemble import FEWEST, SCATTER, prediction_band
from asperity.terminal import say

SEED = "seed"
"""The key by which members differ by chance alone."""
NOT_ALWAYS = ("study_mean.csv", "study-*.png", "ensemble.csv", "ensemble.png")
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


def write_figures(
    table: xarray.Dataset, means: xarray.Dataset | None, names: Sequence[str], directory: Path
) -> dict[str, Path]:
    """Draw a figure of quantities by name for each swept key that is more than chance."""
    looks = {law: _look(law) for law in map(str, table["law"].values)}
    shown, scatter = table, None
    if means is not None:
        held = [str(name) for name in means.data_vars if str(name).endswith(SCATTER)]
        shown = means.drop_vars(held)
        scatter = means[held].rename({name: name.removesuffix(SCATTER) for name in held})
    files = {}
    for key in json.loads(table.attrs["sweep"]):
        if key in shown.dims and shown.sizes[key] > 1:
            image = io.BytesIO()
            key_figure(shown, scatter, key, looks, names).savefig(image, format="png", dpi=150)
            files[f"figure {key}"] = write_bytes(directory / f"study-{key}.png", image.getvalue())
            say(f"Figure:  {lasting(files[f'figure {key}']).resolve()}")
    return files


def _look(law: str) -> dict[str, Any]:
    entry = spec_of(law).entry()
    return {"color": entry["colour"], "linestyle": _dashes(entry["dashes"])}


def _dashes(dashes: Any) -> Any:
    return dashes if isinstance(dashes, str) else (dashes[0], tuple(dashes[1]))


def write_ensemble(table: xarray.Dataset, directory: Path) -> dict[str, Path]:
    """Write mean and band over the seeds of a study, if it sweeps them, as CSV and as a figure."""
    files = [directory / name for name in ("ensemble.csv", "ensemble.png")]
    if table.sizes.get(SEED, 0) < FEWEST:
        return {}
    bands = prediction_band(table)
    colours = {str(law): str(_look(str(law))["color"]) for law in bands["law"].values}
    swept = [name for name in json.loads(table.attrs["sweep"]) if name != SEED]
    write_csv(files[0], *long_columns(bands, [*swept, "law", "band"]))
    image = io.BytesIO()
    ensemble_figure(bands, colours).savefig(image, format="png", dpi=150)
    write_bytes(files[1], image.getvalue())
    say(f"Seeds:   {lasting(files[1]).resolve()}, and as numbers {files[0].name}")
    say(str(bands.attrs["meaning"]))
    return {"ensemble": files[0], "ensemble figure": files[1]}
