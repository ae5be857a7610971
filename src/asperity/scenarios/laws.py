"""What the laws of a case are made of: its textures and state functions."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import shown
from asperity.config.sections import ContactCase, Numerics
from asperity.contact.scan import ScanJob, ScannedForces, first_touch, rtol_for, warn_of_flaws
from asperity.errors import InputError
from asperity.laws import Law, LawSpec, Need, spec_of
from asperity.progress import Progress
from asperity.reduction.filter import filtered_texture, punch_taps
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.table import ForceTable, StoredForces, scan_into
from asperity.reduction.texture import StateTexture, areal_texture
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

    def build(self, name: str) -> Law:
        """Build a law of the case by its name, on positions along the path, m."""
        spec = spec_of(name)
        law = spec.build(LaidReady(self, spec))
        if not isinstance(law, Law):
            allowed = "an object with name, damping and prepare(positions)"
            raise InputError(f"law {name}", shown(law), allowed)
        if law.name != name:
            remedy = "Hand the name of the materials on to it."
            raise InputError(f"law {name}", f"one built as {shown(law.name)}", shown(name), remedy)
        return law

    @cached_property
    def reduced(self) -> Reduction:
        """The state functions, which the case must have."""
        assert self.reduction is not None
        return self.reduction

    @property
    def line(self) -> StateTexture:
        """Line texture of the path, not filtered."""
        return StateTexture.unfiltered(-self.textures.followed, self.shape.spacing[0], self.textures.start)

    def filtered_line(self, law: LawSpec) -> StateTexture:
        """Line texture of the path, through the filter of a law."""
        dx, start = self.shape.spacing[0], self.textures.start
        if self.reduction is None:  # smooth bodies: the filter of Hertz's patch, in closed form
            taps, states = punch_taps(self.shape.semi_axes[0], dx), np.zeros(1)
        else:
            found = self.reduction.filters[normalisation(self.contact, law)]
            warn_of_filter(found, law.name, self.reduction.working_approach)
            taps, states = found.taps, found.contact_filter.approaches
        return self._over_defects(filtered_texture(self.textures.line, dx, taps, states, start))

    def _over_defects(self, texture: StateTexture) -> StateTexture:
        """Add the trajectory over defects: rolled over already, it is not to be filtered again."""
        if self.textures.trajectory is None:
            return texture
        return replace(texture, heights=texture.heights - self.textures.trajectory)

    @cached_property
    def plane(self) -> StateTexture:
        """Plane that the nominal patch feels under the working load, along the path."""
        assert self.planes is not None
        return self._over_defects(
            StateTexture.unfiltered(-self.planes, self.shape.spacing[0], self.textures.start)
        )

    @property
    def areal(self) -> StateTexture:
        """Texture averaged under the patch of each state; not held, as it is as long as the path in each."""
        assert self.textures.path is not None
        loaded = self.reduced.semi_axes[:, 0] > 0.0
        return self._over_defects(
            areal_texture(
                self.textures.path,
                self.shape.spacing,
                self.reduced.approaches[loaded],
                np.minimum(self.reduced.semi_axes[loaded], 0.5 * self.textures.path.size[1]),
                self.textures.start,
            )
        )

    @cached_property
    def scan(self) -> ScannedForces[StoredForces]:
        """The scan of the path."""
        reduction = self.reduced
        job = ScanJob(
            self.shape.half_space(self.contact.hardness), self.textures.surface, self.shape.body,
            reduction.approaches, table_stride(self.shape), rtol_for(self.numerics.force_accuracy),
            self._scanned_planes, self.textures.before,
        )  # fmt: skip
        scanned = scan_into(self.cache, job, progress=self.progress, message="scanning the path")
        widest = self.textures.widest_window
        remedy = self.shape.remedy_for_cut_off(
            float(reduction.approaches[-1]), reduction.working_approach, reduction.datums["path"], widest
        )
        warn_of_flaws(scanned.counts, "the path", SCAN_TOLERANCE, remedy)
        return scanned

    @property
    def _scanned_planes(self) -> NDArray[np.float64]:
        """Planes at the positions of the scan, m, peaks positive.

        To a femtometre: what Fourier transforms leave depends on where along the path they are taken.
        """
        half, heights = self.shape.body.shape[0] // 2, self.plane.heights[0]
        return -np.round(heights[half : len(heights) - half][self._scanned_rows], 15)

    @property
    def _scanned_rows(self) -> slice:
        """Rows on which the window begins, of all on which it may, counted from the record's start."""
        stride = table_stride(self.shape)
        return slice(self.textures.before % stride, None, stride)

    @cached_property
    def table(self) -> ForceTable:
        """The scan of the path, to look forces up in."""
        rows, dx, body = self._scanned_rows, self.shape.spacing[0], self.shape.body
        if self.textures.defects is not None:
            touches = first_touch(self.textures.surface, body, rows.step, rows.start) + self._scanned_planes
        else:
            assert self.reduced.touches is not None
            touches = self.reduced.touches[rows]
        start = self.textures.start + (rows.start + body.shape[0] // 2) * dx
        return ForceTable(self.scan.forces, self.reduced.approaches, start, rows.step * dx, touches)


@dataclass(frozen=True, eq=False)
class LaidReady:
    """The materials of one law, see `asperity.laws.Materials`."""

    workshop: Workshop
    law: LawSpec

    def _take_out(self, material: str, *needs: Need) -> None:
        """Refuse a material that the law does not say it needs: what is planned and checked follows needs."""
        if not self.law.needs & set(needs):
            wanted = " or ".join(f'"{need}"' for need in needs)
            allowed = f"materials that it needs; this one goes with {wanted}"
            raise InputError(f"materials of law {self.law.name}", material, allowed)

    @property
    def name(self) -> str:
        """See `Materials`, as for all that follows."""
        return self.law.name

    @property
    def damping(self) -> float:
        """Contact damping, N s/m."""
        return self.workshop.contact.damping

    @property
    def load(self) -> float:
        """Working load, N."""
        return self.workshop.shape.load

    @property
    def hertz_constant(self) -> float:
        """K of smooth bodies, N/m^1.5."""
        return self.workshop.shape.hertz.stiffness_constant

    @property
    def modulus(self) -> float:
        """Contact modulus, Pa."""
        return self.workshop.shape.modulus

    @property
    def working_point(self) -> tuple[float, float]:
        """Approach, m, and stiffness, N/m, under the working load."""
        return working_point(self.workshop.contact, self.workshop.shape, self.workshop.reduction)

    @cached_property
    def line(self) -> StateTexture:
        """Line texture, filtered where the law needs it, m."""
        return self.workshop.filtered_line(self.law) if Need.FILTER in self.law.needs else self.workshop.line

    def line_on(self, curve: ForceCurve) -> StateTexture:
        """Line texture with its states where a curve carries their forces, m."""
        if self.workshop.reduction is None or Need.FILTER not in self.law.needs:
            return self.line
        forces = self.workshop.reduction.ensemble.curve.force(self.line.approaches)
        return replace(self.line, approaches=curve.inverse(forces))

    @property
    def line_at_load(self) -> StateTexture:
        """Line texture of the state under the working load, m."""
        reduction, load = self.workshop.reduction, self.load
        held_at = 0.0 if reduction is None else float(reduction.ensemble.curve.inverse(load))
        return self.line.held_at(held_at)

    @property
    def curve(self) -> ForceCurve:
        """Force over approach."""
        self._take_out("curve", Need.SAMPLES)
        return self.workshop.reduced.ensemble.curve

    @property
    def datum(self) -> float:
        """Datum of the state, m."""
        self._take_out("datum", Need.DATUM)
        return self.workshop.reduced.ensemble.datum

    @property
    def areal(self) -> StateTexture:
        """Texture averaged under the patch, m."""
        self._take_out("areal", Need.AREAL)
        return self.workshop.areal

    @property
    def plane(self) -> StateTexture:
        """Plane that the patch feels, m."""
        self._take_out("plane", Need.AREAL, Need.SCAN, Need.SURFACE)
        return self.workshop.plane

    @property
    def table(self) -> ForceTable:
        """Scanned force, N."""
        self._take_out("table", Need.SCAN)
        return self.workshop.table

    @property
    def heights(self) -> NDArray[np.float64]:
        """Heights of the path, m, shape (rows, ny)."""
        self._take_out("heights", Need.SURFACE)
        surface = self.workshop.textures.surface
        return surface.rows(0, surface.shape[0])

    @property
    def start(self) -> float:
        """Position of the first row, m."""
        return self.workshop.textures.start

    @property
    def body(self) -> NDArray[np.float64]:
        """Shape of the smooth body, m, shape (nx, ny)."""
        return self.workshop.shape.body

    @property
    def spacing(self) -> tuple[float, float]:
        """Steps of the grid, m."""
        return self.workshop.shape.spacing

    @property
    def hardness(self) -> float | None:
        """Pressure cap, Pa."""
        return self.workshop.contact.hardness

    @property
    def rtol(self) -> float:
        """Tolerance of a solution."""
        return self.workshop.numerics.rtol


def table_stride(shape: Geometry) -> int:
    """Rows of the contact grid between the positions of a table: an eighth of the patch."""
    return max(1, math.floor(shape.class_axes[0] / 8 / shape.spacing[0]))


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
