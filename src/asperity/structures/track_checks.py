"""What values the parameters of a track may take."""

from __future__ import annotations

from typing import TYPE_CHECKING

from asperity.arguments import real
from asperity.errors import InputError

if TYPE_CHECKING:
    from asperity.structures.track import Track


def check_track(track: Track) -> None:
    """Refuse parameters that no track has; see `asperity.structures.track.Track`."""
    for what, value, needed in (
        ("bending stiffness of the rail (N m^2)", track.bending_stiffness, True),
        ("mass per length of the rail (kg/m)", track.mass_per_length, True),
        ("pad stiffness (N/m)", track.pad_stiffness, True),
        ("ballast stiffness (N/m)", track.ballast_stiffness, True),
        ("sleeper spacing (m)", track.sleeper_spacing, True),
        ("shear stiffness of the rail (N)", track.shear_stiffness, False),
        ("rotary inertia of the rail (kg m)", track.rotary_inertia, False),
    ):
        if needed or value is not None:
            real(what, value, "a finite positive number", above=0.0)
    for what, value, needed in (
        ("sleeper mass (kg)", track.sleeper_mass, True),
        ("rail loss factor", track.rail_loss_factor, True),
        ("pad damping (N s/m)", track.pad_damping, False),
        ("pad loss factor", track.pad_loss_factor, False),
        ("ballast damping (N s/m)", track.ballast_damping, False),
        ("ballast loss factor", track.ballast_loss_factor, False),
    ):
        if needed or value is not None:
            real(what, value, "a finite number, zero or more", at_least=0.0)
    _refuse_doubles(track)


def _refuse_doubles(track: Track) -> None:
    for element, viscous, factor in (
        ("pad", track.pad_damping, track.pad_loss_factor),
        ("ballast", track.ballast_damping, track.ballast_loss_factor),
    ):
        if viscous is not None and factor is not None:
            raise InputError(
                f"damping of the {element}",
                f"{element}_damping = {viscous:g} N s/m and {element}_loss_factor = {factor:g}",
                "one of them",
                "Remove one: an element is either viscous or has a loss factor.",
            )
    if (track.shear_stiffness is None) != (track.rotary_inertia is None):
        missing = "rotary_inertia" if track.rotary_inertia is None else "shear_stiffness"
        raise InputError(
            "Timoshenko rail",
            f"no {missing}",
            "shear_stiffness and rotary_inertia together, or neither (Euler-Bernoulli)",
        )
