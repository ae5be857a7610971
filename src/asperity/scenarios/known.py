"""What is known of a result before anything has rolled: enough for many figures of its report."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import xarray

from asperity.scenarios.chain import Chain
from asperity.scenarios.contact_group import contact_before
from asperity.scenarios.surface_group import surface_group
from asperity.scenarios.tree import scenario_group


def told_ahead(
    chain: Chain[Any], ahead: Callable[[xarray.DataTree], None], own: Mapping[str, xarray.Dataset]
) -> Chain[Any]:
    """Tell what is known, with the kind's own groups, what takes longest the last; the chain with it."""
    known = {"/scenario": scenario_group(chain.case), "/contact": contact_before(chain), **own}
    ahead(xarray.DataTree.from_dict(known))
    known["/surface"] = surface_group(chain)
    ahead(xarray.DataTree.from_dict(known))
    return replace(chain, known=known)
