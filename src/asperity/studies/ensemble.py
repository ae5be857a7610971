"""Members of a study that differ by chance alone: their mean, and the band in which one more lies."""

import numpy as np
import xarray
from scipy import stats

from asperity.arguments import real, shown
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


def prediction_band(table: xarray.Dataset, over: str = SEED, share: float = SHARE) -> xarray.Dataset:
    """Mean of the members of a study, and the band in which one more of them lies.

    Parameters
    ----------
    table : xarray.Dataset
        From `asperity.study`.
    over : str
        The swept key by which members differ by chance alone.
    share : float
        Probability, above 0 and below 1, with which the band holds one more member.

    Returns
    -------
    xarray.Dataset
        Without the dimension `over`: for every level and every force of the table its mean over the members
        that have one, and ``…_low`` and ``…_high``, the ends of the band; NaN where fewer than two have one.
        The attributes say over what, of how many members, and what the band means.

    Raises
    ------
    InputError
        If the table has no such key, or fewer than three values of it, or the share is none.

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
    if not isinstance(table, xarray.Dataset) or over not in table.dims:
        held = list(map(str, table.dims)) if isinstance(table, xarray.Dataset) else shown(table)
        raise InputError("over", f"'{over}' for {held}", "a key that the study sweeps")
    if table.sizes[over] < FEWEST:
        received = f"{table.sizes[over]} values of {over}"
        raise InputError("table of the study", received, f"at least {FEWEST}", "Compute more members.")
    share = real("share", share, "a number above 0 and below 1", above=0.0)
    if share >= 1.0:
        raise InputError("share", share, "a number above 0 and below 1")
    found: dict[str, xarray.Variable] = {}
    for name, values in table.data_vars.items():
        if over in values.dims and str(values.attrs.get("units", "")).startswith(BANDED):
            found |= _band(str(name), values, over, share)
    kept = {name: values.variable for name, values in table.coords.items() if name != over}
    count = int(table["completed"].sum(over).max())
    attrs = {"over": over, "members": count, "share": share, "meaning": meaning(over, count, share)}
    for name in ("band_time_product", "start_share"):
        if name in table:
            found[name] = table[name].mean(over, keep_attrs=True).variable
    return xarray.Dataset(found | kept, attrs=attrs)


def _band(name: str, values: xarray.DataArray, over: str, share: float) -> dict[str, xarray.Variable]:
    """Mean and ends of the band of a quantity."""
    finite = values.where(np.isfinite(values))
    reach, count = student(finite, over, share)
    reach, mean = reach * np.sqrt(count + 1.0), finite.mean(over).where(count >= 2)
    units, what = values.attrs["units"], values.attrs["long_name"]
    told = {"missing": "fewer than two members have it"} if (count < 2).any() else {}
    ends = {"": (mean, "mean"), "_low": (mean - reach, "low end"), "_high": (mean + reach, "high end")}
    return {
        f"{name}{end}": variable(list(map(str, of.dims)), of.values, units, f"{what}, {which}", **told)
        for end, (of, which) in ends.items()
    }


def student(values: xarray.DataArray, over: str, share: float) -> tuple[xarray.DataArray, xarray.DataArray]:
    """Half of the confidence interval of a mean over a key, t s/√n, NaN of fewer than two; and n."""
    count = values.notnull().sum(over)
    n = count.where(count >= 2)
    reach = stats.t.ppf(0.5 * (1.0 + share), n - 1)
    return values.std(over, ddof=1) * reach / np.sqrt(n), count


def mean_and_scatter(table: xarray.Dataset, over: str = SEED) -> xarray.Dataset:
    """Mean of the members of a study, and how they scatter.

    Parameters
    ----------
    table : xarray.Dataset
        From `asperity.study`.
    over : str
        The swept key by which members differ by chance alone.

    Returns
    -------
    xarray.Dataset
        Without the dimension `over`: for every quantity its mean over the members that have it, and
        ``…_scatter``, the standard deviation of a member (n − 1), NaN of fewer than two. Levels are averaged
        as they are, in dB.
    """
    found: dict[str, xarray.Variable] = {}
    for name, values in table.data_vars.items():
        if over in values.dims and values.dtype.kind == "f":
            count = values.notnull().sum(over)
            attrs = {"units": values.attrs["units"], "long_name": f"{values.attrs['long_name']}, mean"}
            found[str(name)] = values.mean(over).assign_attrs(attrs).variable
            what = f"{values.attrs['long_name']}, standard deviation over {over}"
            scatter = values.std(over, ddof=1).where(count >= 2).assign_attrs(attrs | {"long_name": what})
            found[f"{name}{SCATTER}"] = scatter.variable
    kept = {name: values.variable for name, values in table.coords.items() if name != over}
    return xarray.Dataset(found | kept, attrs={**table.attrs, "over": over, "members": table.sizes[over]})


def meaning(over: str, count: int, share: float) -> str:
    """Say what mean and band are."""
    return (
        f"Line: mean over {count} values of {over}. Band: prediction interval; it holds the value of one "
        f"more {over} with a probability of {100 * share:g} %: mean ± t s √(1 + 1/n), Student's t with n − 1 "
        "degrees of freedom (Hahn and Meeker 1991)."
    )
