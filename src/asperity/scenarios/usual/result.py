"""The result of one body that rolled over another, laid out as labelled groups."""

from __future__ import annotations

import warnings

import xarray

from asperity.scenarios.contact_group import contact_group
from asperity.scenarios.surface_group import surface_group
from asperity.scenarios.tree import assembled, force_spectra, rolling_group
from asperity.scenarios.usual import schema
from asperity.scenarios.usual.compute import Computed
from asperity.scenarios.validity import findings, verdict, warn_of_findings


def layout(
    computed: Computed, caught: list[warnings.WarningMessage], *, brief: bool = False
) -> xarray.DataTree:
    """Lay out what was computed, with units and provenance; warnings of that may be added to `caught`.

    In brief without what only a report shows: what the path is like.
    """
    chain, kind = computed.chain, computed.prepared.kind
    spectra = xarray.Dataset(force_spectra(chain))
    found = findings(chain)
    warn_of_findings(found)
    own = {
        schema.OVER_DISPLACEMENT: chain.stacked("over_displacement"),
        schema.ROLLING_DISPLACEMENT: chain.stacked("rolling_displacement"),
    }
    groups = {
        "/surface": surface_group(chain, brief=brief),
        "/contact": contact_group(chain, found),
        "/rolling": rolling_group(chain, own),
        "/spectra": spectra,
    }
    title = kind.words.title.rstrip(".")
    told = verdict(chain, spectra, found, kind.rolling)
    return assembled(chain, groups, caught, title=title, verdict=told, numerics=())
