"""Decay rates of a rail by EN 15461, vertical and lateral, in one-third octaves."""

from pathlib import Path

import numpy as np

from asperity.arguments import Array
from asperity.case.any_case import AnyCase
from asperity.case.measured import read_decay_rates
from asperity.case.rolled_over import TrackKeys
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


def supports(case: AnyCase) -> tuple[str, ...]:
    """Stiffness and loss of pads and ballast, as the case has them, and the loss of the rail."""
    keys = keys_of_track(case)
    assert keys is not None
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
    keys = keys_of_track(trial.case)
    assert keys is not None
    lines = LINES if trial.fine else SEARCHED
    return HammerTest.of_track(keys.model(), measured.at, lines).decay_rate


def _lateral(trial: Predictable, measured: Measured) -> Values:
    keys = keys_of_track(trial.case)
    assert keys is not None
    sideways = getattr(trial.case, "sideways").model(keys.model().regular, keys.rail_foot_width)  # noqa: B009
    return lateral_hammer_test(sideways, measured.at, LINES if trial.fine else SEARCHED)


def _sideways(case: AnyCase) -> tuple[str, ...]:
    losses = (each for each in supports(case) if not each.endswith("_stiffness"))
    return ("sideways.pad_stiffness", "sideways.ballast_stiffness", *losses)


def _read(path: Path) -> list[Measured]:
    """Both directions of a table of decay rates."""
    centres, vertical, lateral = read_decay_rates(path)
    found = [Measured(VERTICAL, centres, vertical, source=path.name)]
    return found + ([] if lateral is None else [Measured(LATERAL, centres, lateral, source=path.name)])


def rates_beside(case: AnyCase) -> list[Measured]:
    """What the case says was measured on its track."""
    keys = keys_of_track(case)
    if keys is None or keys.decay_rates is None:
        return []
    table: Path | Array = keys.decay_rates
    centres, vertical, lateral = read_decay_rates(table)
    source = table.name if isinstance(table, Path) else "track.decay_rates"
    found = [Measured(VERTICAL, centres, vertical, source=source)]
    return found + ([] if lateral is None else [Measured(LATERAL, centres, lateral, source=source)])


OBSERVABLES = (
    Observable(VERTICAL, _UNITS, "frequency (Hz)", 10.0, 1.0, no_track, _vertical, supports,
               r"vertical.*decay|decay.*vertical|decay rate|dB ?/ ?m\b|15461", _read,
               key="track.decay_rates"),
    Observable(LATERAL, _UNITS, "frequency (Hz)", 10.0, 1.0, no_side, _lateral, _sideways,
               r"lateral.*decay|decay.*lateral", key="track.decay_rates"),
)  # fmt: skip
