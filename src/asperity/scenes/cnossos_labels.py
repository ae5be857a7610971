"""Which track and which wheel CNOSSOS-EU means for a case, and where they are not those of the case."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, Protocol

from asperity.errors import Grade
from asperity.reference.cnossos import PAD_CLASSES, nearest_pad_class, nearest_wheel_transfer
from asperity.scenarios.validity import Finding
from asperity.structures.track import Track

MONO_BLOCK = (110.0, 210.0)
"""Mass of half a mono-block sleeper of concrete, kg: 140 to 177.5 kg are published for models of tracks; half
of one of wood, or of two blocks, is lighter."""
CLOSE_DIAMETER = 0.15
"""By which part the wheel may be larger or smaller than the label says."""


class CaseOnTrack(Protocol):
    """A case that rolls over a track, as far as its sound is concerned."""

    @property
    def noise(self) -> Any:
        """How vibration, and force, become sound."""

    @property
    def tread(self) -> Any:
        """What touches the rail: the section of its modes, or of its receptance."""

    @property
    def tread_name(self) -> str:
        """Name of that section."""

    @property
    def rolling_radius(self) -> float:
        """Radius of what rolls, m."""

    @property
    def axles(self) -> int:
        """Number of axles whose sound power is added; each has two wheels, on two rails."""

    @property
    def passage(self) -> Any:
        """The axles that pass a receiver beside the track."""

    def track_model(self) -> Track:
        """Build the track."""


def track_label(case: CaseOnTrack) -> str:
    """Class of rail pads: that which the case names, or that nearest to its pads."""
    return case.noise.track_pad or nearest_pad_class(case.track_model().pad_stiffness)


def wheel_label(case: CaseOnTrack) -> str:
    """Diameter of the wheel: that which the case names, or that nearest to its wheel."""
    return case.noise.wheel_transfer or nearest_wheel_transfer(2.0 * case.rolling_radius)


def findings_of_labels(case: CaseOnTrack) -> list[Finding]:
    """Hold track and wheel of a case to those of which CNOSSOS-EU knows the sound power."""
    return [*_pads(case), *_sleepers(case), *_wheel(case)]


def _pads(case: CaseOnTrack) -> Iterator[Finding]:
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


def _sleepers(case: CaseOnTrack) -> Iterator[Finding]:
    mass, (least, most) = case.track_model().sleeper_mass, MONO_BLOCK
    if not least <= mass <= most:
        remedy = "Its tables here are those of mono-block sleepers; take the sound power from the vibration."
        yield _finding(
            "mass of half a sleeper",
            f"{mass:.4g} kg",
            f"{least:g} to {most:g} kg, those of one block of concrete",
            remedy,
        )


def _wheel(case: CaseOnTrack) -> Iterator[Finding]:
    label, diameter = wheel_label(case), 2.0 * case.rolling_radius
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
