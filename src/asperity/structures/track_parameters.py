"""What a track is made of: its parameters, each declared once, and what must fit together."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from asperity.arguments import Array, not_negative, require, whole
from asperity.errors import InputError
from asperity.parameters import (
    DAMPING,
    FORCE,
    FREQUENCY,
    LENGTH,
    MASS,
    STIFFNESS,
    Flag,
    Number,
    Quantity,
    checked_parameters,
    in_its_unit,
    keys_of,
    optional_parameter,
    parameter,
    usual_parameter,
)
from asperity.structures.support import MeasuredSleeper, Relaxation, StiffnessTable, keep_as_tuples
from asperity.written_numbers import count_of, rounded

MOST_BAYS = 100
"""Of a cell: waves are kept of each of them, some ten megabytes."""


@dataclass(frozen=True)
class Bays:
    """How each bay of a cell differs: its length, and the support with which it begins.

    All relative to the nominal values of a track; damping goes with stiffness, so that losses stay as they
    are. The mean length is the nominal one.

    Raises
    ------
    InputError
        If there are more than `MOST_BAYS`, not as many values of each, or one that is not positive.
    """

    spacing: tuple[float, ...]
    pad: tuple[float, ...]
    ballast: tuple[float, ...]

    def __post_init__(self) -> None:
        whole("bays of a cell", len(self.spacing), f"1 to {MOST_BAYS}", at_least=1, at_most=MOST_BAYS)
        for each in fields(self):
            values = np.array(getattr(self, each.name))
            what = f"{each.name} of the bays"
            count = f"as many as bays, {len(self.spacing)}"
            require(len(values) == len(self.spacing), what, count_of(len(values), "value"), count)
            if wrong := np.flatnonzero(~((values > 0.0) & np.isfinite(values))).tolist():
                received = f"{rounded(values[wrong[0]])} times the nominal one in bay {wrong[0] + 1}"
                raise InputError(what, received, "above zero", "Lower its scatter, or take another seed.")
        received = f"{np.mean(self.spacing):.6g} times the nominal one"
        allowed = "the nominal one"
        even = np.isclose(np.mean(self.spacing), 1.0, rtol=1e-9)
        require(even, "mean spacing of the bays", received, allowed)
        keep_as_tuples(self, *(each.name for each in fields(self)))

    @classmethod
    def equal(cls, count: int = 1) -> "Bays":
        """Bays that do not differ."""
        return cls(*[(1.0,) * count] * 3)

    @classmethod
    def drawn(
        cls, count: int, *, spacing: float = 0.0, pad: float = 0.0, ballast: float = 0.0, seed: int = 0
    ) -> "Bays":
        """Draw bays from normal distributions, of which these are the standard deviations over the mean.

        Of the lengths the mean is taken out, so that the cell is as long as one of equal bays. The draws of
        one quantity do not depend on the scatter of the others.
        """
        scatters = {"spacing": spacing, "pad": pad, "ballast": ballast}
        drawn = np.random.default_rng(seed).standard_normal((len(scatters), count))
        drawn[0] -= drawn[0].mean()
        return cls(
            *(
                tuple((1.0 + not_negative(f"scatter of the {name}", scatter) * each).tolist())
                for (name, scatter), each in zip(scatters.items(), drawn, strict=True)
            )
        )

    @classmethod
    def listed(cls, spacing: Array, pad: Array, ballast: Array) -> "Bays":
        """Bays one by one (n,), in any unit: of each quantity the mean is taken for the nominal one."""
        return cls(*(tuple((each / each.mean()).tolist()) for each in (spacing, pad, ballast)))

    @property
    def lengths(self) -> Array:
        """Relative lengths (n,)."""
        return np.array(self.spacing)


@dataclass(frozen=True)
class Relaxations:
    """What stands for the loss factors of a track; None where there is none."""

    rail: Relaxation | None = None  # of its bending (and shear) stiffness
    pad: Relaxation | None = None
    under_sleeper_pad: Relaxation | None = None
    ballast: Relaxation | None = None
    sleeper: Relaxation | None = None  # of its bending stiffness
    subgrade: Relaxation | None = None


LAYERS = ("pad", "under_sleeper_pad", "ballast", "subgrade")
"""Springs between the rail and rigid ground, from the rail down."""
_LOSS = Number(at_least=0, at_most=5)
_MASS, _BENDING = MASS, Quantity("N m^2", above=0)
_RAILS = "rails lie between"
_PADS = "pads lie between"
_BALLAST = "ballast lies between"
_SLEEPERS, _GROUND = "sleepers lie between", "the ground lies between"


def _lossy(layer: str, words: str, damping: str, loss: float, lie: str, goes_with: str = "") -> list[Any]:
    """Declare viscous damping and loss factor of a layer."""
    own: dict[str, Any] = {"default": None, "goes_with": goes_with}
    factor = f"loss factor of {words}, instead of {layer}_damping; approximated in time"
    return [
        parameter(DAMPING, damping, f"viscous damping of {words}", f"1e-3 N s/m to 1e9 N s/m: {lie}", **own),
        parameter(_LOSS, loss, factor, **own),
    ]


def _layer(layer: str, words: str, stiffness: str, damping: str, loss: float, lie: str) -> list[Any]:
    """Declare a layer that a track may have: stiffness, viscous damping and loss factor."""
    within = f"1 kN/m to 1 TN/m: {lie}"
    of_stiffness = parameter(STIFFNESS, stiffness, f"stiffness of {words}", within, default=None)
    return [of_stiffness, *_lossy(layer, words, damping, loss, lie, f"{layer}_stiffness")]


_PAD = _lossy("pad", "a pad", "18 kN s/m", 0.15, _PADS)
_BED = _lossy("ballast", "the ballast", "48 kN s/m", 0.4, _BALLAST)
_UNDER_SLEEPER = "under_sleeper_pad", "a pad under half a sleeper", "200 MN/m", "20 kN s/m", 0.2, _PADS
_UNDER_SLEEPER_PAD = _layer(*_UNDER_SLEEPER)
_BELOW = "subgrade", "the ground below the ballast of half a sleeper", "100 MN/m", "60 kN s/m", 0.3, _GROUND
_SUBGRADE = _layer(*_BELOW)
_BENT: dict[str, Any] = {"goes_with": "sleeper_bending_stiffness"}
_DAMPER: dict[str, Any] = {"default": None, "goes_with": "rail_damper_mass"}


@dataclass(frozen=True)
class TrackParameters:
    """Parameters of an `asperity.structures.track.Track`, which says what they are."""

    bending_stiffness: float = parameter(
        _BENDING, "4.7 MN m^2", "bending stiffness of the rail", f"1 kN m^2 to 1 GN m^2: {_RAILS}"
    )
    mass_per_length: float = parameter(
        Quantity("kg/m", above=0), "60 kg/m", "mass of the rail per length", f"1 kg/m to 1000 kg/m: {_RAILS}"
    )
    pad_stiffness: float = parameter(
        STIFFNESS, "300 MN/m", "stiffness of a rail pad", f"1 kN/m to 1 TN/m: {_PADS}"
    )
    sleeper_mass: float = parameter(
        Quantity("kg", at_least=0),
        "150 kg",
        "mass of a sleeper under one rail: half a sleeper",
        "1 kg to 100 t: sleepers lie between",
    )
    ballast_stiffness: float = parameter(
        Quantity("N/m", above=0, infinite=True),
        "150 MN/m",
        "stiffness of the ballast under half a sleeper, or of the boot of a block",
        f"1 kN/m to 1 TN/m: {_BALLAST}",
    )
    sleeper_spacing: float = parameter(
        LENGTH, "0.6 m", "distance of the sleepers", "0.1 m to 10 m: sleepers are as far apart"
    )
    rail_loss_factor: float = parameter(_LOSS, 0.01, "loss factor of the rail", default=0.0)
    pad_damping: float | None = _PAD[0]
    pad_loss_factor: float | None = _PAD[1]
    pad_stiffens: bool = parameter(
        Flag(),
        True,
        "let a pad stiffen over frequency as one that keeps its loss factor must: by the exponent "
        "2/pi arctan pad_loss_factor, from pad_stiffness at 300 Hz",
        default=False,
        goes_with="pad_loss_factor",
    )
    ballast_damping: float | None = _BED[0]
    ballast_loss_factor: float | None = _BED[1]
    shear_stiffness: float | None = optional_parameter(
        FORCE,
        "243 MN",
        "shear stiffness of the rail; with it, the rail is a Timoshenko beam",
        f"1 kN to 1 TN: {_RAILS}",
    )
    rotary_inertia: float | None = optional_parameter(
        Quantity("kg m", above=0),
        "0.24 kg m",
        "rotary inertia of the rail per length",
        f"1e-6 kg m to 1000 kg m: {_RAILS}",
    )
    sleeper_bending_stiffness: float | None = optional_parameter(
        _BENDING,
        "6 MN m^2",
        "bending stiffness of a sleeper; without it, half sleepers are rigid",
        f"1 N m^2 to 1 GN m^2: {_SLEEPERS}",
    )
    sleeper_length: float = usual_parameter(
        LENGTH, "2.6 m", "length of a sleeper that bends", f"0.5 m to 10 m: {_SLEEPERS}", **_BENT
    )
    seat_distance: float = usual_parameter(
        LENGTH,
        "1.5 m",
        "distance of the two rails, middle to middle",
        f"0.2 m to 5 m: {_RAILS}",
        **_BENT,
    )
    sleeper_loss_factor: float | None = optional_parameter(
        Number(at_least=0, at_most=1),
        0.03,
        "loss factor of a sleeper that bends; approximated in time",
        **_BENT,
    )
    under_sleeper_pad_stiffness: float | None = _UNDER_SLEEPER_PAD[0]
    under_sleeper_pad_damping: float | None = _UNDER_SLEEPER_PAD[1]
    under_sleeper_pad_loss_factor: float | None = _UNDER_SLEEPER_PAD[2]
    ballast_mass: float | None = optional_parameter(
        _MASS,
        "300 kg",
        "mass of the ballast that moves with half a sleeper, between ballast and subgrade",
        f"1 kg to 100 t: {_BALLAST}",
        goes_with="subgrade_stiffness",
    )
    subgrade_stiffness: float | None = _SUBGRADE[0]
    subgrade_damping: float | None = _SUBGRADE[1]
    subgrade_loss_factor: float | None = _SUBGRADE[2]
    continuous: bool = parameter(
        Flag(),
        True,
        "spread the supports evenly along the rail, as under an embedded one: sleeper_spacing is the length "
        "that each stands for",
        default=False,
    )
    rail_damper_mass: float | None = optional_parameter(
        _MASS,
        "15 kg",
        "mass of a tuned damper on the rail in the middle of every bay",
        "1 g to 1 t: rail dampers lie between",
    )
    rail_damper_frequency: float | None = parameter(
        FREQUENCY,
        "800 Hz",
        "natural frequency of such a damper on a rail that holds still",
        "1 Hz to 20 kHz: rail dampers lie between",
        **_DAMPER,
    )
    rail_damper_loss_factor: float | None = parameter(
        Number(above=0, at_most=0.9), 0.35, "loss factor of such a damper at its frequency", **_DAMPER
    )
    pad_table: StiffnessTable | None = None
    measured_sleeper: MeasuredSleeper | None = None
    name: str = ""
    sources: tuple[str, ...] = ()
    relaxations: Relaxations | None = None
    bays: Bays | None = None
    opposed: bool = False

    def __post_init__(self) -> None:
        checked_parameters(self)
        for name, key in keys_of(type(self), "").items():
            given = getattr(self, name) != getattr(type(self), name, 0.0)
            if key.goes_with and given and getattr(self, key.goes_with) is None:
                received = in_its_unit(getattr(self, name), key.kind)
                raise InputError(name, received, f"only together with {key.goes_with}")
        for element in LAYERS:
            viscous, factor = (getattr(self, f"{element}_{each}") for each in ("damping", "loss_factor"))
            if viscous is not None and factor is not None:
                received = f"{element}_damping = {viscous:g} N s/m and {element}_loss_factor = {factor:g}"
                remedy = "Remove one: an element is either viscous or has a loss factor."
                raise InputError(f"damping of the {element}", received, "one of them", remedy)
        if (self.shear_stiffness is None) != (self.rotary_inertia is None):
            missing = "rotary_inertia" if self.rotary_inertia is None else "shear_stiffness"
            allowed = "shear_stiffness and rotary_inertia together, or neither (Euler-Bernoulli)"
            raise InputError("Timoshenko rail", f"no {missing}", allowed)
        if self.pad_table is not None and (self.pad_damping, self.pad_loss_factor) != (None, None):
            remedy = "The table has the losses of the pad: remove pad_damping and pad_loss_factor."
            raise InputError("damping of the pad", "one beside pad_table", "one of them", remedy)
        if self.measured_sleeper is not None and self.sleeper_bending_stiffness is not None:
            remedy = "The measured one bends as it does: remove sleeper_bending_stiffness."
            raise InputError("sleeper", "one that was measured and one that bends", "one of them", remedy)
        if self.continuous and self.bays is not None:
            remedy = "Give no scatter, or supports that are not spread along the rail."
            raise InputError("bays that differ", "some on supports that are continuous", "equal bays", remedy)
        if self.sleeper_bending_stiffness is not None and self.seat_distance >= self.sleeper_length:
            allowed = f"less than the length of the sleeper, {self.sleeper_length:g} m"
            raise InputError("sleeper", f"seat_distance = {self.seat_distance:g} m", allowed)
        if self.rail_damper_mass is not None:
            for name in ("rail_damper_frequency", "rail_damper_loss_factor"):
                if getattr(self, name) is None:
                    allowed = "rail_damper_mass with rail_damper_frequency and rail_damper_loss_factor"
                    raise InputError("rail damper", f"no {name}", allowed)
