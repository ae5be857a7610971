"""A law with a film of oil between its bodies, in series with them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.contact.film import Film
from asperity.errors import InputError
from asperity.kernels import pointforce
from asperity.laws import spec
from asperity.reduction.stiffness import ForceCurve

LIGHTEST, HEAVIEST = 1e-5, 1e2
"""Forces of the curve, over the load: below the first one nothing is pushed, beyond the last it goes on."""
KNOTS = 160
"""Of the curve: its force is that of film and bodies in series within 1e-4."""


@dataclass(frozen=True, eq=False)
class WithFilm(spec.OnLaw):
    """A law whose bodies are as far apart as the film of oil between them is thick under the force.

    Under a force F the approach is that of the dry law less h(F), in the middle of the contact. A force curve
    that follows a texture has both in one, and each state of the texture counts as much less as the film of a
    smooth contact there is thick; in all other laws the film is found with the force, step by step.

    Parameters
    ----------
    law : Law
        That is laid out for the compiled stepper.
    film : Film
        Between smooth bodies.
    load : float
        Of the contact, N, about which it is exact.
    """

    film: Film
    load: float
    _softened: dict[tuple[Any, ...], dict[str, Any]] = field(default_factory=dict, init=False, repr=False)

    def prepare(self, positions: spec.ArrayLike) -> spec.Prepared:
        """Lay the law out on positions (n,) of the contact, m."""
        dry = self.law.prepare(positions)
        if not isinstance(dry, pointforce.Prepared):
            allowed = "one that is not solved in every step"
            raise InputError("law of a contact with a film", self.name, allowed)
        if dry.form != pointforce.SHIFTED:
            thickest = float(self.thickness(np.array(0.0)))
            return dry._replace(film=pointforce.SeriesFilm(thickest, LIGHTEST * self.load, self._exponent))
        of_curve = dry.knots, dry.coefficients, dry.exponent, dry.upper, dry.bilateral
        key = tuple(np.asarray(each).tobytes() for each in (dry.states, *of_curve))
        if key not in self._softened:  # the same all along the path, which is laid out piece by piece
            curve = self.curve(ForceCurve(*of_curve))
            self._softened[key] = {
                "states": self.nearer(dry.states), "knots": curve.knots, "coefficients": curve.coefficients,
                "exponent": float(curve.exponent), "upper": float(curve.upper),
            }  # fmt: skip
        return dry._replace(**self._softened[key])

    def nearer(self, approaches: Array) -> Array:
        """Approaches (k,), m, less the film of a smooth contact at each."""
        return approaches - self.thickness(self.film.of_bodies(approaches))

    @property
    def _exponent(self) -> float:
        """Power of the force by which the film goes; below zero."""
        return self.film.formula.central.load

    def thickness(self, force: Array) -> Array:
        """Film thickness (k,), m, under forces (k,), N; under hardly any force that of the lightest one."""
        share = np.maximum(force / self.load, LIGHTEST)
        return self.film.central(self.load) * share**self._exponent

    def curve(self, dry: ForceCurve) -> ForceCurve:
        """Force over approach with the film, of that of the dry bodies."""
        if dry.bilateral:
            force = float(dry.force(dry.knots[0]))
            softer = 1.0 / float(dry.stiffness(dry.knots[0])) + float(self._yielding(force))
            apart = float(self.thickness(np.array(force)))
            return ForceCurve.linear(force, 1.0 / softer, float(dry.knots[0]) - apart)
        forces = self.load * np.geomspace(LIGHTEST, HEAVIEST, KNOTS)
        bodies = dry.inverse(forces)
        stiffness = 1.0 / (1.0 / dry.stiffness(bodies) + self._yielding(forces))
        found = ForceCurve.from_samples(bodies - self.thickness(forces), forces, dry.exponent, stiffness)
        beyond = dry.upper - self.film.central(self.load)
        return ForceCurve(found.knots, found.coefficients, found.exponent, beyond)

    def _yielding(self, force: Array | float) -> Array:
        """−dh/dF of the film under forces (k,), N; m/N."""
        return -self._exponent * self.thickness(np.asarray(force)) / force
