"""The result of a wheel-on-rail case, laid out as labelled groups."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from functools import partial

import xarray

from asperity.kinds.wheel_on_rail import schema
from asperity.kinds.wheel_on_rail.bodies import Bodies, square_transfer
from asperity.kinds.wheel_on_rail.compute import Computed
from asperity.kinds.wheel_on_rail.labels import findings_of_labels
from asperity.kinds.wheel_on_rail.losses import (
    LossFactorError,
    described_losses,
    error_of_losses,
    findings_of_losses,
    warn_of_loss_factors,
)
from asperity.kinds.wheel_on_rail.sound import pass_by_group, warn_of_silence
from asperity.kinds.wheel_on_rail.spectra import spectra_group, track_group
from asperity.reference.cnossos import CITATION
from asperity.scenarios.contact_group import contact_group
from asperity.scenarios.surface_group import surface_group
from asperity.scenarios.tree import assembled, rolling_group
from asperity.scenarios.validity import choice_of, findings, verdict, warn_of_findings
from asperity.structures.rail_poles import RailPoles


def layout(
    computed: Computed, caught: list[warnings.WarningMessage], *, brief: bool = False
) -> xarray.DataTree:
    """Lay out what was computed, as scenario, surface, track, contact, rolling and spectra.

    With units and provenance. `caught` are the warnings met on the way; those of laying out may still be
    added to it. In brief without what only a report shows: what the path is like, and the choice of a law
    where nothing depends on it.
    """
    spectra, losses = spectra_group(computed), error_of_losses(computed)
    transfer = partial(square_transfer, Bodies(computed.wheel, computed.track))
    choice = choice_of(computed.chain, transfer, brief=brief)
    found = [*findings(computed.chain, choice), *findings_of_losses(losses)]
    if schema.SOUND_POWER_LEVEL.name in spectra:
        found += findings_of_labels(computed.case)
    warn_of_findings(found)
    warn_of_silence(computed.case)
    warn_of_loss_factors(losses)
    groups = {
        "/surface": surface_group(computed.chain, brief=brief),
        "/track": track_group(computed),
        "/contact": contact_group(computed.chain, found),
        "/rolling": _rolling(computed),
        "/spectra": spectra,
        "/pass_by": pass_by_group(computed.case, spectra),
    }
    return assembled(
        computed.chain,
        groups,
        caught,
        title=f"Wheel on rail at {computed.case.speed:.3g} m/s",
        verdict=verdict(computed.chain, spectra, found, "wheel", _sound_power(spectra), choice),
        numerics=_numerics(computed, losses),
        citations=(*computed.track.sources, CITATION),
        choice=choice,
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


def _sound_power(spectra: xarray.Dataset) -> xarray.DataArray | None:
    level = spectra.get(schema.SOUND_POWER_LEVEL_A.name)
    return None if level is None else level.sel(source="total")


def _rolling(computed: Computed) -> xarray.Dataset:
    stack = computed.chain.stacked
    moved, velocity = computed.points
    return rolling_group(
        computed.chain,
        {
            schema.ROLLING_POINT: computed.case.point_positions,
            schema.RAIL_DISPLACEMENT: stack("over_displacement"),
            schema.WHEEL_DISPLACEMENT: stack("rolling_displacement"),
            schema.POINT_DISPLACEMENT: moved,
            schema.POINT_VELOCITY: velocity,
        },
    )
