"""Contact laws on raceways that are closed around: grids for slender contacts, one scan of what is new."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import Any, get_args

import numpy as np

from asperity.arguments import Array, ArrayLike, Flags, Indices, NDArray, positive
from asperity.contact import scan
from asperity.contact.batched import find_device
from asperity.contact.elastic_grid import MOST_ELONGATED
from asperity.contact.halfspace import HalfSpace
from asperity.contact.hertz import Hertz
from asperity.contact.pressed import at_load
from asperity.contact.scan import FORCE_ACCURACY, ScannedForces, rtol_for
from asperity.errors import Grade, OutOfRangeWarning
from asperity.kernels.curves import OVERLAP
from asperity.laws import LawSpec, Materials, Need, PairedLaw, built, spec_of
from asperity.laws.periodic import Periodic
from asperity.progress import Progress
from asperity.reduction.filter import LineFilter, Normalise, filtered_texture
from asperity.reduction.stiffness import (
    ForceCurve,
    ForceTable,
    StiffnessEnsemble,
    patches,
    stiffness_ensemble,
)
from asperity.reduction.texture import StateTexture, areal_texture, punch_weights
from asperity.scenarios import raceway_grids, reducing
from asperity.scenarios.geometry import HIGHEST_FORCE, Geometry
from asperity.scenarios.raceway_grids import HALF_WINDOW
from asperity.scenarios.raceway_positions import follows_average, forces_between, positions_apart
from asperity.scenarios.rim_cells import SMOOTH
from asperity.scenarios.scanned_states import place_between, states_around, states_expected
from asperity.store import Store
from asperity.surfaces.cell_means import pressed_heights
from asperity.surfaces.edges import Edges
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.raceway import Raceway
from asperity.surfaces.strip import Rows
from asperity.written_numbers import in_newtons

OTHER_LOADS = (0.25, 4.0)
"""Loads at which it is told how far laws are off over a fault, over that which they are made for."""
FAULT_OFF = 0.1
"""Share of the force from which that is more than a note."""
REMEDIES = "accuracy", "A smaller time step, or a larger static load: windows hold eight times as much."
"""For contacts solved in every step on raceways."""
SAMPLES = 8
"""Places of a rough raceway whose mean is its force curve."""
FILTER_STRIPS = 4
"""Pieces of a rough raceway on which contact filters are found."""
FILTER_LENGTH = 60.0
"""Their length in half axes along."""


@dataclass(frozen=True, eq=False)
class OnRaceway:
    """A ball on a raceway: what its contact feels, its forces all around, and laws made of them.

    Parameters
    ----------
    contact : Hertz
        Smooth contact, x along the path.
    surface : Raceway
        What it rolls over.
    load : float
        Largest static load of a ball, N; states cover eight times as much.
    damping : float
        Of the contact, N s/m.
    hardness : float, optional
        Pressure at which asperities flow, Pa.
    accuracy : float
        Largest relative error of a scanned force.
    cache : Store, optional
        Keeps what was scanned.
    progress : Progress, optional
        Told how far the scan is.
    balls : sequence of Raceway
        Surfaces over whose faults the window reaches, too.
    shortest : float
        Shortest wave along the raceway that is looked at, m; by default none is too short.
    least_load : float
        Static load of the ball that carries least, N.
    parameters : mapping, optional
        Values of the keys that laws have of their own, by name of the law and of the key; by default those
        that the laws give.
    """

    contact: Hertz
    surface: Raceway
    load: float
    damping: float = 0.0
    hardness: float | None = None
    accuracy: float = FORCE_ACCURACY
    cache: Store | None = None
    progress: Progress | None = None
    balls: Sequence[Raceway] = ()
    shortest: float = 0.0
    least_load: float = 0.0
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @cached_property
    def axes(self) -> tuple[float, float]:
        """Half axes of the smooth contact under the load, m, those of a roller half its width and length."""
        return self.contact.semi_axes_under(self.load)

    @cached_property
    def stride(self) -> int:
        """Rows between positions: the most up to an eighth of a half axis that divide a turn."""
        cell = self.axes[0] / raceway_grids.CELLS[0]
        most = max(1, math.floor(cell / self.surface.spacing[0] * (1.0 + 1e-3)))
        return next(each for each in range(most, 0, -1) if self.rows % each == 0)

    @cached_property
    def roughness(self) -> float:
        """Rms height of both surfaces over the approach under the load; infinite where there are faults."""
        if any(each.damaged.any() for each in (self.surface, *self.balls)):
            return math.inf
        on_balls = max((float(np.var(each.heights)) for each in self.balls), default=0.0)
        rms = math.sqrt(float(np.var(self.surface.heights)) + on_balls)
        return rms / self.contact.approach(self.load)

    @property
    def smooth(self) -> bool:
        """Whether forces follow the average under the patch between positions of the scan."""
        return follows_average(self.roughness, self.least_load / self.load)

    @cached_property
    def scanned_stride(self) -> int:
        """Rows between positions of the scan, whole strides, see `positions_apart`."""
        if self.surface.damaged.any():
            return self.stride
        apart = positions_apart(self.axes[0], self.shortest, self.roughness, follows=self.smooth)
        times = max(1, math.floor(apart / (self.stride * self.surface.spacing[0]) * (1.0 + 1e-3)))
        count = len(self.positions)
        return self.stride * next(each for each in range(times, 0, -1) if count % each == 0)

    @property
    def rows(self) -> int:
        """Rows of the raceway."""
        return len(self.surface.heights)

    @cached_property
    def shape(self) -> Geometry:
        """The gap of the smooth bodies on the window: as wide as the raceway, as long as faults let it be.

        Over a fault the ball may touch where it sinks to, or behind a bump.
        """
        dx, dy = self.surface.spacing
        contact = self.contact
        faults = self.surface.faults
        reach = max(self._reach(each) for each in (self.surface, *self.balls))
        half = math.ceil((HALF_WINDOW * self.axes[0] + reach) / dx)
        lines = faults.shape[1]
        x = (np.arange(2 * half + 1) - half) * dx
        y = (np.arange(lines) - lines // 2) * dy
        body = np.add.outer(x**2 / (2.0 * contact.radius_x), y**2 / (2.0 * contact.radius_y))
        largest = HIGHEST_FORCE * self.load
        return Geometry(body, (dx, dy), contact.modulus, contact, self.load, largest)

    def _reach(self, surface: Raceway) -> float:
        """How far before and behind the middle a ball may touch over the faults of a surface, m."""
        faults = surface.faults
        radius = self.contact.radius_x
        sound = np.flatnonzero(~surface.damaged.any(axis=1))
        longest = surface.spacing[0] * np.diff(np.append(sound, sound[:1] + len(faults))).max(initial=1)
        sinks = min(-float(faults.min()), longest**2 / (8.0 * radius))
        return math.sqrt(2.0 * radius * max(sinks, float(faults.max())))

    @cached_property
    def space(self) -> HalfSpace:
        """The half-space of the window."""
        return self.shape.half_space(self.hardness)

    @cached_property
    def scanned(self) -> Array:
        """Roughness and faults (rows + window − 1, lines), m: row i is the window's first about row i."""
        return self._around(self.surface.heights + self.surface.faults, len(self.shape.body) // 2)

    @cached_property
    def seen(self) -> Geometry:
        """The gap as laws have it that see heights: over cells that are covered in part, or whole ones.

        Covered where the case `auto` of `contact.rim_cells` has them: on what is smooth and has no faults, as
        long as cells are not too slender for them.
        """
        long, wide = self.surface.spacing
        covered = self.roughness <= SMOOTH and find_device() is None and wide <= MOST_ELONGATED * long
        return self.shape.over_cells() if covered else self.shape

    def pressed(self, heights: Array, beyond: int) -> Array:
        """Heights (rows, lines), m, as such laws press them, with rows from the other end beyond a turn."""
        if self.seen.cells == "whole":
            return self._around(heights, beyond)
        return pressed_heights(self._around(heights, beyond + 2))[2:-2]

    def _edges_in(self, rows: slice) -> Edges | None:
        """Edges on some rows of `scanned`, if there are any."""
        at = (np.arange(rows.start, rows.stop) - len(self.shape.body) // 2) % self.rows
        edges = self.surface.edges
        return None if edges is None else edges.rearranged(lambda field: field[at])

    @staticmethod
    def _around(values: NDArray[Any], beyond: int, axis: int = 0) -> NDArray[Any]:
        """Values with as many from the other end beyond either end of a turn."""
        return np.pad(values, [(beyond, beyond) if i == axis else (0, 0) for i in range(values.ndim)], "wrap")

    def _over(self, at: int) -> tuple[Array, Edges | None]:
        """Gap (nx, ny), m, of the smooth ball over the faults at a position, and their edges."""
        body = self.shape.body
        edges = self.surface.edges
        rows = (np.arange(len(body)) - len(body) // 2 + self.stride * at) % self.rows
        under = None if edges is None else edges.rearranged(lambda field: field[rows])
        return body - self.surface.faults[rows], under

    @property
    def positions(self) -> Indices:
        """Rows on which forces are solved."""
        return np.arange(0, self.rows, self.stride)

    def _met(self, heights: NDArray[Any]) -> Flags:
        """At which positions the window holds anything of heights (rows, lines)."""
        window = len(self.shape.body)
        rows = np.cumsum(self._around(np.any(heights, axis=1), window // 2))
        within = rows[window - 1 :] - np.append(0, rows[:-window])
        return within[:: self.stride] > 0

    @property
    def cells_over_faults(self) -> float:
        """How many cells the contacts have in all that `over_faults` solves."""
        met = self._met(self.surface.damaged).sum() if self.surface.damaged.any() else 0
        return float(met) * self.shape.body.size

    @cached_property
    def over_faults(self) -> Array:
        """Height (rows,) that faults have for a contact under the load, m: exact for that load.

        By so much less is the approach there than on the smooth raceway.
        """
        if not self.surface.damaged.any():
            return np.zeros(self.rows)
        rtol = rtol_for(self.accuracy)
        start = None
        smooth = at_load(self.space, self.shape.body, self.load, None, rtol).approach
        met = self._met(self.surface.damaged)
        felt = np.zeros(len(self.positions))
        for at in np.flatnonzero(met).tolist():
            gap, edges = self._over(at)
            found = at_load(self.space, gap, self.load, start, rtol, edges)
            felt[at] = smooth - found.approach
            start = found.pressure
        return np.interp(np.arange(self.rows), self.positions, felt, period=self.rows)

    def averaged(self, heights: Array, axes: ArrayLike) -> Array:
        """Heights (rows, lines), m, averaged under patches of half axes (k, 2), m, with `over_faults`."""
        patch = np.minimum(np.atleast_2d(axes), 0.5 * heights.shape[1] * self.surface.spacing[1])
        reach = math.ceil(patch[:, 0].max() / self.surface.spacing[0]) + 1
        states = np.arange(len(patch), dtype=float)
        under = areal_texture(self._around(heights, reach), self.surface.spacing, states, patch).heights
        return self.over_faults - under[:, reach:-reach]

    @cached_property
    def wavy(self) -> Array:
        """Roughness with the long waves (rows, lines), m."""
        return self.surface.heights + self.surface.line[:, None]

    @cached_property
    def felt(self) -> Array:
        """Height (rows,), m, that a contact under the load feels, with the long waves."""
        return self.averaged(self.wavy, self.axes)[0]

    @cached_property
    def planes(self) -> Array:
        """Heights at the positions from which approaches of the scan count, m.

        To a femtometre: what Fourier transforms leave depends on what else is on the raceway.
        """
        return np.round(self.averaged(self.surface.heights, self.axes)[0][self.positions], 15)

    @cached_property
    def touches(self) -> Array:
        """Approach at first touch at the positions, from the planes, m."""
        if not self.scanned.any():
            return self.planes + float(self.shape.body.min())
        return scan.first_touch(self.scanned, self.shape.body, self.stride) + self.planes

    @cached_property
    def approaches(self) -> Array:
        """States, from the planes, m: up to eight times the load wherever the raceway is unlike."""
        felt = self.over_faults[self.positions]
        sound = np.flatnonzero(~self._met(self.surface.damaged))
        extreme = [each(values) for each in (np.argmin, np.argmax) for values in (self.touches, felt)]
        few = SAMPLES if self.surface.heights.any() else 1
        even = sound[:: max(1, math.ceil(len(sound) / few))]
        chosen = [(self.positions[at], self.planes[at]) for at in np.union1d(extreme, even).astype(int)]
        places = [self.scanned[row : row + len(self.shape.body)] - plane for row, plane in chosen]
        return reducing.chosen_states(places, self.shape, self.space)

    @cached_property
    def _pressed(self) -> Array:
        """Roughness and faults on the rows of `scanned`, m, as laws press them that see heights."""
        return self.pressed(self.surface.heights + self.surface.faults, len(self.shape.body) // 2)

    def scanned_in(self, states: slice) -> ScannedForces:
        """Forces (states, positions) once around in some states, each scanned for itself.

        Where nothing is in the window they are solved once.
        """
        window, lines = self.shape.body.shape
        space = self.seen.half_space(self.hardness)
        stride = self.scanned_stride
        step = stride // self.stride
        new = self._met(self.surface.heights.astype(bool) | self.surface.damaged)[::step]
        planes = self.planes[::step]
        runs: list[tuple[Any, Array, Array, Edges | None]] = []
        if not new.all():
            runs.append((~new, np.zeros((window, lines)), np.zeros(1), None))
        for first, stop in np.flatnonzero(np.diff(new, prepend=False, append=False)).reshape(-1, 2):
            rows = slice(first * stride, (stop - 1) * stride + window)
            runs.append((slice(first, stop), self._pressed[rows], planes[first:stop], self._edges_in(rows)))
        approaches = self.approaches[states]
        counts = list[scan.Counts]()
        single = False
        forces = np.empty((len(approaches), len(new)))
        for state, (at, under, felt, edges) in product(range(len(approaches)), runs):
            solved = self.seen.body, approaches[state], stride, rtol_for(self.accuracy), felt
            job = scan.ScanJob(space, Rows(under), *solved, edges=edges)
            found = scan.scan_forces(job, cache=self.cache, progress=self.progress)
            forces[state, at] = found.forces[0]
            counts.append(found.counts)
            single |= found.single
        scan.warn_of_flaws(scan.total(counts), "the raceway", "accuracy")
        return ScannedForces(forces, scan.total(counts), single)

    def table_in(self, states: slice) -> ForceTable:
        """The scan in some states, to look forces up in; the last one is held."""
        asked = states.start, states.stop
        if asked not in self._tables:
            self._tables.clear()
            self._tables[asked] = self._tabled(states)
        return self._tables[asked]

    @cached_property
    def _tables(self) -> dict[tuple[int, int], ForceTable]:
        return {}

    def _tabled(self, states: slice) -> ForceTable:
        forces = self.scanned_in(states).forces
        if self.smooth:
            forces = self._between(forces, states)
        apart = self.rows // forces.shape[1]
        step = apart * self.surface.spacing[0]
        touches = self._around(self.touches[:: apart // self.stride], OVERLAP)
        closed = self._around(forces, OVERLAP, axis=1)
        return ForceTable(closed, self.approaches[states], -OVERLAP * step, step, touches)

    def _between(self, forces: Array, states: slice) -> Array:
        """Forces at all positions, N, of those scanned: between they follow averages under the patch."""
        approaches = self.approaches[states]
        axes = [self.contact.semi_axes_under(each) for each in forces.mean(axis=1)]
        higher = self.averaged(self.surface.heights, axes)[:, self.positions] - self.planes
        overlap = np.maximum(approaches[:, None] + higher, 0.0)
        return forces_between(forces, self.contact.stiffness_constant * overlap**1.5)

    def states_under(self, least: float, most: float) -> slice:
        """States that are visited under loads between two, N, as far as is known before."""
        forces = self.contact.stiffness_constant * np.maximum(self.approaches, 0.0) ** 1.5
        return states_expected(self.approaches, forces, np.array([least, most]))

    def wider(self, scanned: slice, least: float, most: float) -> slice:
        """States for a motion with forces between two, N, anywhere, too, by the table of those scanned."""
        table = self.table_in(scanned)
        root = np.cbrt(table.forces) ** 2
        low = place_between(float(np.cbrt(least)) ** 2, root.max(axis=1), table.approaches)
        high = place_between(float(np.cbrt(most)) ** 2, root.min(axis=1), table.approaches)
        needed = states_around(self.approaches, (low, high))
        return slice(min(scanned.start, needed.start), max(scanned.stop, needed.stop))

    def _texture(self, heights: Array, states: Array | None = None) -> StateTexture:
        """Heights (k, rows) of states (k,), m, as laws take them: closed, positive away from contact."""
        closed = -self._around(np.atleast_2d(heights), OVERLAP, axis=1)
        dx = self.surface.spacing[0]
        return StateTexture(closed, np.zeros(1) if states is None else states, -OVERLAP * dx, dx)

    @cached_property
    def ensemble(self) -> StiffnessEnsemble | None:
        """Loading curves over places of a rough raceway; None of one that is smooth under the contact."""
        heights = self.surface.heights
        shape = self.shape.body.shape
        if not heights.any():
            return None
        weights = punch_weights(self.surface.spacing, self.axes)
        rtol = rtol_for(self.accuracy)
        samples = patches([heights], (shape[0], shape[1]), SAMPLES, weights)
        pressed = self.space, self.shape.body, self.approaches, 0.0
        return stiffness_ensemble(samples, *pressed, rtol=rtol, tolerance="accuracy")

    @cached_property
    def curve(self) -> ForceCurve:
        """Force over approach: Hertz, or the mean over places of a rough raceway."""
        if self.ensemble is None:
            return ForceCurve.hertz(self.contact.stiffness_constant)
        return self.ensemble.curve

    @property
    def datum(self) -> float:
        """d₀, m, with which all states are positive in contact: minus the first touch of any place."""
        lowest = -reducing.LEAST_DATUM if self.ensemble is None else float(self.touches.min())
        return -min(lowest, self.curve.first_touch, -reducing.LEAST_DATUM)

    @cached_property
    def loaded(self) -> reducing.FilteredStates:
        """States that carry load, and their mean forces."""
        forces = self.curve.force(self.approaches)
        carries = forces > 0.0
        approaches = self.approaches[carries]
        return reducing.FilteredStates(approaches, forces[carries], self.curve.stiffness(approaches))

    @cached_property
    def filters(self) -> dict[Normalise, LineFilter]:
        """Contact filters in all states that carry load, from pieces of the raceway, by normalisation."""
        rows = len(self.shape.body)
        beyond = round(FILTER_LENGTH * self.axes[0] / self.surface.spacing[0])
        around = np.arange(min(rows + beyond, self.rows))
        rough = self.surface.heights
        firsts = np.arange(FILTER_STRIPS) * self.rows // FILTER_STRIPS
        strips = [HeightMap(rough[(first + around) % self.rows], self.surface.spacing) for first in firsts]
        found, counts = reducing.filters_of(
            strips, self.shape, self.loaded, get_args(Normalise), hardness=self.hardness,
            accuracy=self.accuracy, most=self.rows - 1, progress=self.progress,
        )  # fmt: skip
        scan.warn_of_flaws(counts, "the filters", "accuracy")
        return dict(found)

    def warn_of_faults(self, laws: Sequence[str]) -> None:
        """Say how far laws that give a fault one height are off over it, under other loads than theirs."""
        felt = self.over_faults[self.positions]
        told = list[str]()
        worst = 0.0
        at = int(np.argmax(np.abs(felt)))
        for share in OTHER_LOADS:
            approach = self.contact.approach(share * self.load) - felt[at]
            followed = share * self.load
            gap, edges = self._over(at)
            solved = self.space.solve(gap, approach, rtol=rtol_for(self.accuracy), edges=edges)
            worst = max(worst, abs(followed / solved.force - 1.0) if solved.force else 1.0)
            told.append(f"{in_newtons(followed)} where the solved contact has {in_newtons(solved.force)}")
        holds, have = ("hold", "they have") if len(laws) > 1 else ("holds", "it has")
        message = (
            f"At a fault {' and '.join(laws)} {holds} for a contact under {in_newtons(self.load)}; else "
            f"{have} {', and '.join(told)}. The law table has no such limit."
        )
        grade = Grade.WARNING if worst > FAULT_OFF else Grade.NOTE
        OutOfRangeWarning.warn(message, grade)

    # --- laws

    def build(self, name: str, states: slice | None = None) -> Periodic:
        """A law by its name, of materials of the raceway, once around; what is looked up of some states."""
        return Periodic(
            built(self._materials(spec_of(name), self.surface, states)), self.surface.circumference
        )

    def with_ball(self, law: Periodic, ball: Raceway, *, forwards: bool) -> Periodic:
        """A law of both surfaces with a ball, whose spots come up as positions rise, or against them."""
        surface = ball.on_cells(self.surface.spacing, self.shape.body.shape[1], forwards=forwards)
        on_ball = built(self._materials(spec_of(law.name), surface))
        assert isinstance(on_ball, PairedLaw)
        radius = ball.circumference / (2.0 * math.pi) * (1.0 if forwards else -1.0)
        return replace(law, ball=on_ball, radius=radius)

    def _materials(self, law: LawSpec, surface: Raceway, states: slice | None = None) -> Materials:
        """Materials of a law over a surface on the cells of the raceway: its heights; all else is its own."""
        approach = self.contact.approach(self.load)
        half = len(self.shape.body) // 2 + 1
        made_by: dict[str, Callable[[], Any]] = {
            "line": lambda: self._line(law),
            "curve": lambda: self.curve,
            "datum": lambda: self.datum,
            "areal": self._areal,
            "plane": lambda: self._texture(self.felt),
            "table": lambda: self.table_in(states or slice(0, len(self.approaches))),
            "heights": lambda: self.pressed(surface.heights + surface.line[:, None], half),
        }
        edges = surface.edges
        if surface.faults.any() or edges:
            made_by["faults"] = lambda: self._around(surface.faults, half)
        if edges:
            made_by["edges"] = lambda: edges.rearranged(lambda field: self._around(field, half))
        own = self.parameters.get(law.name) or {n: each.default for n, each in law.parameters.items()}
        return Materials(
            law, self.damping, self.load, self.contact.stiffness_constant, self.contact.modulus,
            (approach, self.contact.tangent_stiffness(approach)), -half * surface.spacing[0], self.seen.body,
            surface.spacing, self.hardness, rtol_for(self.accuracy), own, made_by, cells=self.seen.cells,
            remedies=REMEDIES,
        )  # fmt: skip

    def _line(self, law: LawSpec) -> StateTexture:
        """The middle line with the heights of faults, through the contact filter of a law that needs it."""
        line = self.wavy[:, self.wavy.shape[1] // 2]
        if Need.FILTER not in law.needs:
            return self._texture(line + self.over_faults)
        found = self.filters[reducing.normalisation(None, law)]
        if self.ensemble is not None:  # of a smooth raceway they are exact
            reducing.warn_of_filter(found, law.name, float(self.curve.inverse(self.load)), has_keys=False)
        reach = found.taps.shape[1]
        filtered = filtered_texture(
            self._around(line, reach), found.spacing, found.taps, found.contact_filter.approaches
        )
        return self._texture(self.over_faults - filtered.heights[:, reach:-reach], filtered.approaches)

    def _areal(self) -> StateTexture:
        """Heights averaged under the patch of each state that carries load."""
        axes = [self.contact.semi_axes_under(each) for each in self.loaded.forces]
        texture = self._texture(self.averaged(self.wavy, np.array(axes)), self.loaded.approaches)
        return texture.with_fewer_states(0.0)  # one where it is alike in all of them, as of a smooth raceway


def raceway_laws(
    names: Iterable[str],
    contact: Hertz,
    surface: Raceway,
    load: float,
    *,
    balls: Sequence[Raceway] = (),
    forwards: bool = True,
    **of_contact: Any,
) -> dict[str, Any]:
    """Laws of a ball on a raceway, on positions along it of any number of turns, m.

    Parameters
    ----------
    names : iterable of str
        Of `asperity.laws`, built in or registered.
    contact : Hertz
        Smooth contact of ball and raceway, x along the path.
    surface : Raceway
        From `asperity.scenarios.raceway_grids.raceway_on` for this contact and load.
    load : float
        Largest static load of a ball, N. States go up to eight times as much where the raceway is sound;
        beyond the last state F^(2/3) of `table` goes on with its end slope, the curve of `areal` with its.
    balls : sequence of Raceway, optional
        Surfaces of the balls, on any cells; `direct` lays each on those of the raceway.
    forwards : bool
        Whether these balls roll towards higher positions on the raceway.
    **of_contact
        Damping, hardness, accuracy, cache and progress, as of `OnRaceway`.

    Returns
    -------
    dict of str to Law
        By name. An approach δ of ring and ball sees a surface that is higher by h as δ + h. With balls a law
        of both surfaces, as `direct`, is a list of laws, one for each, as
        `asperity.rolling.bearing.roll_bearing` takes it: on positions (n, 2), on the raceway, m, and the
        angle of the spot of the ball that touches, rad.

    Notes
    -----
    `table` holds the solved contact with roughness and faults; long waves move it up and down. `areal`
    follows the average under the patch, `hertz` the middle line. These, and all others that do not see the
    rough contact itself, take a fault as the height that it has for the contact under the load
    (`OnRaceway.over_faults`): exact there, and off under other loads.
    """
    return laws_on(
        OnRaceway(contact, surface, positive("load of a ball (N)", load), **of_contact),
        names,
        balls=balls,
        forwards=forwards,
    )


def doubt_faults(on: OnRaceway, laws: Sequence[LawSpec]) -> None:
    """Warn of faults on a raceway that some of these laws give one height."""
    blind = [law.name for law in laws if not law.sees_heights]
    if on.surface.damaged.any() and blind:
        on.warn_of_faults(blind)


def laws_on(
    on: OnRaceway, names: Iterable[str], *, balls: Sequence[Raceway] = (), forwards: bool = True
) -> dict[str, Any]:
    """Laws of a ball on a raceway by their names, as from `raceway_laws`; `table` is that of all states."""
    chosen = [spec_of(name) for name in names]
    doubt_faults(on, chosen)
    beside_balls = replace(on, balls=balls)
    laws: dict[str, Any] = {}
    for law in chosen:
        if balls and law.both_surfaces:
            alone = beside_balls.build(law.name)
            laws[law.name] = [beside_balls.with_ball(alone, ball, forwards=forwards) for ball in balls]
        else:
            laws[law.name] = on.build(law.name)
    return laws
