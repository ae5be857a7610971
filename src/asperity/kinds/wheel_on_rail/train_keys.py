"""The train that passes: its axles and its length."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated

from asperity.config.form import Section, key, optional
from asperity.config.values import Length, Number, Position
from asperity.errors import InputError
from asperity.units import written

if TYPE_CHECKING:
    from asperity.radiation.pass_by import Passage


class VehicleKeys(Section):
    """The vehicle that passes a receiver beside the track."""

    vehicle_length: Length | None = optional(
        "26.4 m",
        "length of the vehicle over its buffers, from which the pass-by time follows",
        "half a mean distance of the axles beyond the outer ones",
        "0.1 m to 1 km: vehicles lie between",
    )
    vehicles: Annotated[int, Number(at_least=1, at_most=100, whole=True)] = key(
        1, "number of such vehicles, one behind the other", goes_with="vehicle_length"
    )

    def passing(self, axles: tuple[float, ...], speed: float) -> Passage:
        """The train at a speed, m/s, each vehicle with these axles behind its first, m."""
        from asperity.radiation.pass_by import Passage

        length = self.vehicle_length
        if length is None:
            return Passage(axles, speed)
        train = tuple(number * length + axle for number in range(self.vehicles) for axle in axles)
        return Passage(train, speed, self.vehicles * length)

    def problem_of_length(self, axles: tuple[float, ...], what: str) -> Iterator[InputError]:
        """A vehicle is longer than its axles, m behind the first, are apart."""
        length = self.vehicle_length
        if length is not None and length <= axles[-1]:
            allowed = f"more than that over its axles, {written(axles[-1], 'm', 'm')}"
            yield InputError(what, written(length, "m", "m"), allowed)


class TrainKeys(VehicleKeys):
    """The axles that pass a receiver beside the track, each with two wheels on two rails."""

    axle_positions: tuple[Position, ...] | None = optional(
        ["0 m", "2.5 m", "19 m", "21.5 m"],
        "axles of the vehicle that passes, behind its first; each has two wheels",
        "one axle",
        "0 m to 1 km: trains are shorter",
    )
    wheelbase: Length | None = optional(
        "2.5 m",
        "distance of the two axles of a bogie that passes, instead of axle_positions",
        "one axle",
        "0.1 m to 100 m: axles are as far apart",
    )

    @property
    def axles_of_vehicle(self) -> tuple[float, ...]:
        """Places of the axles of one vehicle behind its first, m."""
        if self.axle_positions is not None:
            return self.axle_positions
        return (0.0,) if self.wheelbase is None else (0.0, self.wheelbase)

    def passage(self, speed: float) -> Passage:
        """All axles of the train, passing at a speed, m/s."""
        return self.passing(self.axles_of_vehicle, speed)

    def problems_of_train(self) -> Iterator[InputError]:
        """One description of the axles, one behind the other, and a vehicle that is longer than they are."""
        if {"axle_positions", "wheelbase"} <= self.model_fields_set:
            yield InputError("", "both axle_positions and wheelbase", "one of them", "Remove one.")
        axles = self.axles_of_vehicle
        if not axles or axles[0] != 0.0 or any(b <= a for a, b in pairwise(axles)):
            received = ", ".join(written(axle, "m", "m") for axle in axles) or "an empty list"
            yield InputError("axle_positions", received, "positions that rise from 0 m, the first axle")
        else:
            yield from self.problem_of_length(axles, "vehicle_length")
