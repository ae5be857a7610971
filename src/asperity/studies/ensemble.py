"""Members of a study that differ by chance alone: their mean, and the band in which one more lies."""

from typing import TypeVar

import numpy as np
import xarray
from scipy.special import stdtrit

from asperity.arguments import real, require
from asperity.errors import InputError
from asperity.results import variable

Values = TypeVar("Values", xarray.DataArray, xarray.Dataset)
SEED = "seed"
"""The key by which members differ by chance alone."""
SHARE = 0.8
"""Probability with which the band holds one more member."""
FEWEST = 3
"""Members of which a band says something."""
BANDED = ("dB", "N")
"""Beginnings of the units of what has a band: levels, and means and rms of forces."""


def prediction_band(table: xarray.Dataset, share: float = SHARE) -> xarray.Dataset:
    """Mean of the members of a study over its seeds, and the band in which one more of them lies.

    Parameters
    ----------
    table : xarray.Dataset
        From `asperity.study`, of several seeds: members that differ by chance alone.
    share : float
        Probability, above 0 and below 1, with which the band holds one more member.

    Returns
    -------
    xarray.Dataset
        Without the dimension `seed`: for every level and every force of the table its mean over the members
        that have one, and ``…_low`` and ``…_high``, the ends of the band; NaN where fewer than two have one.
        The attributes say over what, of how many members, and what the band means.

    Raises
    ------
    InputError
        If the table has no seeds, or fewer than three, or the share is none.

    Notes
    -----
    The band is a prediction interval, mean ± t s √(1 + 1/n), with the standard deviation s of the n members
    and Student's t for n − 1 degrees of freedom: it holds one more member with the probability given, for any
    n. G. J. Hahn and W. Q. Meeker, Statistical Intervals (1991). It is exact for normally
    distributed values. Levels of noise whose power is averaged over B T, chi-square with 2 B T degrees of
    freedom, are skew; their band of 80 % holds 79 % to 83 % of them, also where B T is one.

    Examples
    --------
    >>> import asperity
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> with ThreadPoolExecutor(1) as here:
    ...     table = asperity.study(case, {"seed": [1, 2, 3]}, executor=here)
    >>> band = asperity.prediction_band(table)
    >>> band["force_level_high"].dims, bool((band["rms_force_high"] > band["rms_force"]).all())
    (('law', 'band'), True)
    """
    sizes = table.sizes if isinstance(table, xarray.Dataset) else {}
    received = f"{sizes.get(SEED, 0)} values of {SEED}"
    enough = sizes.get(SEED, 0) >= FEWEST
    allowed = f"at least {FEWEST}"
    require(enough, "table of the study", received, allowed, "Compute more members.")
    share = real("share", share, "a number above 0 and below 1", above=0.0)
    if share >= 1.0:
        raise InputError("share", share, "a number above 0 and below 1")
    found: dict[str, xarray.Variable] = {}
    for name, values in table.data_vars.items():
        if SEED not in values.dims or not str(values.attrs.get("units", "")).startswith(BANDED):
            continue
        finite = values.where(np.isfinite(values))
        reach, n = student(finite, share)
        mean = finite.mean(SEED).where(n >= 2)
        reach = reach * np.sqrt(n + 1.0)
        units = values.attrs["units"]
        what = values.attrs["long_name"]
        told = {"missing": "fewer than two members have it"} if (n < 2).any() else {}
        ends = ("", mean, "mean"), ("_low", mean - reach, "low end"), ("_high", mean + reach, "high end")
        for end, of, which in ends:
            dims = list(map(str, of.dims))
            found[f"{name}{end}"] = variable(dims, of.values, units, f"{what}, {which}", **told)
    kept = {name: values.variable for name, values in table.coords.items() if name != SEED}
    for name in ("band_time_product", "start_share"):
        if name in table:
            found[name] = table[name].mean(SEED, keep_attrs=True).variable
    count = int(table["completed"].sum(SEED).max())
    meaning = (
        f"Line: mean over {count} values of {SEED}. Band: prediction interval; it holds the value of one "
        f"more {SEED} with a probability of {100 * share:g} %: mean ± t s √(1 + 1/n), Student's t with n − 1 "
        "degrees of freedom (Hahn and Meeker 1991)."
    )
    return xarray.Dataset(
        found | kept, attrs={"over": SEED, "members": count, "share": share, "meaning": meaning}
    )


def student(values: xarray.DataArray, share: float) -> tuple[xarray.DataArray, xarray.DataArray]:
    """Half of the confidence interval of a mean over the seeds, t s/√n, NaN of fewer than two; and n."""
    count = values.notnull().sum(SEED)
    n = count.where(count >= 2)
    reach = stdtrit(n - 1, 0.5 * (1.0 + share))
    return _deviation(values, n) * reach / np.sqrt(n), count


def _deviation(values: Values, count: Values) -> Values:
    """Standard deviation over the seeds (n − 1), of a count that is NaN where that is below two."""
    squares: Values = ((values - values.mean(SEED)) ** 2).sum(SEED)
    return (squares / (count - 1)) ** 0.5


def mean_and_scatter(table: xarray.Dataset) -> tuple[xarray.Dataset, xarray.Dataset]:
    """Mean of the members of a study over its seeds, and how they scatter.

    Parameters
    ----------
    table : xarray.Dataset
        From `asperity.study`, of several seeds.

    Returns
    -------
    mean, scatter : xarray.Dataset
        Without the dimension `seed`: of every quantity the mean over the members that have it, and the
        standard deviation of a member (n − 1), NaN of fewer than two. Levels are averaged as they are, in dB.
    """
    held = table[[name for name, v in table.data_vars.items() if SEED in v.dims and v.dtype.kind == "f"]]
    count = held.count(SEED)
    scatter = _deviation(held, count.where(count >= 2))
    return held.mean(SEED, keep_attrs=True).assign_attrs(members=table.sizes[SEED]), scatter
