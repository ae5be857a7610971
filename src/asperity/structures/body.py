"""Bodies on their contacts: a rigid mass, a wheel with resonances, a chain, a carriage or bogie."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, as_row, finite_array, positive
from asperity.errors import InputError
from asperity.written_numbers import in_newtons

GRAVITY = 9.80665  # m/s^2, standard acceleration of free fall, CGPM 1901


CARRIED = 1e-9
"""Share of the pressing forces that may be left uncarried."""


def no_modes() -> Array:
    """Frequencies, damping ratios or masses of what is rigid."""
    return np.zeros(0)


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
    natural_frequencies: Array = field(default_factory=no_modes)  # (s,), of its modes, Hz
    damping_ratios: Array = field(default_factory=no_modes)  # (s,)
    shapes: Array = field(default_factory=no_modes)  # Φ, (c, s), kg^(−1/2)
    fit_error: float = 0.0
    """Of one that was fitted to receptances: root mean square of the differences of level, dB."""

    def __post_init__(self) -> None:
        c, d = self.contacts.shape
        s = len(self.natural_frequencies)
        if not s:
            object.__setattr__(self, "shapes", np.zeros((c, 0)))
        shapes = {"mass": (d, d), "damping": (d, d), "stiffness": (d, d), "pressing": (d,), "places": (c,)}
        for name, shape in (shapes | {"damping_ratios": (s,), "shapes": (c, s)}).items():
            value = getattr(self, name)
            if value.shape != shape or not np.isfinite(value).all():
                allowed = f"finite numbers of shape {shape}"
                raise InputError(f"{name} of a body", f"shape {value.shape}", allowed)
        if np.linalg.eigvalsh(self.mass).min() <= 0.0:
            raise InputError("masses of a body", "one without inertia", "positive masses")
        hung, loads = self._statics
        carried = self.contacts.T @ loads - self.stiffness @ hung - self.pressing
        if np.abs(carried).max(initial=0.0) > CARRIED * np.abs(self.pressing).max(initial=1.0):
            remedy = "Give it more contacts, or springs that hold it."
            what = "contacts of a body"
            received = "too few: it falls or tilts"
            raise InputError(what, received, "a body that is held", remedy)

    @classmethod
    def rigid(cls, mass: float, load: float) -> Body:
        """A free rigid mass, kg, on one contact under a constant load, N, weight included."""
        none = np.zeros((1, 1))
        return cls(np.array([[mass]]), none, none, np.ones((1, 1)), np.array([load]), np.zeros(1))

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
        natural, ratio, mass = resonances(frequencies, damping_ratios, modal_masses)
        count = len(self.places)
        return replace(
            self,
            natural_frequencies=np.concatenate([self.natural_frequencies, np.tile(natural, count)]),
            damping_ratios=np.concatenate([self.damping_ratios, np.tile(ratio, count)]),
            shapes=np.hstack([self.shapes, np.kron(np.eye(count), mass**-0.5)]),
        )

    def receptance(self, frequency: ArrayLike) -> Complex:
        """Displacements of the contacts per harmonic force at each, upwards (n, c, c), m/N, e^{+iωt}.

        Frequencies in Hz, above zero.
        """
        f = as_row(frequency)
        _refuse_rest(f)
        omega = 2.0 * np.pi * f[:, None, None]
        dynamic = self.stiffness + 1j * omega * self.damping - omega**2 * self.mass
        moved = np.linalg.solve(dynamic, np.broadcast_to(self.contacts.T, (f.size, *self.contacts.T.shape)))
        from asperity.structures.modal import modal_answers  # a case knows bodies without compiled code

        answers = modal_answers(f, self.natural_frequencies, self.damping_ratios)
        flexible = np.einsum("cs,ns,ds->ncd", self.shapes, answers, self.shapes)
        return self.contacts @ moved + flexible

    @property
    def static_loads(self) -> Array:
        """Forces of the contacts at rest (c,), N, on a rigid plane; of several answers the most even."""
        return self._statics[1]

    @cached_property
    def _statics(self) -> tuple[Array, Array]:
        """Displacements y (d,) and forces (c,) with A y = 0 and Aᵀ F − K y = p, of least squares."""
        c, d = self.contacts.shape
        # forces and lengths are as different as stiffnesses
        scale = max(float(np.abs(self.stiffness).max()), 1.0)
        matrix = np.block([[-self.stiffness / scale, self.contacts.T], [self.contacts, np.zeros((c, c))]])
        solution = np.linalg.lstsq(matrix, np.concatenate([self.pressing, np.zeros(c)]), rcond=None)[0]
        return solution[:d] / scale, solution[d:]


def _refuse_rest(frequency: Array) -> None:
    if not (frequency > 0.0).all():
        allowed = "above 0: a free body has no static receptance"
        raise InputError("frequency (Hz)", float(frequency.min()), allowed)


def resonances(
    frequencies: ArrayLike, damping_ratios: ArrayLike, modal_masses: ArrayLike
) -> tuple[Array, Array, Array]:
    """Take natural frequencies, Hz, damping ratios and modal masses, kg, of as many modes each."""
    count = np.size(frequencies)
    natural = _above_zero("natural frequencies of the modes (Hz)", frequencies, count)
    allowed = "finite numbers, above 0 and below 1"
    ratio = finite_array(
        "damping ratios of the modes", damping_ratios, allowed, count=count, above=0.0, below=1.0
    )
    return natural, ratio, _above_zero("modal masses (kg)", modal_masses, count)


def _above_zero(what: str, given: ArrayLike, count: int) -> Array:
    return finite_array(what, given, "finite numbers, above 0", count=count, above=0.0)


@dataclass(frozen=True, eq=False)
class Wheel:
    """Wheel at its contact point, in the vertical direction: a free mass and flexible modes.

    Parameters
    ----------
    mass : float
        M, unsprung mass per wheel, kg: that of its rigid motion. Its suspension is soft: the wheel counts as
        free.
    load : float
        Static contact force, weight included, N.
    natural_frequencies : array_like (p,), optional
        Of the flexible modes, undamped, Hz.
    damping_ratios : array_like (p,), optional
        ζ, share of critical damping, above 0 and below 1.
    modal_masses : array_like (p,), optional
        m, with the vertical mode shape at the contact point scaled to one, kg.

    Raises
    ------
    InputError
        If mass or load is not positive, or the lists differ in length or hold values out of range.

    Notes
    -----
    The modes are those that the contact feels. A wheel that turns splits each mode with nodal diameters in
    two: `asperity.structures.wheel_modes.WheelModes.turning`.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import Wheel
    >>> wheel = Wheel(mass=600.0, load=65e3)
    >>> omega = 2 * np.pi * 100.0
    >>> bool(np.isclose(abs(wheel.receptance(np.array([100.0])))[0], 1 / (600.0 * omega**2)))
    True
    """

    mass: float
    load: float
    natural_frequencies: Array = field(default_factory=no_modes)
    damping_ratios: Array = field(default_factory=no_modes)
    modal_masses: Array = field(default_factory=no_modes)

    def __post_init__(self) -> None:
        positive("wheel mass (kg)", self.mass)
        positive("wheel load (N)", self.load)
        names = ("natural_frequencies", "damping_ratios", "modal_masses")
        for name, values in zip(names, resonances(*(getattr(self, name) for name in names)), strict=True):
            object.__setattr__(self, name, values)

    @property
    def body(self) -> Body:
        """The same as a body on one contact."""
        modes = self.natural_frequencies, self.damping_ratios, self.modal_masses
        return Body.rigid(self.mass, self.load).with_modes(*modes)

    def receptance(self, frequency: ArrayLike) -> Complex:
        """Displacement per harmonic force at the contact point.

        Parameters
        ----------
        frequency : array_like
            Hz, above zero.

        Returns
        -------
        ndarray of complex
            −1/(Mω²) + Σ 1/(m (ω₀² − ω² + 2iζω₀ω)), m/N, of the shape of `frequency`; e^{+iωt}.

        Raises
        ------
        InputError
            If a frequency is not above zero.
        """
        from asperity.structures.modal import modal_answers  # a case knows wheels without compiled code

        f = np.asarray(frequency, dtype=float)
        _refuse_rest(f)
        modes = modal_answers(f, self.natural_frequencies, self.damping_ratios)
        return modes @ (1.0 / self.modal_masses) - 1.0 / (self.mass * (2.0 * np.pi * f) ** 2)


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
        If nothing is left to press on the contact.
    """
    mass = np.asarray(masses, dtype=float)
    unit = np.eye(np.size(masses))
    pressing = GRAVITY * mass
    pressing[-1] += load
    stretch = np.diff(unit, axis=0)
    damping, stiffness = (
        stretch.T * np.asarray(each, dtype=float) @ stretch for each in (dampings, stiffnesses)
    )
    return _pressed(Body(np.diag(mass), damping, stiffness, unit[:1], pressing, np.zeros(1)))


def carriage(
    mass: float,
    inertia: float,
    places: ArrayLike,
    element_mass: float,
    upper_stiffness: float,
    upper_damping: float = 0.0,
    *,
    load: float = 0.0,
) -> Body:
    """A rigid mass that pitches, on elements in a row: a carriage on balls, the frame of a bogie on wheels.

    Parameters
    ----------
    mass, inertia : float
        Of the carriage: kg, and kg m² about the transverse axis through its centre of mass.
    places : array_like (c,)
        Of the contacts, ahead of the position of the body, m, the centre of mass in their middle.
    element_mass : float
        Mass of each rolling element or wheel, kg, with a spring above it.
    upper_stiffness, upper_damping : float
        Of that spring, the suspension of a wheel or a contact, linearised under its load: N/m and N s/m.
    load : float
        Constant force that presses on the carriage, N, beside all weights; negative where it lifts.

    Returns
    -------
    Body
        On as many contacts as places. Degrees of freedom: the elements, the carriage at its centre of mass,
        its pitch (rad, front up).

    Raises
    ------
    InputError
        If the carriage lifts off.

    Notes
    -----
    Elements move with the carriage: that a rolling ball follows at half its speed, and comes back around, is
    left out.
    """
    at = np.asarray(places, dtype=float)
    lever = np.stack([np.ones_like(at), at - at.mean()], axis=1)
    masses = np.append(np.full(at.size, element_mass), [mass, inertia])
    pressing = GRAVITY * masses
    unit = np.eye(masses.size)
    pressing[-2] = pressing[-2] + load
    pressing[-1] = 0.0
    stretch = lever @ unit[-2:] - unit[: at.size]
    damping, stiffness = (
        stretch.T * np.full(at.size, each) @ stretch for each in (upper_damping, upper_stiffness)
    )
    return _pressed(Body(np.diag(masses), damping, stiffness, unit[: at.size], pressing, at))


def _pressed(body: Body) -> Body:
    """The body, if it presses on each of its contacts."""
    least = float(body.static_loads.min())
    if not least > 0.0:
        received = f"a contact under {in_newtons(least)}"
        allowed = "contacts that are pressed at rest"
        raise InputError("load (N)", received, allowed, "Press more.")
    return body
