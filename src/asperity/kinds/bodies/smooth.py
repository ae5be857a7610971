"""The contact of the smooth bodies of a case."""

from __future__ import annotations

import math

from asperity.contact import Hertz
from asperity.contact.hertz import relative_radius
from asperity.errors import InputError
from asperity.kinds.bodies.case import Bodies
from asperity.reference.materials import Material, contact_modulus
from asperity.structures.body import GRAVITY


def smooth_contact(case: Bodies) -> Hertz:
    """Contact of the smooth bodies, by their relative curvatures along and across the path."""
    body, modulus = case.body, contact_modulus(case.body.material, over_material(case))
    along = relative_radius(body.radius, raceway_radius(case), what="body.radius and body.raceway_radius (m)")
    across = relative_radius(
        body.across, radius_across(case), what="body.transverse_radius and body.groove_radius (m)"
    )
    return Hertz(modulus, along, across)


def radius_across(case: Bodies) -> float:
    """Radius of what is rolled over across the path, m: negative of a groove, infinite where flat."""
    if case.body.groove_radius is not None:
        return -case.body.groove_radius
    return case.track.rail_head_radius if case.over == "track" else math.inf


def raceway_radius(case: Bodies) -> float:
    """Radius of what is rolled over along the path, m: positive where it bulges, infinite where straight."""
    radius = case.body.raceway_radius
    if radius is None:
        return math.inf
    return radius if case.body.raceway == "inner" else -radius


def load_of(case: Bodies) -> float:
    """Static force of each contact, N: as given, or the weights, evened out."""
    body = case.body
    above = sum(body.masses or ()) / len(body.places)
    return body.load or GRAVITY * (body.contact_mass + above)


def upper_load(case: Bodies) -> float:
    """What the contact above each element of a carriage carries, N."""
    above = load_of(case) - GRAVITY * case.body.contact_mass
    if not above > 0.0:
        raise InputError("body.load", f"{above:.4g} N above each element", "a carriage that presses on them")
    return above


def upper_stiffness(case: Bodies) -> float:
    """Stiffness, N/m, of the contact above each element of a carriage: as given, or shaped as that below."""
    if case.body.springs:
        return case.body.springs[0]
    hertz = smooth_contact(case)
    return hertz.tangent_stiffness(hertz.approach(upper_load(case)))


def static_stiffness(case: Bodies) -> float:
    """What a mass on its contact feels at rest, N/m: the smooth contact, and the one above of an element."""
    hertz = smooth_contact(case)
    below = hertz.tangent_stiffness(hertz.approach(load_of(case)))
    return below + (upper_stiffness(case) if case.body.type == "carriage" else 0.0)


def over_material(case: Bodies) -> Material:
    """Material of what is rolled over."""
    if case.over == "beam":
        return case.beam.material
    return case.track.material if case.over == "track" else case.structure.material
