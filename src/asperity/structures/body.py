"""A body that rolls on one or several contacts: masses, springs and dampers, and modes on top of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import real_array
from asperity.errors import InputError

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
