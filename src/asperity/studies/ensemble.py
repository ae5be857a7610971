"""Members of a study that differ by chance alone: their mean, and the band in which one more lies."""

import numpy as np
import xarray
from scipy import stats

from asperity.arguments import real, require
from asperity.errors import InputError
from asperity.results import variable

SEED = "seed"
"""The key by which members differ by chance alone."""
SHARE = 0.8
"""Probability with which the band holds one more member."""
FEWEST = 3
"""Members of which a band says something."""
SCATTER = "_scatter"
"""End of the names of standard deviations."""
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
    enough, allowed = sizes.get(SEED, 0) >= FEWEST, f"at least {FEWEST}"
    require(enough, "table of the study", received, allowed, "Compute more members.")
    share = real("share", share, "a number above 0 and below 1", above=0.0)
    if share >= 1.0:
        raise InputError("share", share, "a number above 0 and below 1")
    found: dict[str, xarray.Variable] = {}
    for name, values in table.data_vars.items():
        if SEED in values.dims and str(values.attrs.get("units", "")).startswith(BANDED):
            found |= _band(str(name), values, share)
    kept = {name: values.variable for name, values in table.coords.items() if name != SEED}
    count = int(table["completed"].sum(SEED).max())
    attrs = {"over": SEED, "members": count, "share": share, "meaning": meaning(count, share)}
    for name in ("band_time_product", "start_share"):
        if name in table:
            found[name] = table[name].mean(SEED, keep_attrs=True).variable
    return xarray.Dataset(found | kept, attrs=attrs)


def _band(name: str, values: xarray.DataArray, share: float) -> dict[str, xarray.Variable]:
    """Mean and ends of the band of a quantity."""
    finite = values.where(np.isfinite(values))
    reach, count = student(finite, share)
    reach, mean = reach * np.sqrt(count + 1.0), finite.mean(SEED).where(count >= 2)
    units, what = values.attrs["units"], values.attrs["long_name"]
    told = {"missing": "fewer than two members have it"} if (count < 2).any() else {}
    ends = {"": (mean, "mean"), "_low": (mean - reach, "low end"), "_high": (mean + reach, "high end")}
    return {
        f"{name}{end}": variable(list(map(str, of.dims)), of.values, units, f"{what}, {which}", **told)
        for end, (of, which) in ends.items()
    }


def student(values: xarray.DataArray, share: float) -> tuple[xarray.DataArray, xarray.DataArray]:
    """Half of the confidence interval of a mean over the seeds, t s/√n, NaN of fewer than two; and n."""
    count = values.notnull().sum(SEED)
    n = count.where(count >= 2)
    reach = stats.t.ppf(0.5 * (1.0 + share), n - 1)
    return values.std(SEED, ddof=1) * reach / np.sqrt(n), count


def mean_and_scatter(table: xarray.Dataset) -> xarray.Dataset:
    """Mean of the members of a study over its seeds, and how they scatter.

    Parameters
    ----------
    table : xarray.Dataset
        From `asperity.study`, of several seeds.

    Returns
    -------
    xarray.Dataset
        Without the dimension `seed`: for every quantity its mean over the members that have it, and
        ``…_scatter``, the standard deviation of a member (n − 1), NaN of fewer than two. Levels are averaged
        as they are, in dB.
    """
    found: dict[str, xarray.Variable] = {}
    for name, values in table.data_vars.items():
        if SEED in values.dims and values.dtype.kind == "f":
            count = values.notnull().sum(SEED)
            attrs = {"units": values.attrs["units"], "long_name": f"{values.attrs['long_name']}, mean"}
            found[str(name)] = values.mean(SEED).assign_attrs(attrs).variable
            what = f"{values.attrs['long_name']}, standard deviation over {SEED}"
            scatter = values.std(SEED, ddof=1).where(count >= 2).assign_attrs(attrs | {"long_name": what})
            found[f"{name}{SCATTER}"] = scatter.variable
    kept = {name: values.variable for name, values in table.coords.items() if name != SEED}
    return xarray.Dataset(found | kept, attrs={**table.attrs, "members": table.sizes[SEED]})


def meaning(count: int, share: float) -> str:
    """Say what mean and band are."""
    return (
        f"Line: mean over {count} values of {SEED}. Band: prediction interval; it holds the value of one "
        f"more {SEED} with a probability of {100 * share:g} %: mean ± t s √(1 + 1/n), Student's t with n − 1 "
        "degrees of freedom (Hahn and Meeker 1991)."
    )
