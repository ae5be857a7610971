"""Named sections of railway wheels. None is a product: they are drawn here with main dimensions as usual."""

Dimensions = dict[str, float]

_HUB: Dimensions = {"bore_radius": 0.0925, "hub_radius": 0.135, "hub_width": 0.175}
_RIM: Dimensions = {"rim_thickness": 0.065, "rim_width": 0.135, "fillet_radius": 0.025}
_TREAD: Dimensions = {"flange_height": 0.028, "flange_thickness": 0.032, "tread_slope": 0.05}

SECTIONS: dict[str, Dimensions] = {
    # a freight wheel: hub aside of the rim, the web bent on its way
    "curved-web": {
        **_HUB, **_RIM, **_TREAD,
        "hub_offset": 0.045, "web_bend": 0.0, "web_thickness": 0.026, "web_thickness_rim": 0.022,
    },
    # a wheel for disc brakes on the axle: a plane web under the middle of the rim
    "straight-web": {
        **_HUB, **_RIM, **_TREAD,
        "hub_offset": 0.0, "web_bend": 0.0, "web_thickness": 0.030, "web_thickness_rim": 0.025,
    },
    # a wheel for tread brakes, whose web gives way to heat: twice bent
    "bent-web": {
        **_HUB, **_RIM, **_TREAD,
        "hub_offset": 0.010, "web_bend": 0.045, "web_thickness": 0.024, "web_thickness_rim": 0.020,
    },
}  # fmt: skip
"""Dimensions in m, by the keywords of `asperity.structures.outline.WheelSection`."""
