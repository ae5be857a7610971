"""What the laws of a case are made of: its textures and state functions."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, Self

import numpy as np

from asperity.arguments import Array
from asperity.case import sections
from asperity.contact.scan import (
    ScanJob,
    ScannedForces,
    first_touch,
    joined_states,
    rtol_for,
    scan_forces,
    warn_of_flaws,
)
from asperity.laws import Law, LawSpec, Materials, Need, built, spec_of
from asperity.progress import Progress
from asperity.reduction import filter
from asperity.reduction.stiffness import ForceTable
from asperity.reduction.texture import StateTexture, areal_texture
from asperity.scenarios import reducing
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.scanned_positions import table_stride
from asperity.scenarios.scanned_states import states_apart, states_around, states_expected
from asperity.scenarios.scene import PreparedCase
from asperity.scenarios.textures import textures_under
from asperity.store import Store


@dataclass(frozen=True, eq=False, kw_only=True)
class ReducedCase(PreparedCase):
    """A case that is reduced: what the laws of one of its contacts are made of."""

    reduction: reducing.Reduction | None  # state functions; None where the case has no samples
    # (rows,), height of the plane that the nominal patch feels along the path, m, peaks positive
    planes: Array | None
    progress: Progress
    # at which the path is scanned, of those to look up; None: those that a motion is expected to visit
    states: slice | None = None
    # scans of the path by their states, which those have in common that are scanned for other motions
    scans: dict[int, ScannedForces] = field(default_factory=dict)

    def of_contact(self, contact: int, load: float) -> "ReducedCase":
        """Those of another contact of the same bodies, by whose texture it bears and its load, N."""
        textures = textures_under(self.case, contact, self.textures)
        shape = replace(self.shape, load=load)
        path = textures.averaged.path
        planes = None if path is None else reducing.patch_planes(path, self.shape)
        return replace(self, textures=textures, shape=shape, planes=planes, scans={})

    @property
    def scanning(self) -> Self:
        """The same as a law has it whose path is scanned, with planes at its rows and scans of its own."""
        if not self.has_long_cells or self.planes is None:
            return super().scanning
        return replace(super().scanning, planes=self.planes[self.textures.before % 2 :: 2], scans={})

    def build(self, name: str) -> Law:
        """Build a law of the case by its name, on positions along the path, m."""
        spec = spec_of(name)
        if Need.SCAN in spec.needs:
            return built(self.scanning._of_law(spec))
        return built((self.seeing if spec.sees_heights else self)._of_law(spec))

    def _of_law(self, spec: LawSpec) -> Materials:
        case = self.case
        contact = self.case.contact
        shape = self.shape
        textures = self.textures
        made_by: dict[str, Callable[[], Any]] = {
            "line": partial(self._line, spec),
            "areal": self._areal,
            "plane": lambda: self.plane,
            "table": self._table,
            "heights": lambda: textures.surface.rows(0, textures.surface.shape[0]),
        }
        if self.reduction is not None:
            ensemble = self.reduction.ensemble
            made_by |= {"curve": lambda: ensemble.curve, "datum": lambda: ensemble.datum}
        return Materials(
            spec, contact.damping, shape.load, shape.hertz.stiffness_constant, shape.modulus,
            working_point(contact, shape, self.reduction), self.textures.start, shape.body, shape.spacing,
            contact.hardness, case.numerics.rtol, case.law_parameters(spec.name), made_by,
            shape.cells,
        )  # fmt: skip

    @cached_property
    def _reduced(self) -> reducing.Reduction:
        assert self.reduction is not None
        return self.reduction

    def _line(self, law: LawSpec) -> StateTexture:
        """Line texture of the path, through the filter of a law that needs it."""
        dx = self.shape.spacing[0]
        start = self.textures.start
        if Need.FILTER not in law.needs:
            return StateTexture.unfiltered(-self.textures.followed, dx, start)
        if self.reduction is None:  # smooth bodies: the filter of Hertz's patch, in closed form
            taps = filter.punch_taps(self.shape.semi_axes[0], dx)
            states = np.zeros(1)
        else:
            line_filter = self.reduction.filters[reducing.normalisation(self.case.contact.normalise, law)]
            reducing.warn_of_filter(line_filter, law.name, self.reduction.pressed.approach)
            taps = line_filter.taps
            states = line_filter.contact_filter.approaches
        return self._over_defects(filter.filtered_texture(self.textures.line, dx, taps, states, start))

    def _over_defects(self, texture: StateTexture) -> StateTexture:
        """Add the trajectory over defects: rolled over already, it is not to be filtered again."""
        if self.textures.trajectory is None:
            return texture
        return replace(texture, heights=texture.heights - self.textures.trajectory)

    @cached_property
    def plane(self) -> StateTexture:
        """Plane that the nominal patch feels under the working load, along the path, with defects."""
        assert self.planes is not None
        dx = self.shape.spacing[0]
        start = self.textures.start
        return self._over_defects(StateTexture.unfiltered(-self.planes, dx, start))

    def _areal(self) -> StateTexture:
        """Texture averaged under the patch of each state; not held, as it is as long as the path in each."""
        path = self.textures.averaged.path
        axes = self._reduced.semi_axes
        approaches = self._reduced.approaches
        assert path is not None
        loaded = axes[:, 0] > 0.0
        within = np.minimum(axes[loaded], 0.5 * path.shape[1] * path.spacing[1])
        spacing = self.shape.spacing
        start = self.textures.start
        return self._over_defects(areal_texture(path, spacing, approaches[loaded], within, start))

    @cached_property
    def to_look_up(self) -> list[int]:
        """States, by their numbers, at which the path may be scanned."""
        ensemble = self._reduced.ensemble
        if self.leaves_states_out:
            return states_apart(ensemble.approaches, ensemble.forces)
        return list(range(len(ensemble.approaches)))

    @property
    def scanned(self) -> slice:
        """States at which the path is scanned, of those to look up."""
        ensemble = self._reduced.ensemble
        which = self.to_look_up
        forces = ensemble.mean_force[which]
        return self.states or states_expected(ensemble.approaches[which], forces, self.scene.loads)

    def wider(self, visited: tuple[float, float] | None) -> Self | None:
        """One whose path is scanned for a motion between two approaches, m, too; None if this one's is."""
        scanned = self.scanned
        approaches = self._reduced.approaches[self.to_look_up]
        needed = slice(0, len(approaches)) if visited is None else states_around(approaches, visited)
        both = slice(min(scanned.start, needed.start), max(scanned.stop, needed.stop))
        return None if both == scanned else replace(self, states=both)

    @cached_property
    def path_scan(self) -> ScannedForces:
        """The scan of the path, state after state: motions that visit others share them."""
        states = self.to_look_up[self.scanned]
        unknown = [state for state in states if state not in self.scans]
        for which, state in enumerate(unknown):
            self.scans[state] = self._scan_of(state, partial(self._tell, which, len(unknown)))
        scanned = joined_states([self.scans[state] for state in states])
        warn_of_flaws(scanned.counts, "the path", reducing.SCAN_TOLERANCE, self._reduced.remedy)
        return scanned

    def _tell(self, which: int, count: int, done: int, positions: int, message: str) -> None:
        """Tell of one of so many scans as of a part of all."""
        if self.progress is not None:
            self.progress(which * positions + done, count * positions, message)

    def _scan_of(self, state: int, progress: Progress) -> ScannedForces:
        shape = self.shape
        job = ScanJob(
            shape.half_space(self.case.contact.hardness), self.textures.surface, shape.body,
            self._reduced.approaches[state], table_stride(self),
            rtol_for(self.case.numerics.force_accuracy), self._scanned_planes, self.textures.before,
        )  # fmt: skip
        told = {"progress": progress, "message": "scanning the path"}
        return scan_forces(job, mapped=True, cache=Store(), **told)

    @property
    def _scanned_planes(self) -> Array:
        """Planes at the positions of the scan, m, peaks positive.

        To a femtometre: what Fourier transforms leave depends on where along the path they are taken.
        """
        half = self.shape.body.shape[0] // 2
        heights = self.plane.heights[0]
        return -np.round(heights[half : len(heights) - half][self._scanned_rows], 15)

    @property
    def _scanned_rows(self) -> slice:
        """Rows on which the window begins, of all on which it may, counted from the record's start."""
        stride = table_stride(self)
        return slice(self.textures.before % stride, None, stride)

    def _table(self) -> ForceTable:
        """The scan of the path, to look forces up in."""
        rows = self._scanned_rows
        dx = self.shape.spacing[0]
        body = self.shape.body
        touches = first_touch(self.textures.surface, body, rows.step, rows.start) + self._scanned_planes
        start = self.textures.start + (rows.start + body.shape[0] // 2) * dx
        approaches = self._reduced.approaches[self.to_look_up[self.scanned]]
        return ForceTable(self.path_scan.forces, approaches, start, rows.step * dx, touches)


def reduced_case(prepared: PreparedCase, progress: Progress) -> ReducedCase:
    """Reduce a case to what its laws are made of; one without samples has no state functions."""
    path = prepared.textures.averaged.path
    reduction = None
    planes = None if path is None else reducing.patch_planes(path, prepared.shape)
    if prepared.textures.maps:
        reduction = reducing.reduce(prepared, planes, progress)
    return ReducedCase(**vars(prepared), reduction=reduction, planes=planes, progress=progress)


def working_point(
    contact: sections.ContactKeys, shape: Geometry, reduction: reducing.Reduction | None
) -> tuple[float, float]:
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


def law_on_path(prepared: PreparedCase, name: str, ring: str) -> Law:
    """A law on the path of bodies that roll, which has no rings."""
    return reduced_case(prepared, lambda *_: None).build(name)
