"""Sizes that machines and surfaces have, key by key: what is given beyond them is doubted."""

import math
import re
from collections.abc import Iterator, Mapping

from asperity.case.any_case import AnyCase
from asperity.parameters import Quantity
from asperity.units import limits_in, quantity, written
from asperity.written_numbers import rounded

OF_ANYTHING = {
    "hurst": "0.05 to 1: textures that are rough on all scales have",
    "anisotropy": "0.02 to 50: textures are drawn out by",
    "contact.friction": "0.02 to 1.5: solids, dry or wet, have",
    "creep.kinetic": "0.05 to 1: friction falls to a share of",
    "contact.samples": "1 to 1000: means are taken of",
    "creep.wear": "1e-6 mm^3/J to 0.05 mm^3/J: wheels and rails wear by",
}
"""By a key with its section, or by its name in any: the least and the most, and the words before them."""
OF_TRAINS = {
    "surface.rms": "50 nm to 300 um: rails, smooth and corrugated, have",
    "surface.corrugation": "300 nm to 3 mm: corrugated rails have",
    "surface.joint_length": "10 mm to 20 m: dips at joints have",
    "wheel.flat_depth": "20 um to 10 mm: flats have",
    "wheel.flat_length": "3 mm to 0.5 m: flats have",
    "wheel.distance": "0.5 m to 30 m: wheels of bogies and carriages are apart by",
    "noise.receiver_height": "0.1 m to 30 m: receivers stand at",
    "noise.flow_resistivity": "5 kPa s/m^2 to 50 MPa s/m^2: grounds, from grass to asphalt, have",
    "noise.measured_maximum_level": "20 dB to 150 dB: trains that pass are heard with",
    "noise.measured_equivalent_level": "20 dB to 150 dB: trains that pass are heard with",
    "noise.measured_exposure_level": "20 dB to 150 dB: trains that pass are heard with",
    "track.rail_damper_mass": "0.5 kg to 100 kg: dampers on rails weigh",
}
"""The same of what rolls over a track."""
OF_BEARINGS = {
    "lubricant.viscosity_40": "2 mm^2/s to 5000 mm^2/s: oils have at 40 °C",
    "lubricant.viscosity_100": "1 mm^2/s to 500 mm^2/s: oils have at 100 °C",
    "lubricant.damping_time": "0.1 us to 1 ms: films damp by",
    "fault.depth": "0.5 um to 10 mm: dents, pits and spalls have",
}
"""The same of bearings."""
UNIT = "Is the unit right?"


def unusual(case: AnyCase, usual: Mapping[str, str], **called: str) -> Iterator[str]:
    """Say of each key what is unusual about it; some sections are `called` otherwise here."""
    for title in case.section_names:
        section = getattr(case, title)
        plain = re.sub(r"\[\d+\]$", "", title)
        plain = called.get(plain, plain)
        for name in section.keys:
            within = usual.get(f"{plain}.{name}") or usual.get(name)
            if within:
                yield from _beyond(f"{title}.{name}", getattr(section, name), section.keys[name].one, within)


def _beyond(key: str, value: object, kind: object, within: str) -> Iterator[str]:
    low, high, those = limits_in(within)
    unit = kind.dimension if isinstance(kind, Quantity) else ""
    least, most = (quantity(each, unit) if unit else float(each) for each in (low, high))
    for each in value if isinstance(value, tuple) else (value,):
        if isinstance(each, int | float) and math.isfinite(each) and not least <= each <= most:
            size = written(each, unit, low.partition(" ")[2], exactly=False) if unit else rounded(each)
            yield f"{key} = {size}: {those} {low} to {high}." + f" {UNIT}" * bool(unit)
