"""The wheel and the track of a case."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import scipy
from numpy.typing import NDArray

from asperity.contact import Hertz
from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.reference.materials import contact_modulus
from asperity.scenarios.geometry import Geometry, across_window, geometry
from asperity.scenarios.records import read_section
from asperity.scenarios.scene import Scene
from asperity.scenes import schema
from asperity.scenes.tables import fitted_to, read_modes, read_receptance
from asperity.structures.modal_fit import REACH, warn_of_short_band
from asperity.structures.wheel import Wheel
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.levelling import level


def bodies_of(case: WheelOnRail) -> Scene:
    """Build wheel and track of a case."""
    wheel, title = wheel_of(case), f"Wheel on rail at {case.speed:.3g} m/s"
    return Scene(
        case.track_model(),
        (wheel.body,),
        title,
        points=case.point_positions,
        degrees={"wheel": 1.0},
        displacements=(schema.RAIL_DISPLACEMENT, schema.WHEEL_DISPLACEMENT),
        like=case.kind,
        wheel=wheel,
        scattered=case.numerics.kernel == "scatter",
        most_poles=case.numerics.poles,
    )


def wheel_of(case: WheelOnRail) -> Wheel:
    """Build the wheel of a case: rigid, or with the modes or the receptance that the case names."""
    section = case.wheel
    if section.modes is not None:
        return Wheel(section.mass, section.load, *read_modes(section.modes))
    if section.receptance is not None:
        highest = case.numerics.highest_frequency
        measured = read_receptance(section.receptance)
        warn_of_short_band("wheel", measured[0], highest)
        with fitted_to(section.receptance):
            return Wheel.from_receptance(
                section.mass, section.load, *measured, highest_frequency=REACH * highest
            )
    return Wheel(section.mass, section.load)


_FINE = 10
"""Points per cell on which the lowest point of a measured gap is looked for."""


def geometry_of(case: WheelOnRail) -> Geometry:
    """Lay wheel and rail of a case out on the contact grid.

    Where a section is measured, Hertz's contact is that of the paraboloid fitted to the gap over the width of
    the contact. Such a section must cover the window, and the bodies touch in its middle.
    """
    modulus = contact_modulus(case.wheel.material, case.track.material)
    y = across_window(case.contact)
    tread = _section(case.wheel.profile, case.wheel.transverse_radius, "wheel.profile")
    head = _section(case.track.rail_profile, case.track.rail_head_radius, "track.rail_profile")
    section = _lowest_in_the_middle(tread, head, y)
    if case.wheel.profile is None and case.track.rail_profile is None:
        radius = 1.0 / (1.0 / case.wheel.transverse_radius + 1.0 / case.track.rail_head_radius)
    else:
        radius = _osculating(section, y, case, modulus)
    smallest = min(case.wheel.radius, case.wheel.transverse_radius, case.track.rail_head_radius, radius)
    hertz = Hertz(modulus, case.wheel.radius, radius)
    shape = geometry(case.contact, section, hertz, case.wheel.load, smallest_radius=smallest, body="wheel")
    return shape.within_window()


class _Section:
    """Depth below the middle of one body across the rail, m."""

    def __init__(self, radius: float, measured: Profile | None, key: str) -> None:
        self.curvature, self.key = 1.0 / radius, key
        self.half_width, self._spline = np.inf, None
        if measured is not None:
            y = (np.arange(len(measured.heights)) - 0.5 * (len(measured.heights) - 1)) * measured.spacing
            self._spline = scipy.interpolate.make_interp_spline(y, -measured.heights, k=3)
            self.half_width = float(y[-1])

    def at(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        if self._spline is None:
            return 0.5 * self.curvature * y**2
        if np.abs(y).max() > self.half_width:
            raise InputError(
                self.key,
                f"a section {2e3 * self.half_width:.4g} mm wide",
                f"at least {2e3 * np.abs(y).max():.4g} mm, the window about the point of contact",
                "Measure a wider section, or shrink contact.window.",
            )
        return np.asarray(self._spline(y))


def _section(measured: Path | Profile | None, radius: float, key: str) -> _Section:
    if measured is None:
        return _Section(radius, None, key)
    return _Section(radius, level(read_section(measured, key)), key)


def _lowest_in_the_middle(tread: _Section, head: _Section, y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Gap across, m, moved so that the bodies first touch in the middle of the window."""
    reach = min(tread.half_width, head.half_width)
    middle = 0.0
    if np.isfinite(reach) and reach > y[-1]:
        fine = np.linspace(y[-1] - reach, reach - y[-1], _FINE * len(y))
        lowest = int(np.argmin(tread.at(fine) + head.at(fine)))
        around = (float(fine[max(lowest - 1, 0)]), float(fine[min(lowest + 1, len(fine) - 1)]))
        found = scipy.optimize.minimize_scalar(
            lambda at: float((tread.at(np.array([at])) + head.at(np.array([at])))[0]),
            bounds=around,
            method="bounded",
            options={"xatol": 1e-7},
        )
        middle = float(found.x)
    gap = tread.at(y + middle) + head.at(y + middle)
    gap = gap - gap[len(y) // 2]
    if gap.min() < -1e-9:
        raise InputError(
            "wheel.profile and track.rail_profile",
            "bodies that touch outside the window's middle",
            "sections that touch in one place, convex against each other",
        )
    return np.maximum(gap, 0.0)


def _osculating(
    section: NDArray[np.float64], y: NDArray[np.float64], case: WheelOnRail, modulus: float
) -> float:
    """Radius of the parabola fitted over the width of the contact, m."""
    half = 0.5 * y[-1]
    radius = np.inf
    for _ in range(10):
        inside = np.abs(y) <= max(half, 3 * case.contact.spacing)
        curvature = np.polynomial.polynomial.polyfit(y[inside], section[inside], 2)[2]
        if curvature <= 0.0:
            raise InputError(
                "wheel.profile and track.rail_profile",
                "bodies that fit each other across the rail",
                "a gap that opens on both sides",
            )
        radius = 0.5 / curvature
        hertz = Hertz(modulus, case.wheel.radius, radius)
        half = hertz.semi_axes(hertz.approach(case.wheel.load))[1]
    return float(radius)
