"""Rigid and suspended bodies on their contacts: a ball, a mass, a chain, a bogie, a carriage."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import real, real_array
from asperity.errors import InputError
from asperity.reference.materials import Material

GRAVITY = 9.80665  # m/s^2, standard acceleration of free fall, CGPM 1901


@dataclass(frozen=True)
class Ball:
    """Rigid solid ball.

    Parameters
    ----------
    radius : float
        m.
    material : Material
        Gives the mass.
    load : float, optional
        Constant force that presses the ball down, N; its weight if not given.
    given_mass : float, optional
        Mass, kg, instead of that of a solid ball.

    Raises
    ------
    InputError
        If radius, load or mass is not a finite positive number.

    Examples
    --------
    >>> from asperity import Ball, material
    >>> ball = Ball(25e-3, material("steel"))
    >>> round(ball.mass, 3), round(ball.static_load, 2)  # kg, N
    (0.514, 5.04)
    """

    radius: float
    material: Material
    load: float | None = None
    given_mass: float | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.radius) and self.radius > 0.0):
            raise InputError("ball radius (m)", self.radius, "a finite positive number")
        if self.load is not None and not (np.isfinite(self.load) and self.load > 0.0):
            raise InputError("ball load (N)", self.load, "a finite positive number")
        if self.given_mass is not None and not (np.isfinite(self.given_mass) and self.given_mass > 0.0):
            raise InputError("ball mass (kg)", self.given_mass, "a finite positive number")

    @property
    def mass(self) -> float:
        """Mass, kg."""
        if self.given_mass is not None:
            return self.given_mass
        return 4.0 / 3.0 * np.pi * self.radius**3 * self.material.density

    @property
    def weight(self) -> float:
        """Weight under standard gravity, N."""
        return self.mass * GRAVITY

    @property
    def static_load(self) -> float:
        """The given load, or else the weight, N."""
        return self.weight if self.load is None else self.load


Array = NDArray[np.float64]

CARRIED = 1e-9
"""Share of the pressing forces that may be left uncarried."""


@dataclass(frozen=True, eq=False)
class Body:
    """A linear body with d degrees of freedom y, m or rad, positive upwards, on c contacts.

    M y″ + C y′ + K y = Aᵀ F − p under the contact forces F (c,), and each of its s modes, mass-normalised,
    obeys q″ + 2ζω q′ + ω² q = Φᵀ F beside it. At its contacts it is displaced, upwards, by A y + Φ q.
    """

    mass: Array  # M, (d, d), kg or kg m²
    damping: Array  # C, (d, d), N s/m …
    stiffness: Array  # K, (d, d), N/m …; singular of a body that nothing but its contacts holds
    contacts: Array  # A, (c, d)
    pressing: Array  # p, (d,), constant forces that press the body down, N or N m
    places: Array  # (c,), of its contacts along the path, ahead of the body's position, m
    natural_frequencies: Array  # (s,), of its modes, Hz
    damping_ratios: Array  # (s,)
    shapes: Array  # Φ, (c, s), kg^(−1/2)
    fit_error: float = 0.0
    """Of one that was fitted to receptances: root mean square of the differences of level, dB."""

    def __post_init__(self) -> None:
        c, d = self.contacts.shape
        s = len(self.natural_frequencies)
        shapes = {
            "mass": (d, d),
            "damping": (d, d),
            "stiffness": (d, d),
            "pressing": (d,),
            "places": (c,),
            "damping_ratios": (s,),
            "shapes": (c, s),
        }
        for name, shape in shapes.items():
            value = getattr(self, name)
            if value.shape != shape or not np.isfinite(value).all():
                raise InputError(
                    f"{name} of a body", f"shape {value.shape}", f"finite numbers of shape {shape}"
                )
        if np.linalg.eigvalsh(self.mass).min() <= 0.0:
            raise InputError("masses of a body", "one without inertia", "positive masses")
        carried = self.contacts.T @ self.static_loads - self.stiffness @ self._hung - self.pressing
        if np.abs(carried).max(initial=0.0) > CARRIED * np.abs(self.pressing).max(initial=1.0):
            remedy = "Give it more contacts, or springs that hold it."
            raise InputError(
                "contacts of a body", "too few: it falls or tilts", "a body that is held", remedy
            )

    @classmethod
    def rigid(cls, mass: float, load: float) -> Body:
        """A free rigid mass, kg, on one contact under a constant load, N, weight included."""
        one, none = np.ones((1, 1)), np.zeros((1, 1))
        empty = np.zeros(0)
        return cls(mass * one, none, none, one, np.array([load]), np.zeros(1), empty, empty, np.zeros((1, 0)))

    @classmethod
    def from_modes(
        cls,
        mass: float,
        load: float,
        frequencies: ArrayLike,
        damping_ratios: ArrayLike,
        modal_masses: ArrayLike,
    ) -> Body:
        """Mass with resonances on one contact under a load, N, weight included, as `Wheel.from_modes`."""
        return cls.rigid(mass, load).with_modes(frequencies, damping_ratios, modal_masses)

    def with_modes(self, frequencies: ArrayLike, damping_ratios: ArrayLike, modal_masses: ArrayLike) -> Body:
        """Let what touches at each contact have resonances of its own, the same at each: those of a wheel.

        Parameters
        ----------
        frequencies : array_like (s,)
            Undamped natural frequencies, Hz.
        damping_ratios : array_like (s,)
            Above 0 and below 1.
        modal_masses : array_like (s,)
            With the shape at the contact scaled to one, kg.

        Returns
        -------
        Body
            With s modes more for each contact.

        Raises
        ------
        InputError
            If the lists differ in length, or a number is out of range.
        """
        natural = positive_numbers("natural frequencies of the modes (Hz)", frequencies)
        ratio = positive_numbers("damping ratios of the modes", damping_ratios, natural.size)
        shape = positive_numbers("modal masses (kg)", modal_masses, natural.size) ** -0.5
        if natural.size and ratio.max() >= 1.0:
            raise InputError("damping ratios of the modes", float(ratio.max()), "above 0 and below 1")
        each = np.eye(len(self.places))
        return replace(
            self,
            natural_frequencies=np.concatenate([self.natural_frequencies, np.tile(natural, len(each))]),
            damping_ratios=np.concatenate([self.damping_ratios, np.tile(ratio, len(each))]),
            shapes=np.hstack([self.shapes, np.kron(each, shape)]),
        )

    def receptance(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Displacements of the contacts per harmonic force at each, upwards (n, c, c), m/N, e^{+iωt}.

        Frequencies in Hz, above zero.
        """
        f = np.atleast_1d(np.asarray(frequency, dtype=float))
        if not (f > 0.0).all():
            raise InputError(
                "frequency (Hz)", float(f.min()), "above 0: a free body has no static receptance"
            )
        omega = 2.0 * np.pi * f[:, None, None]
        dynamic = self.stiffness + 1j * omega * self.damping - omega**2 * self.mass
        moving = self.contacts @ np.linalg.solve(
            dynamic, np.broadcast_to(self.contacts.T, (f.size, *self.contacts.T.shape))
        )
        natural, omega = 2.0 * np.pi * self.natural_frequencies, omega[:, 0]
        answer = 1.0 / (natural**2 - omega**2 + 2j * self.damping_ratios * natural * omega)
        return np.asarray(moving + np.einsum("cs,ns,ds->ncd", self.shapes, answer, self.shapes))

    @property
    def static_loads(self) -> Array:
        """Forces of the contacts at rest (c,), N, on a rigid plane; of several answers the most even."""
        return self._statics[1]

    @property
    def _hung(self) -> Array:
        return self._statics[0]

    @property
    def _statics(self) -> tuple[Array, Array]:
        """Displacements y (d,) and forces (c,) with A y = 0 and Aᵀ F − K y = p, of least squares."""
        c, d = self.contacts.shape
        # forces and lengths are as different as stiffnesses
        scale = max(float(np.abs(self.stiffness).max()), 1.0)
        matrix = np.block([[-self.stiffness / scale, self.contacts.T], [self.contacts, np.zeros((c, c))]])
        solution = np.linalg.lstsq(matrix, np.concatenate([self.pressing, np.zeros(c)]), rcond=None)[0]
        return solution[:d] / scale, solution[d:]


def positive_numbers(what: str, given: ArrayLike, count: int | None = None, *, zero: bool = False) -> Array:
    """Take a list of finite numbers above zero, or not below it; as many as `count`, if that is given."""
    allowed = f"finite numbers, {'0 and more' if zero else 'above 0'}"
    values = np.atleast_1d(real_array(what, given, allowed)) if np.size(given) else np.zeros(0)
    if values.ndim > 1 or (count is not None and values.size != count):
        raise InputError(what, f"{values.size} numbers", f"{count}" if count is not None else "a list")
    wrong = ~(np.isfinite(values) & ((values >= 0.0) if zero else (values > 0.0)))
    if wrong.any():
        raise InputError(what, float(values[wrong][0]), allowed)
    return values


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
