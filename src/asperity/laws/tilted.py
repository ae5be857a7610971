"""A law of rollers that lie at a tilt to their raceway, which goes along with them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.contact.slices import EXPONENT, SlicedContact
from asperity.errors import InputError
from asperity.kernels import pointforce
from asperity.laws import spec


@dataclass(frozen=True, eq=False)
class Tilted(spec.OnLaw):
    """A law whose force is that of all slices of a tilted roller, on the texture that the law follows.

    F = Σ c (approach − h + tilt · xₖ − P(xₖ))^(10/9) over the slices at xₖ, where their sum is positive; h,
    planes and damping are those of the law.

    Parameters
    ----------
    law : Law
        A force curve that follows a texture, as `areal`.
    contact : SlicedContact
        Of the roller and its raceway.
    """

    contact: SlicedContact

    def prepare(self, positions: spec.ArrayLike) -> spec.Prepared:
        """Lay the law out on (n, 2): positions, m, and angles by which the far end comes nearer, rad.

        On positions alone (n,) rollers lie level.
        """
        at = np.asarray(positions, dtype=float)
        at = np.column_stack([at, np.zeros(len(at))]) if at.ndim == 1 else at
        level = self.law.prepare(np.ascontiguousarray(at[:, 0]))
        if not isinstance(level, pointforce.Prepared) or level.form != pointforce.SHIFTED:
            allowed = "a force curve that follows a texture, as areal"
            raise InputError("law of a tilted roller", self.name, allowed)
        of = self.contact
        constants = np.full(of.slices, of.stiffness_constant / of.slices)
        return level._replace(
            form=pointforce.SLICED,
            touches=np.ascontiguousarray(at[:, 1]),
            knots=of.places,
            coefficients=np.column_stack([of.drops, constants]),
            exponent=EXPONENT,
        )
