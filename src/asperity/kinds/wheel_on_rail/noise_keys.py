"""How a case turns vibration, and force, into sound power."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, PlainValidator

from asperity.config.form import key
from asperity.config.keys import Choice, File, Length, Number
from asperity.config.tables import problems_of_table
from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.tables import read_ratios
from asperity.kinds.wheel_on_rail.train_keys import TrainKeys
from asperity.reference.cnossos import PAD_CLASSES, WHEEL_TRANSFER

RatiosFile = Annotated[Path | NDArray[np.float64], PlainValidator(File(columns=2))]


class NoiseCase(TrainKeys):
    """What radiates, for the sound power from vibration, and the labels of CNOSSOS-EU for that beside it."""

    axles: Annotated[int, BeforeValidator(Number(at_least=1, at_most=1000, whole=True))] = key(
        1, "number of axles whose sound power is added; each has two wheels, on two rails"
    )
    rail_foot_width: Length = key(
        "150 mm", "width of the rail's foot", within=("10 mm", "1 m", "rails lie between")
    )
    rail_head_width: Length = key(
        "72 mm", "width of the rail's head", within=("10 mm", "1 m", "rails lie between")
    )
    rail_radiation: RatiosFile | None = key(
        None,
        "table of the rail's radiation ratio: frequency (Hz), ratio of its sound power per length to "
        "impedance of air, twice the width of its foot and mean square velocity",
        otherwise="that of a section with the widths of foot and head",
        example='"rail_radiation.csv"',
    )
    sleeper_length: Length = key(
        "2.6 m", "length of a whole sleeper", within=("0.1 m", "10 m", "sleepers lie between")
    )
    sleeper_width: Length = key(
        "0.25 m",
        "width of a sleeper that radiates: of its top, with its sloping sides",
        within=("10 mm", "10 m", "sleepers lie between"),
    )
    wheel_width: Length = key(
        "135 mm", "width of the wheel's tread", within=("10 mm", "1 m", "wheels lie between")
    )
    track_pad: Annotated[str, BeforeValidator(Choice(tuple(PAD_CLASSES)))] | None = key(
        None,
        "rail pads of CNOSSOS-EU's transfer to the sound power of the track, on mono-block sleepers",
        otherwise="those nearest to track.pad_stiffness",
        example='"medium"',
    )
    wheel_transfer: Annotated[str, BeforeValidator(Choice(tuple(WHEEL_TRANSFER)))] | None = key(
        None,
        "wheel diameter of CNOSSOS-EU's transfer to the sound power of the wheel",
        otherwise="that nearest to twice wheel.radius",
        example='"920 mm"',
    )

    def problems(self) -> Iterator[InputError]:
        """A table of ratios that can be read."""
        yield from self.problems_of_train()
        yield from problems_of_table(self, "rail_radiation", read_ratios)
