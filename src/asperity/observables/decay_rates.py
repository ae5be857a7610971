"""Decay rates of a rail by EN 15461, vertical and lateral, in one-third octaves."""

import numpy as np

from asperity.case.any_case import AnyCase
from asperity.case.in_memory import name_of
from asperity.case.measured import read_rails
from asperity.case.rolled_over import TrackKeys
from asperity.case.scene import Case
from asperity.case.tables import TableSource
from asperity.observables.observable import Measured, Observable, Predictable, Values
from asperity.scenes.measured import LINES, HammerTest, lateral_hammer_test

SEARCHED = 12
"""Lines in a band while a fit searches."""
VERTICAL, LATERAL = "vertical decay rate", "lateral decay rate"
LAYERS = ("pad", "ballast")
_UNITS = "dB/m"


def keys_of_track(case: AnyCase) -> TrackKeys | None:
    """The track that is rolled over, if one is."""
    over = getattr(case, "rolled_over", None)
    return over if isinstance(over, TrackKeys) else None


def no_track(case: AnyCase) -> str:
    """What a case lacks whose rail cannot be struck."""
    return "" if keys_of_track(case) is not None else f"no track: it is of kind {case.kind}"


def no_side(case: AnyCase) -> str:
    """What a case lacks whose rail cannot be struck sideways."""
    return no_track(case) or ("" if "sideways" in case.section_names else "no motion sideways")


def supports(case: Case) -> tuple[str, ...]:
    """Stiffness and loss of pads and ballast, as the case has them, and the loss of the rail."""
    keys = case.track
    found: list[str] = []
    for layer in LAYERS:
        if layer == "pad" and keys.pad_table is not None:
            continue
        if not np.isfinite(getattr(keys.model(), f"{layer}_stiffness")):
            continue
        losses = (f"{layer}_{each}" for each in ("damping", "loss_factor"))
        found += [f"track.{layer}_stiffness", *(f"track.{each}" for each in losses if keys.is_active(each))]
    return (*found, "track.rail_loss_factor")


def _vertical(trial: Predictable, measured: Measured) -> Values:
    lines = LINES if trial.fine else SEARCHED
    return HammerTest.of_track(trial.case.track.model(), measured.at, lines).decay_rate


def _lateral(trial: Predictable, measured: Measured) -> Values:
    keys = trial.case.track
    sideways = trial.case.sideways.model(keys.model().regular, keys.rail_foot_width)
    return lateral_hammer_test(sideways, measured.at, LINES if trial.fine else SEARCHED)


def _sideways(case: Case) -> tuple[str, ...]:
    losses = (each for each in supports(case) if not each.endswith("_stiffness"))
    return ("sideways.pad_stiffness", "sideways.ballast_stiffness", *losses)


def _read(table: TableSource) -> list[Measured]:
    """Both directions of a table of decay rates, each rail as a measurement of its own."""
    centres, rates = read_rails(table)
    return [
        Measured(what, centres, each, source=name_of(table))
        for what, rails in zip((VERTICAL, LATERAL), rates.transpose(1, 2, 0), strict=False)
        for each in rails
    ]


OBSERVABLES = (
    Observable(VERTICAL, _UNITS, "frequency (Hz)", 10.0, 1.0, no_track, _vertical, supports,
               r"vertical.*decay|decay.*vertical|decay rate|dB ?/ ?m\b|15461", _read,
               keys=("track.decay_rates",)),
    Observable(LATERAL, _UNITS, "frequency (Hz)", 10.0, 1.0, no_side, _lateral, _sideways,
               r"lateral.*decay|decay.*lateral"),
)  # fmt: skip
