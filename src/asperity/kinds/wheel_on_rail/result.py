"""The result of a wheel-on-rail case, laid out as labelled groups."""

from __future__ import annotations

import warnings
from collections.abc import Iterable

import xarray

from asperity.kinds.wheel_on_rail.compute import Computed
from asperity.kinds.wheel_on_rail.loss_factors import LossFactorError, warn_of_loss_factors
from asperity.kinds.wheel_on_rail.losses import described_losses, error_of_losses
from asperity.kinds.wheel_on_rail.spectra import point_coordinate, spectra_group
from asperity.kinds.wheel_on_rail.track_group import track_group
from asperity.reference.cnossos import CITATION
from asperity.results import variable
from asperity.scenarios.contact_group import contact_group
from asperity.scenarios.surface_group import surface_group
from asperity.scenarios.tree import assembled, law_coordinate, loss_variables
from asperity.scenarios.validity import findings, warn_of
from asperity.scenarios.verdict import verdict
from asperity.structures.rail_poles import RailPoles


def layout(computed: Computed, caught: list[warnings.WarningMessage]) -> xarray.DataTree:
    """Lay out what was computed, with units and provenance.

    Parameters
    ----------
    computed : Computed
        Textures, track, reduction and runs.
    caught : list of WarningMessage
        Warnings met on the way; those of laying out may still be added to it.

    Returns
    -------
    xarray.DataTree
        Groups scenario, surface, track, contact, rolling, spectra.
    """
    spectra, losses = spectra_group(computed), error_of_losses(computed)
    found = findings(computed.chain)
    warn_of(found)
    warn_of_loss_factors(losses)
    groups = {
        "/surface": surface_group(computed.chain),
        "/track": track_group(computed, losses),
        "/contact": contact_group(computed.chain, found),
        "/rolling": _rolling(computed),
        "/spectra": spectra,
    }
    return assembled(
        computed.chain,
        groups,
        caught,
        title=f"Wheel on rail at {computed.case.speed:.3g} m/s",
        verdict=verdict(computed.chain, spectra, found, "wheel"),
        numerics=_numerics(computed, losses),
        citations=(*computed.track.sources, CITATION),
    )


def _numerics(computed: Computed, losses: LossFactorError) -> Iterable[tuple[str, str]]:
    kernel, rail = computed.kernel, computed.rail
    yield "start positions of the moving kernel", f"{kernel.weights.shape[0]} in a bay"
    yield "length of the moving kernel", f"{kernel.lag[-1]:.3g} s, {kernel.weights.shape[1]} steps"
    if isinstance(rail, RailPoles):
        yield "track in time", f"{rail.count} poles"
        yield "error of the fitted poles, relative", f"{rail.fit_error:.1e}"
    else:
        yield "track in time", "scattered from the moving kernel"
    yield from described_losses(losses, computed.case.wheel.load)


def _rolling(computed: Computed) -> xarray.Dataset:
    chain, stack = computed.chain, computed.chain.stacked
    run = next(iter(chain.runs.values()))
    by_time, by_point = ("law", "time"), ("law", "point", "time")
    moved, velocity = computed.points
    variables = {
        "law": law_coordinate(chain),
        "point": point_coordinate(computed),
        "time": variable("time", run.time, "s", "time since the run-in"),
        "position": variable("time", run.position, "m", "position of the contact, from a sleeper"),
        "contact_force": variable(by_time, stack("contact_force"), "N", "contact force"),
        "relative_displacement": variable(
            by_time, stack("relative_displacement"), "m", "approach of the mean surfaces, positive closing"
        ),
        "rail_displacement": variable(
            by_time, stack("rail_displacement"), "m", "displacement of the rail under the wheel, downwards"
        ),
        "wheel_displacement": variable(
            by_time, stack("wheel_displacement"), "m", "displacement of the wheel, positive downwards"
        ),
        "point_displacement": variable(
            by_point, moved, "m", "displacement of the rail at a point passed by, positive downwards"
        ),
        "point_velocity": variable(
            by_point, velocity, "m/s", "velocity of the rail at a point passed by, positive downwards"
        ),
    }
    return xarray.Dataset(variables | loss_variables(chain))
