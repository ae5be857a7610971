"""Section of a railway wheel by its main dimensions: hub, web, rim, tread and flange, and its outline."""

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, one_of, positive, require
from asperity.parameters import Number, Quantity, parameter
from asperity.reference.wheels import SECTIONS

BACK = 0.070
"""Distance of the running circle from the back of the flange, m."""
_LENGTH, _WITHIN = Quantity("m", above=0), "1 mm to 1 m: wheels lie between"
_OFFSET, _SIDE = Quantity("m"), "-0.5 m to 0.5 m: wheels are narrower"
_POINTS = 41
"""Points along each side of the web."""


@dataclass(frozen=True)
class WheelSection:
    """Hub, web and rim of a wheel of a radius that is given beside it.

    Axial places count from the running circle, positive away from the flange, whose back is 70 mm from it.
    The middle of the web goes smoothly from that of the hub to that of the rim, and bends between them.

    Parameters
    ----------
    bore_radius, hub_radius, hub_width, hub_offset : float
        Radii of the seat on the axle and of the hub, its width, and by how much its middle stands outside
        that of the rim, m.
    web_thickness, web_thickness_rim, web_bend, fillet_radius : float
        Thickness of the web at hub and rim, by how much it bends outwards, and the radius of its fillets, m.
    rim_thickness, rim_width, flange_height, flange_thickness : float
        Of rim and flange, m.
    tread_slope : float
        By how much the radius of the tread falls per length outwards.

    Raises
    ------
    InputError
        Of `outline`, if hub, web and rim do not fit into the radius.

    Examples
    --------
    >>> from asperity import WheelSection
    >>> section = WheelSection.named("straight-web", rim_thickness=0.07)
    >>> outline = section.outline(0.46)  # radius and axial place, m
    >>> float(outline[:, 0].min())
    0.0925
    """

    bore_radius: float = parameter(
        _LENGTH, "92.5 mm", "radius of the seat on the axle, where the wheel is held", _WITHIN
    )
    hub_radius: float = parameter(_LENGTH, "135 mm", "radius of the hub", _WITHIN)
    hub_width: float = parameter(_LENGTH, "175 mm", "width of the hub along the axle", _WITHIN)
    hub_offset: float = parameter(
        _OFFSET, "45 mm", "by how much the hub's middle stands outside that of the rim", _SIDE
    )
    web_thickness: float = parameter(_LENGTH, "28 mm", "thickness of the web at the hub", _WITHIN)
    web_thickness_rim: float = parameter(_LENGTH, "22 mm", "thickness of the web at the rim", _WITHIN)
    web_bend: float = parameter(
        _OFFSET, "20 mm", "by how much the web bends outwards in its middle, beside its way to the rim", _SIDE
    )
    fillet_radius: float = parameter(
        Quantity("m", at_least=0), "25 mm", "radius of the fillets between web, hub and rim", _WITHIN
    )
    rim_thickness: float = parameter(_LENGTH, "65 mm", "thickness of the rim at the running circle", _WITHIN)
    rim_width: float = parameter(_LENGTH, "135 mm", "width of the rim with the flange", _WITHIN)
    flange_height: float = parameter(
        Quantity("m", at_least=0), "28 mm", "height of the flange, 0 m without one", _WITHIN
    )
    flange_thickness: float = parameter(_LENGTH, "32 mm", "thickness of the flange", _WITHIN)
    tread_slope: float = parameter(
        Number(at_least=0, at_most=0.5), 0.05, "by how much the tread's radius falls per length outwards"
    )

    @classmethod
    def named(cls, name: str, **changes: float) -> "WheelSection":
        """One of the named sections, with other dimensions where they are given.

        Raises
        ------
        InputError
            If there is none of this name.
        """
        return cls(**SECTIONS[one_of("wheel section", name, SECTIONS)] | changes)

    def outline(self, radius: float) -> Array:
        """Outline (n, 2), radius and axial place, m, of a wheel of a radius at its running circle, m."""
        rim, inside = positive("radius of the wheel (m)", radius) - self.rim_thickness, self.rim_width - BACK
        what, allowed = "section of the wheel", "bore, hub and rim one outside the other"
        received = f"radii of {self.bore_radius:g}, {self.hub_radius:g} and, inside the rim, {rim:g} m"
        require(self.bore_radius < self.hub_radius < rim, what, received, allowed)
        allowed = "a tread as wide as the running circle and the flange need"
        slim = 1.5 * self.flange_thickness < BACK and inside > 0.0
        require(slim, what, f"a rim of {self.rim_width:g} m", allowed, f"Its back is {BACK:g} m inside.")
        middle = 0.5 * self.rim_width - BACK
        share = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, _POINTS))
        at = self.hub_radius + share * (rim - self.hub_radius)
        web = middle + self.hub_offset * (1.0 - share**2 * (3.0 - 2.0 * share))
        web = web + self.web_bend * 16.0 * (share * (1.0 - share)) ** 2
        half = 0.5 * (self.web_thickness + share * (self.web_thickness_rim - self.web_thickness))
        half = half + _fillet(np.minimum(at - self.hub_radius, rim - at), self.fillet_radius)
        hub = middle + self.hub_offset + 0.5 * self.hub_width * np.array([-1.0, 1.0])
        narrow = hub[0] < web[0] - half[0] and 2.0 * half[-1] < self.rim_width
        require(narrow, what, "a web wider than hub or rim", "a web narrower than both")
        root, height = -BACK + 1.5 * self.flange_thickness, self.flange_height
        flange = [
            (radius - self.tread_slope * root, root),
            (radius + height, -BACK + 0.7 * self.flange_thickness),
            (radius + height, -BACK + 0.3 * self.flange_thickness),
            (radius + 0.6 * height, -BACK),
        ]
        if height == 0.0:
            flange = [(radius + self.tread_slope * BACK, -BACK)]
        tread = [(radius - self.tread_slope * inside, inside), (radius, 0.0)]
        return np.vstack(
            [
                [(self.bore_radius, hub[0]), (self.bore_radius, hub[1]), (self.hub_radius, hub[1])],
                np.stack([at, web + half], axis=1),
                [(rim, inside), *tread, *flange, (rim, -BACK)],
                np.stack([at, web - half], axis=1)[::-1],
                [(self.hub_radius, hub[0])],
            ]
        )


def _fillet(distance: Array, radius: float) -> Array:
    """By how much a quarter of a circle reaches out at distances from the face that it meets, m."""
    away = np.clip(radius - distance, 0.0, radius)
    return radius - np.sqrt(radius**2 - away**2)
