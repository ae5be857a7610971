"""What a rail sideways is made of: its parameters, each declared once, and what must fit together."""

import math
from dataclasses import dataclass
from typing import Any

from asperity.arguments import positive
from asperity.errors import InputError
from asperity.parameters import (
    LENGTH,
    LENGTH_OR_ZERO,
    STIFFNESS,
    Number,
    Quantity,
    checked_parameters,
    in_its_unit,
    keys_of,
    optional_parameter,
    parameter,
    usual_parameter,
)
from asperity.structures.track import Track

# UIC 60 as in the program rolland: E = 210 GPa, G = 80.769 GPa, A = 76.7 cm², I_z = 512.7 cm⁴, J = 221.2 cm⁴,
# I_p = 3550 cm⁴, lateral κ = 0.538, centre of twist 33 mm below the centroid, foot 81 mm below it
YOUNG = 210e9
SHEAR = 80.769e9
_AREA = 76.7e-4
DENSITY = 60.2 / 76.7e-4
_PADS, _RAILS = "pads lie between", "rails lie between"
_STIFF, _HEAVY = f"100 N m^2 to 1 GN m^2: {_RAILS}", f"1e-6 kg m to 1000 kg m: {_RAILS}"
_LONG = f"1 mm to 1 m: {_RAILS}"
_BENDS: dict[str, Any] = {"goes_with": "web_thickness"}
_SECTION = (
    *("bending_stiffness", "shear_stiffness", "rotary_inertia", "torsional_stiffness", "polar_inertia"),
    *("head_height", "foot_depth", "centroid_height"),
)
_WEB = 16.5e-3
"""Thickness of the web of UIC 60, m."""
_NEAR = 0.01
"""By which the mass of a rail may differ from that of UIC 60: tables print 60 to 60.3 kg/m."""


@dataclass(frozen=True)
class LateralParameters:
    """Parameters of an `asperity.structures.lateral_rail.LateralTrack`, which says what they are."""

    track: Track
    pad_stiffness: float | None = optional_parameter(
        STIFFNESS, "100 MN/m", "lateral stiffness of a rail pad, which loses as vertically",
        f"1 kN/m to 1 TN/m: {_PADS}", otherwise="a third of the vertical one",
    )  # fmt: skip
    pad_roll_stiffness: float | None = optional_parameter(
        Quantity("N m", above=0), "560 kN m",
        "stiffness of a rail pad against roll of the rail, per rad, which loses as vertically",
        f"1 N m to 1 GN m: {_PADS}", otherwise="that of an even pad as wide as the rail's foot",
    )  # fmt: skip
    ballast_stiffness: float | None = optional_parameter(
        STIFFNESS, "150 MN/m",
        "lateral stiffness of the ballast under half a sleeper, which loses as vertically",
        "1 kN/m to 1 TN/m: ballast lies between", otherwise="the vertical one",
    )  # fmt: skip
    bending_stiffness: float = parameter(
        Quantity("N m^2", above=0), "1.08 MN m^2", "lateral bending stiffness of the rail", _STIFF,
        default=YOUNG * 5.127e-6,
    )  # fmt: skip
    shear_stiffness: float = parameter(
        Quantity("N", above=0, infinite=True), "333 MN",
        'its lateral shear stiffness, "inf" for Euler-Bernoulli', f"1 kN to 1 TN: {_RAILS}",
        default=SHEAR * _AREA * 0.538,
    )  # fmt: skip
    rotary_inertia: float = parameter(
        Quantity("kg m", at_least=0), "0.04 kg m", "its rotary inertia per length in lateral bending", _HEAVY,
        default=DENSITY * 5.127e-6,
    )  # fmt: skip
    torsional_stiffness: float = parameter(
        Quantity("N m^2", above=0), "179 kN m^2", "torsional stiffness of the rail, G J", _STIFF,
        default=SHEAR * 2.212e-6,
    )  # fmt: skip
    polar_inertia: float = parameter(
        Quantity("kg m", above=0), "0.28 kg m", "its polar inertia per length about its centroid", _HEAVY,
        default=DENSITY * 3.55e-5,
    )  # fmt: skip
    head_height: float = usual_parameter(
        LENGTH, "124 mm", "height of the top of the rail above its centre of twist", _LONG,
    )  # fmt: skip
    foot_depth: float = usual_parameter(LENGTH_OR_ZERO, "48 mm", "depth of its bottom below that", _LONG)
    centroid_height: float = usual_parameter(
        Quantity("m"), "33 mm", "height of its centroid above that", f"-1 m to 1 m: {_RAILS}"
    )
    web_thickness: float | None = optional_parameter(
        Quantity("m", above=0, infinite=True), "16.5 mm",
        "thickness of the web of the rail: with it the web bends across the rail, between head and foot, "
        'each of which bends and twists by itself; "inf" for a section that keeps its form',
        _LONG, otherwise="16.5 mm of a UIC 60 rail; any other section keeps its form",
    )  # fmt: skip
    web_height: float = usual_parameter(
        LENGTH, "89.5 mm", "height of the web, from the foot to the head", _LONG, **_BENDS,
    )  # fmt: skip
    web_depth: float = usual_parameter(
        LENGTH_OR_ZERO, "16.5 mm", "depth of the lower end of the web below the centre of twist",
        _LONG, **_BENDS,
    )  # fmt: skip
    head_centroid: float = usual_parameter(
        LENGTH, "99 mm", "height of the centroid of the head above the centre of twist",
        _LONG, **_BENDS,
    )  # fmt: skip
    foot_centroid: float = usual_parameter(
        LENGTH, "37 mm", "depth of the centroid of the foot below the centre of twist", _LONG,
        **_BENDS,
    )  # fmt: skip
    foot_torsion_share: float = usual_parameter(
        Number(at_least=0.01, at_most=0.99), 0.28,
        "share of the foot in the torsional stiffness of the rail, of which the head has the rest", **_BENDS,
    )  # fmt: skip
    foot_width: float = 0.15

    def __post_init__(self) -> None:
        checked_parameters(self)
        positive("width of the rail's foot (m)", self.foot_width)
        for name, key in keys_of(type(self), "").items():
            given = getattr(self, name) != getattr(type(self), name)
            if key.goes_with and given and getattr(self, key.goes_with) in (None, math.inf):
                received = in_its_unit(getattr(self, name), key.kind)
                raise InputError(name, received, f"only together with {key.goes_with}")

    @property
    def web(self) -> float | None:
        """Thickness of the web that bends, m, as given or of UIC 60; None of a section that keeps its form.

        A rail is a UIC 60 where no value of its section is another, and its mass is near.
        """
        if self.web_thickness is not None:
            return self.web_thickness if math.isfinite(self.web_thickness) else None
        own = all(getattr(self, name) == getattr(type(self), name) for name in _SECTION)
        near = abs(self.track.mass_per_length / (DENSITY * _AREA) - 1.0) < _NEAR
        return _WEB if own and near else None
