"""Bodies of masses, springs and dampers: chains above a contact, bogies, carriages on rolling elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import real
from asperity.errors import InputError
from asperity.structures.ball import GRAVITY
from asperity.structures.body import Body, positive_numbers

Array = NDArray[np.float64]


def chain(masses: ArrayLike, stiffnesses: ArrayLike, dampings: ArrayLike, *, load: float = 0.0) -> Body:
    """Masses above one contact, each on the one below: wheelset, bogie share, car-body share.

    Parameters
    ----------
    masses : array_like (n,)
        From the contact upwards, kg.
    stiffnesses, dampings : array_like (n − 1,)
        Of the springs, N/m, and dampers, N s/m, between a mass and the next one above.
    load : float
        Constant force that presses on the uppermost mass, N, beside the weight of all masses; negative where
        it lifts.

    Returns
    -------
    Body
        On one contact; its degrees of freedom are the masses, in their order.

    Raises
    ------
    InputError
        If a mass or stiffness is not positive, a damping negative, a number is missing, or nothing is left
        to press on the contact.
    """
    mass = positive_numbers("masses of the chain (kg)", masses)
    spring = positive_numbers("stiffnesses of the chain (N/m)", stiffnesses, mass.size - 1)
    damper = positive_numbers("dampings of the chain (N s/m)", dampings, mass.size - 1, zero=True)
    stiffness, damping = np.zeros((2, mass.size, mass.size))
    for i in range(mass.size - 1):
        _connect(stiffness, damping, _unit(mass.size, i + 1) - _unit(mass.size, i), spring[i], damper[i])
    pressing = GRAVITY * mass
    pressing[-1] += _load(load)
    return _on(np.zeros(1), _unit(mass.size, 0)[None], mass, damping, stiffness, pressing)


def bogie(
    wheel_mass: float,
    wheelbase: float,
    frame_mass: float,
    frame_inertia: float,
    primary_stiffness: float,
    primary_damping: float,
    *,
    car_body: tuple[float, float, float] | None = None,
    load: float = 0.0,
) -> Body:
    """Two wheels one behind the other, and their share of the frame above, which pitches.

    Parameters
    ----------
    wheel_mass : float
        Unsprung mass of each wheel, kg.
    wheelbase : float
        Distance of the two contacts, m.
    frame_mass, frame_inertia : float
        Of the frame, in its middle: kg, and kg m² about the transverse axis.
    primary_stiffness, primary_damping : float
        Of the suspension of each wheel, N/m and N s/m.
    car_body : (float, float, float), optional
        Mass above the middle of the frame, kg, on a secondary spring, N/m, and damper, N s/m.
    load : float
        Constant force that presses on the car body, or the frame, N, beside the weight of all masses;
        negative where it lifts.

    Returns
    -------
    Body
        On two contacts; its position is that of the rear one. Degrees of freedom: rear wheel, front wheel,
        frame, pitch of the frame (rad, front up), car body.

    Raises
    ------
    InputError
        If a number is not positive (damping may be zero), or nothing is left to press on the contacts.
    """
    numbers = [wheel_mass, wheelbase, frame_mass, frame_inertia, primary_stiffness]
    wheel, base, frame, inertia, spring = positive_numbers(
        "wheel mass, wheelbase, frame mass, frame inertia and primary stiffness", numbers, 5
    )
    damper = positive_numbers("primary damping (N s/m)", [primary_damping], 1, zero=True)[0]
    masses, size = [wheel, wheel, frame, inertia], 4
    if car_body is not None:
        masses, size = [*masses, *positive_numbers("mass of the car body (kg)", car_body[:1], 1)], 5
    stiffness, damping = np.zeros((2, size, size))
    places = np.array([0.0, base])
    for i, place in enumerate(places):
        above = _unit(size, 2) + (place - 0.5 * base) * _unit(size, 3)
        _connect(stiffness, damping, above - _unit(size, i), spring, damper)
    if car_body is not None:
        secondary = positive_numbers("secondary stiffness and damping", car_body[1:], 2, zero=True)
        _connect(stiffness, damping, _unit(size, 4) - _unit(size, 2), *secondary)
    pressing = GRAVITY * np.array(masses)
    pressing[3] = 0.0
    pressing[2 if car_body is None else 4] += _load(load)
    return _on(places, np.eye(size)[:2], np.array(masses), damping, stiffness, pressing)


def carriage(
    mass: float,
    inertia: float,
    places: ArrayLike,
    *,
    centre: float | None = None,
    element_mass: float | None = None,
    upper_stiffness: float | None = None,
    upper_damping: float = 0.0,
    load: float = 0.0,
    load_place: float | None = None,
) -> Body:
    """A rigid carriage that pitches, on rolling elements in a row: the carriage of a linear guide.

    Parameters
    ----------
    mass, inertia : float
        Of the carriage: kg, and kg m² about the transverse axis through its centre of mass.
    places : array_like (c,)
        Of the contacts, ahead of the position of the body, m.
    centre : float, optional
        Place of the centre of mass, m; the middle of the contacts.
    element_mass : float, optional
        Mass of each rolling element, kg, with the contact above it as a spring; without one the carriage
        itself touches at the places.
    upper_stiffness, upper_damping : float, optional
        Of the contact above each element, linearised under its load: N/m and N s/m.
    load : float
        Constant force that presses on the carriage, N, beside all weights; negative where it lifts.
    load_place : float, optional
        Where it presses, m; the centre of mass.

    Returns
    -------
    Body
        On as many contacts as places. Degrees of freedom: the elements, if there are any, the carriage at its
        centre of mass, its pitch (rad, front up).

    Raises
    ------
    InputError
        If a number is not positive (damping may be zero), or the carriage tilts or lifts off.

    Notes
    -----
    Elements move with the carriage: that a rolling ball follows at half its speed, and comes back around, is
    left out.
    """
    heavy, moment = positive_numbers("mass (kg) and inertia (kg m^2) of the carriage", [mass, inertia], 2)
    at = np.atleast_1d(np.asarray(places, dtype=float))
    middle = at.mean() if centre is None else real("centre of mass (m)", centre, "a finite number")
    down = _load(load)
    pressed = middle if load_place is None else real("place of the load (m)", load_place, "a finite number")
    lever = np.stack([np.ones_like(at), at - middle], axis=1)
    moved = np.array([heavy * GRAVITY + down, down * (pressed - middle)])
    if element_mass is None:
        none = np.zeros((2, 2))
        return _on(at, lever, np.array([heavy, moment]), none, none, moved)
    element, spring = positive_numbers(
        "mass (kg) of the elements and stiffness (N/m) above them",
        [element_mass, 0.0 if upper_stiffness is None else upper_stiffness],
        2,
    )
    damper = positive_numbers("damping above the elements (N s/m)", [upper_damping], 1, zero=True)[0]
    size = at.size + 2
    stiffness, damping = np.zeros((2, size, size))
    for i in range(at.size):
        above = np.concatenate([np.zeros(at.size), lever[i]])
        _connect(stiffness, damping, above - _unit(size, i), spring, damper)
    masses = np.concatenate([np.full(at.size, element), [heavy, moment]])
    pressing = np.concatenate([np.full(at.size, element * GRAVITY), moved])
    return _on(at, np.eye(size)[: at.size], masses, damping, stiffness, pressing)


def _connect(stiffness: Array, damping: Array, stretch: Array, spring: float, damper: float) -> None:
    """Put a spring and a damper where the degrees of freedom stretch them by `stretch` (d,) each."""
    stiffness += spring * np.outer(stretch, stretch)
    damping += damper * np.outer(stretch, stretch)


def _on(
    places: Array, contacts: Array, masses: Array, damping: Array, stiffness: Array, pressing: Array
) -> Body:
    """Body that presses on each of its contacts."""
    none, shapes = np.zeros(0), np.zeros((len(places), 0))
    body = Body(np.diag(masses), damping, stiffness, contacts, pressing, places, none, none, shapes)
    least = float(body.static_loads.min())
    if not least > 0.0:
        received = f"a contact under {least:.4g} N"
        raise InputError(
            "load (N)", received, "contacts that are pressed at rest", "Press more, or nearer the middle."
        )
    return body


def _unit(size: int, i: int) -> Array:
    return np.asarray(np.eye(size)[i])


def _load(load: float) -> float:
    return real("load (N)", load, "a finite number")
