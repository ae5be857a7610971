"""How a case turns vibration, and force, into sound power."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from asperity.config import values
from asperity.config.form import Section, key, optional
from asperity.config.tables import problems_of_table
from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.train_keys import TrainKeys, VehicleKeys
from asperity.reference.cnossos import PAD_CLASSES, WHEEL_TRANSFER
from asperity.scenes.tables import read_ratios

RatiosFile = Annotated[Path | NDArray[np.float64], values.File(columns=2)]


class RadiationKeys(Section):
    """What radiates, for the sound power from vibration, and the labels of CNOSSOS-EU for that beside it."""

    rail_foot_width: values.Length = key(
        "150 mm", "width of the rail's foot", "10 mm to 1 m: rails lie between"
    )
    rail_head_width: values.Length = key(
        "72 mm", "width of the rail's head", "10 mm to 1 m: rails lie between"
    )
    rail_radiation: RatiosFile | None = optional(
        "rail_radiation.csv",
        "table of the rail's radiation ratio: frequency (Hz), ratio of its sound power per length to "
        "impedance of air, twice the width of its foot and mean square velocity",
        "that of a section with the widths of foot and head",
    )
    sleeper_length: values.Length = key(
        "2.6 m", "length of a whole sleeper", "0.1 m to 10 m: sleepers lie between"
    )
    sleeper_width: values.Length = key(
        "0.25 m",
        "width of a sleeper that radiates: of its top, with its sloping sides",
        "10 mm to 10 m: sleepers lie between",
    )
    wheel_width: values.Length = key(
        "135 mm", "width of the wheel's tread", "10 mm to 1 m: wheels lie between"
    )
    track_pad: Annotated[str, values.Choice(tuple(PAD_CLASSES))] | None = optional(
        "medium",
        "rail pads of CNOSSOS-EU's transfer to the sound power of the track, on mono-block sleepers",
        "those nearest to track.pad_stiffness",
    )
    wheel_transfer: Annotated[str, values.Choice(tuple(WHEEL_TRANSFER))] | None = optional(
        "920 mm",
        "wheel diameter of CNOSSOS-EU's transfer to the sound power of the wheel",
        "that nearest to twice the rolling radius",
    )


class NoiseCase(RadiationKeys, TrainKeys):
    """The sound of a wheel, and of a train of such."""

    axles: Annotated[int, values.Number(at_least=1, at_most=1000, whole=True)] = key(
        1, "number of axles whose sound power is added; each has two wheels, on two rails"
    )

    def problems(self) -> Iterator[InputError]:
        """A train that can pass, and a table of ratios that can be read."""
        yield from self.problems_of_train()
        yield from problems_of_table(self, "rail_radiation", read_ratios)


class NoiseOfBodies(RadiationKeys, VehicleKeys):
    """The sound of all that rolls: each contact is that of an axle with two wheels, on two rails."""

    def problems(self) -> Iterator[InputError]:
        """A table of ratios that can be read."""
        yield from problems_of_table(self, "rail_radiation", read_ratios)
