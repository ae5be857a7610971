"""What rolls and what it is rolled over, built from the case, and laid out on the contact grid."""

from __future__ import annotations

import math
import warnings

from asperity.contact import Hertz
from asperity.contact.hertz import check_half_space, groove_gap, relative_radius
from asperity.errors import InputError
from asperity.kinds.bodies.case import Bodies
from asperity.reference.materials import Material, contact_modulus
from asperity.scenarios.geometry import Geometry, across_window, geometry, parabola
from asperity.scenarios.scene import Scene
from asperity.scenes.tables import fitted_to, read_modes, read_receptance
from asperity.structures.beam import Beam, SupportedBeam
from asperity.structures.body import GRAVITY, Body, bogie, carriage, chain
from asperity.structures.modal import Modal
from asperity.structures.modal_fit import warn_of_short_band
from asperity.structures.receptance_fit import fit_body
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel


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


MODES_BEYOND = 4.0
"""Modes of a beam are kept up to this multiple of the highest frequency, where the case says nothing."""


def bodies_of(case: Bodies) -> Scene:
    """Build the bodies of a case, and what they roll over."""
    body, count = body_of(case), len(case.body.positions)
    names = {
        f"{name}, body {number}" if count > 1 else name: lever
        for number in range(1, count + 1)
        for name, lever in degrees_of(case).items()
    }
    over, on_track = structure_of(case), case.over == "track"
    middle = case.record_start + 0.5 * case.speed * case.rolled_time
    return Scene(
        over,
        (body,) * count,
        title_of(case),
        points=case.track.points_or(middle) if on_track else (),
        wheel=tread_of(case) if on_track else None,
        positions=case.body.positions,
        sensors=sensors_of(case),
        degrees=names,
        like="wheel-on-rail" if on_track else "ball-on-beam",
    )


def tread_of(case: Bodies) -> Wheel:
    """What touches a rail at each contact, by itself: its mass and its modes."""
    mass, load = case.body.contact_mass, load_of(case)
    if case.body.modes is None:
        return Wheel(mass, load)
    return Wheel(mass, load, *read_modes(case.body.modes))


def degrees_of(case: Bodies) -> dict[str, float]:
    """Degrees of freedom of one body, from its contacts upwards: 1, or the lever of a pitch, m."""
    count, above = len(case.body.places), len(case.body.masses or ())
    lever = 0.5 * case.body.places[-1]
    if case.body.type == "bogie":
        return {"rear wheel": 1.0, "front wheel": 1.0, "frame": 1.0, "frame, pitch at its end": lever}
    if case.body.type == "carriage":
        elements = {f"element {n}": 1.0 for n in range(1, count + 1)}
        return elements | {"carriage": 1.0, "carriage, pitch at its end": lever}
    return {"mass on the contact": 1.0} | {f"mass {n} above": 1.0 for n in range(1, above + 1)}


def sensors_of(case: Bodies) -> tuple[float, ...]:
    """Positions of the accelerometers, m."""
    if case.over == "beam":
        return case.beam.sensor_positions
    return case.structure.sensor_positions if case.over == "structure" else ()


def title_of(case: Bodies) -> str:
    """Say what rolls over what."""
    count, kind = len(case.body.positions), {"mass": "body", "chain": "suspended body"}
    name = kind.get(case.body.type, case.body.type)
    many = {"body": "bodies", "suspended body": "suspended bodies"}.get(name, f"{name}s")
    what = f"a {name}" if count == 1 else f"{count} {many}"
    return f"{what[0].upper()}{what[1:]} over a {case.over}"


def structure_of(case: Bodies) -> Modal | Track | None:
    """Build what is rolled over; None for a plane."""
    if case.over == "beam":
        return _beam(case)
    if case.over == "structure":
        for doubt in case.structure.doubts:
            warnings.warn(doubt, stacklevel=2)
        if case.structure.measured_at is not None:
            warn_of_short_band("structure", case.structure.measured_at, case.numerics.highest_frequency)
        return case.structure.model
    return case.track.model() if case.over == "track" else None


def _beam(case: Bodies) -> Modal:
    """Build the beam: of one span, or on further supports."""
    beam, highest = case.beam, highest_beam_mode(case)
    section = (beam.length, beam.width, beam.height, beam.material)
    if beam.supports is not None:
        return SupportedBeam.rectangular(
            *section, beam.held, loss_factor=beam.loss_factor, highest_frequency=highest
        )
    return Beam.rectangular(
        *section,
        support=beam.support,
        loss_factor=beam.loss_factor,
        highest_frequency=highest,
        suspension_frequency=beam.suspension_frequency,
    )


def body_of(case: Bodies) -> Body:
    """Build one of what rolls, with the resonances of what touches."""
    if case.body.receptance is not None:
        measured = read_receptance(case.body.receptance)
        warn_of_short_band("body", measured[0], case.numerics.highest_frequency)
        with fitted_to(case.body.receptance):
            return fit_body(case.body.contact_mass, load_of(case), *measured)
    body = _rigid_body(case)
    return body if case.body.modes is None else body.with_modes(*read_modes(case.body.modes))


def _rigid_body(case: Bodies) -> Body:
    body, mass = case.body, case.body.contact_mass
    places, above = body.places, list(body.masses or ())
    extra = load_of(case) * len(places) - GRAVITY * (mass * len(places) + sum(above))
    springs, dampers = list(body.springs or ()), list(body.dampers or [0.0] * len(above))
    if body.type == "chain":
        return chain([mass, *above], springs, dampers, load=extra)
    if body.type == "bogie":
        return bogie(mass, places[1], above[0], _inertia(case), springs[0], dampers[0], load=extra)
    if body.type == "carriage":
        return carriage(
            above[0], _inertia(case), places, element_mass=mass,
            upper_stiffness=upper_stiffness(case),
            upper_damping=dampers[0], load=extra,
        )  # fmt: skip
    return Body.rigid(mass, load_of(case))


def _inertia(case: Bodies) -> float:
    """Moment of inertia of what is above, kg m²: as given, or of a bar as long as its contacts are apart."""
    body = case.body
    assert body.masses
    length = body.places[-1] or 2.0 * body.radius
    return body.inertia or body.masses[0] * length**2 / 12.0


def highest_beam_mode(case: Bodies) -> float:
    """Frequency up to which the modes of a beam are kept, Hz."""
    return case.beam.modes_up_to or MODES_BEYOND * case.numerics.highest_frequency


def geometry_of(case: Bodies) -> Geometry:
    """Lay out what rolls on the contact grid, under the static load of its first contact."""
    load = float(bodies_of(case).loads[0])
    return body_geometry(case, load)


def body_geometry(case: Bodies, load: float) -> Geometry:
    """Lay out what rolls on the contact grid, under a load, N.

    In a groove the gap is that of circle in circle, and the half-space is asked for the angle that it fills.
    """
    body, hertz = case.body, smooth_contact(case)
    groove = body.groove_radius
    if groove is None:
        smallest = min(body.radius, body.across, radius_across(case), abs(raceway_radius(case)))
        section = parabola(case.contact, hertz.radius_y)
    else:
        smallest = math.inf  # looked at below
        section = groove_gap(across_window(case.contact), body.across, groove)
        _check_groove(case, load, groove)
    shape = geometry(case.contact, section, hertz, load, smallest_radius=smallest, body="body")
    return shape.within_window()


def _check_groove(case: Bodies, load: float, groove: float) -> None:
    """Hold the contact under the load, and in the highest state given, to the half-space in a groove."""
    hertz, top = smooth_contact(case), case.contact.approaches
    asked = [(hertz.approach(load), f"a working load of {load:.3g} N")]
    if top is not None:
        asked.append((top[-1], f"an approach of {top[-1] * 1e6:.3g} µm"))
    for approach, cause in asked:
        check_half_space(
            hertz.semi_axes(approach),
            case.body.across,
            groove_radius=groove,
            raceway_radius=raceway_radius(case),
            groove_width=case.body.groove_width,
            cause=cause,
        )
