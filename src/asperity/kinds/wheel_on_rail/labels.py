"""Which track and which wheel CNOSSOS-EU means for a case, and where they are not those of the case."""

from __future__ import annotations

import math
from collections.abc import Iterator

from asperity.errors import Grade
from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.reference.cnossos import PAD_CLASSES, nearest_pad_class, nearest_wheel_transfer
from asperity.scenarios.validity import Finding

MONO_BLOCK = (110.0, 210.0)
"""Mass of half a mono-block sleeper of concrete, kg: 140 to 177.5 kg are published for models of tracks; half
of one of wood, or of two blocks, is lighter."""
CLOSE_DIAMETER = 0.15
"""By which part the wheel may be larger or smaller than the label says."""


def track_label(case: WheelOnRail) -> str:
    """Class of rail pads: that which the case names, or that nearest to its pads."""
    return case.noise.track_pad or nearest_pad_class(case.track_model().pad_stiffness)


def wheel_label(case: WheelOnRail) -> str:
    """Diameter of the wheel: that which the case names, or that nearest to its wheel."""
    return case.noise.wheel_transfer or nearest_wheel_transfer(2.0 * case.wheel.radius)


def findings_of_labels(case: WheelOnRail) -> list[Finding]:
    """Hold track and wheel of a case to those of which CNOSSOS-EU knows the sound power."""
    return [*_pads(case), *_sleepers(case), *_wheel(case)]


def _pads(case: WheelOnRail) -> Iterator[Finding]:
    label, stiffness = track_label(case), case.track_model().pad_stiffness
    least, most = PAD_CLASSES[label]
    if least <= stiffness <= most:
        return
    fitting = nearest_pad_class(stiffness)
    if fitting == label:
        remedy = "It has no class for such pads; take the sound power from the vibration."
    else:
        remedy = f'Set noise.track_pad = "{fitting}", or leave it out.'
    yield _finding(
        "dynamic stiffness of the rail pads",
        f"{stiffness / 1e6:.4g} MN/m",
        f'{least / 1e6:g} to {most / 1e6:g} MN/m, those of the class "{label}"',
        remedy,
    )


def _sleepers(case: WheelOnRail) -> Iterator[Finding]:
    mass, (least, most) = case.track_model().sleeper_mass, MONO_BLOCK
    if not least <= mass <= most:
        remedy = "Its tables here are those of mono-block sleepers; take the sound power from the vibration."
        yield _finding(
            "mass of half a sleeper",
            f"{mass:.4g} kg",
            f"{least:g} to {most:g} kg, those of one block of concrete",
            remedy,
        )


def _wheel(case: WheelOnRail) -> Iterator[Finding]:
    label, diameter = wheel_label(case), 2.0 * case.wheel.radius
    named = 1e-3 * float(label.split()[0])
    if abs(math.log(diameter / named)) <= math.log1p(CLOSE_DIAMETER):
        return
    fitting = nearest_wheel_transfer(diameter)
    if fitting == label:
        remedy = "It has no class for such a wheel."
    else:
        remedy = f'Set noise.wheel_transfer = "{fitting}", or leave it out.'
    yield _finding("diameter of the wheel", f"{1e3 * diameter:.4g} mm", f"within 15 % of {label}", remedy)


def _finding(quantity: str, value: str, limit: str, remedy: str) -> Finding:
    meaning = "CNOSSOS-EU's sound power is that of another track or wheel."
    return Finding(f"{quantity}, for CNOSSOS-EU", value, limit, Grade.WARNING, meaning, remedy, "", ())
