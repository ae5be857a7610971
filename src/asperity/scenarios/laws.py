"""The laws of a case, built from its textures and state functions."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from asperity.config.sections import ContactCase, Numerics
from asperity.contact.accuracy import rtol_for
from asperity.contact.flaws import warn_of_flaws
from asperity.contact.scan import ScanJob, ScannedForces, first_touch
from asperity.laws import Areal, Direct, Hertz, Law, Linear, Printed, Shifted, Table
from asperity.progress import Progress
from asperity.reduction.areal import areal_texture
from asperity.reduction.fir import filtered_texture, punch_taps
from asperity.reduction.stored import StoredForces, scan_into
from asperity.reduction.table import ForceTable
from asperity.reduction.texture import StateTexture
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.line_filters import normalisation, warn_of_filter
from asperity.scenarios.reducing import SCAN_TOLERANCE, Reduction
from asperity.scenarios.textures import Textures
from asperity.store import Cache


@dataclass(frozen=True, eq=False)
class Workshop:
    """What the laws of one case are made of."""

    contact: ContactCase
    numerics: Numerics  # how accurately contacts are solved
    textures: Textures
    shape: Geometry
    reduction: Reduction | None  # state functions; None where the case has no samples
    # (rows,), height of the plane that the nominal patch feels along the path, m, peaks positive
    planes: NDArray[np.float64] | None
    cache: Cache  # for the scan of the path
    progress: Progress

    def build(self, name: str) -> tuple[Law, ScannedForces[StoredForces] | None]:
        """Build one law, and return the scan that it needed, if any.

        Parameters
        ----------
        name : str
            Name of the law in the case.

        Returns
        -------
        law : Law
            The law, on positions along the path, m.
        scanned : ScannedForces or None
            The scan of the path, for ``table``.
        """
        damping = self.contact.damping
        base, _, variant = name.partition("-")
        if base == "table":
            return self._table(damping)
        if base == "direct":
            return self._direct(damping), None
        if base in ("hertz", "linear"):
            texture = self._filtered_line(name) if variant == "filtered" else self._line()
            return (self._hertz if base == "hertz" else self._linear)(texture, damping, name), None
        assert self.reduction is not None
        curve = self.reduction.ensemble.curve
        if base == "areal":
            return Areal(curve, self._areal(), damping, plane=self._plane()), None
        texture = self._line() if variant == "unfiltered" else self._filtered_line(name)
        if base == "printed":
            return Printed(curve, texture, self.reduction.ensemble.datum, damping, name), None
        return Shifted(curve, texture, damping, name), None

    def _hertz(self, texture: StateTexture, damping: float, name: str) -> Law:
        return Hertz(self.shape.hertz.stiffness_constant, texture, damping, name)

    def _linear(self, texture: StateTexture, damping: float, name: str) -> Law:
        if self.reduction is not None:  # a filter that changed with the state would not be linear
            texture = texture.held_at(float(self.reduction.ensemble.curve.inverse(self.shape.load)))
        approach, stiffness = working_point(self.contact, self.shape, self.reduction)
        return Linear(self.shape.load, stiffness, approach, texture, damping, name)

    def _line(self) -> StateTexture:
        return StateTexture.unfiltered(-self.textures.followed, self.shape.spacing[0], self.textures.start)

    def _filtered_line(self, law: str) -> StateTexture:
        dx, start = self.shape.spacing[0], self.textures.start
        if self.reduction is None:  # smooth bodies: the filter of Hertz's patch, in closed form
            taps, states = punch_taps(self.shape.semi_axes[0], dx), np.zeros(1)
        else:
            found = self.reduction.filters[normalisation(self.contact, law)]
            warn_of_filter(found, law, self.reduction.working_approach)
            taps, states = found.taps, found.contact_filter.approaches
        return self._over_defects(filtered_texture(self.textures.line, dx, taps, states, start))

    def _over_defects(self, texture: StateTexture) -> StateTexture:
        """Add the trajectory over defects: rolled over already, it is not to be filtered again."""
        if self.textures.trajectory is None:
            return texture
        return replace(texture, heights=texture.heights - self.textures.trajectory)

    def _plane(self) -> StateTexture | None:
        if self.planes is None:
            return None
        return self._over_defects(
            StateTexture.unfiltered(-self.planes, self.shape.spacing[0], self.textures.start)
        )

    def _areal(self) -> StateTexture:
        assert self.reduction is not None
        assert self.textures.path is not None
        loaded = self.reduction.semi_axes[:, 0] > 0.0
        return self._over_defects(
            areal_texture(
                self.textures.path,
                self.shape.spacing,
                self.reduction.approaches[loaded],
                np.minimum(self.reduction.semi_axes[loaded], 0.5 * self.textures.path.size[1]),
                self.textures.start,
            )
        )

    def _table(self, damping: float) -> tuple[Law, ScannedForces[StoredForces]]:
        assert self.reduction is not None
        assert self.planes is not None
        plane = self._plane()
        assert plane is not None
        dx, half = self.shape.spacing[0], self.shape.body.shape[0] // 2
        stride, surface = table_stride(self.shape), self.textures.surface
        planes = -plane.heights[0, half : len(self.planes) - half : stride]
        job = ScanJob(
            self.shape.half_space(self.contact.hardness), surface, self.shape.body, self.reduction.approaches,
            stride, rtol_for(self.numerics.force_accuracy), planes,
        )  # fmt: skip
        scanned = scan_into(self.cache, job, progress=self.progress, message="scanning the path")
        reduction, widest = self.reduction, self.textures.widest_window
        remedy = self.shape.remedy_for_cut_off(
            float(reduction.approaches[-1]), reduction.working_approach, reduction.datums["path"], widest
        )
        warn_of_flaws(scanned.counts, "the path", SCAN_TOLERANCE, remedy)
        if self.textures.defects is not None:
            touches = first_touch(surface, self.shape.body, stride) + planes
        else:
            assert self.reduction.touches is not None
            touches = self.reduction.touches[::stride]
        table = ForceTable(
            scanned.forces, self.reduction.approaches, self.textures.start + half * dx, stride * dx, touches
        )
        return Table(table, damping, plane=plane), scanned

    def _direct(self, damping: float) -> Law:
        surface = self.textures.surface
        return Direct(
            surface.rows(0, surface.shape[0]),
            self.shape.body,
            self.shape.spacing,
            self.shape.modulus,
            self.textures.start,
            self.contact.hardness,
            self.numerics.rtol,
            damping,
        )


def table_stride(shape: Geometry) -> int:
    """Rows of the contact grid between the positions of a table: an eighth of the patch."""
    return max(1, math.floor(shape.semi_axes[0] / 8 / shape.spacing[0]))


def working_point(contact: ContactCase, shape: Geometry, reduction: Reduction | None) -> tuple[float, float]:
    """Approach under the working load, m, and the stiffness that a linear contact has there, N/m.

    dF/dr of the smooth or the rough contact, or F/r of the rough one (thesis Eq. 2.3), as the case says; of
    the smooth one where there are no samples.
    """
    if contact.linearise == "hertz" or reduction is None:
        approach = shape.hertz.approach(shape.load)
        tangent = shape.hertz.tangent_stiffness(approach)
        return approach, shape.load / approach if contact.linearise == "secant" else tangent
    ensemble = reduction.ensemble
    approach = float(ensemble.curve.inverse(shape.load))
    if contact.linearise == "secant":
        return approach, shape.load / (approach + ensemble.datum)
    return approach, float(ensemble.curve.stiffness(approach))
