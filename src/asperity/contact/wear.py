"""Wear: what the friction of a rolling contact takes from a surface, pass by pass."""

import math
import sys
import warnings
from dataclasses import dataclass, fields, is_dataclass
from functools import partial
from typing import Any, NamedTuple, Protocol

import numpy as np

from asperity.arguments import (
    Array,
    ArrayLike,
    Flags,
    Indices,
    Integers,
    finite_array,
    positive,
    real,
    require,
    two,
    whole,
)
from asperity.contact.friction import SlidingContact, cell_places
from asperity.contact.pressed import at_load
from asperity.contact.scan import Counts, check_settings, check_window, heights_on, total, warn_of_flaws
from asperity.contact.tangential import SPIN_AHEAD, FrictionalHalfSpace
from asperity.errors import OutOfRangeWarning, UnconvergedWarning
from asperity.kernels.scanning import TRUNCATED
from asperity.progress import Progress
from asperity.store import Store, content_key
from asperity.surfaces.heightmap import HeightMap
from asperity.threads import refuse_to_go_on
from asperity.written_numbers import rounded

REGIMES = ("mild", "severe", "catastrophic")
"""Of wear, as a law tells them apart."""
ROUGHNESS_SHARE, PRESSURE_SHARE = 0.1, 0.25
"""Depth of an update: at most this share of the rms height, and of one whose shortest wave takes the pressure
away (chosen here; Euler's steps are stable to 4/π of it)."""


class Rubbing(NamedTuple):
    """What rubs on the material beneath each cell while the contact rolls on by a cell."""

    work: Array
    """Friction work over rolled distance and area, (nx, ny), Pa."""
    pressure: Array
    """Mean of that before and after, (nx, ny), Pa."""
    sliding: Array
    """Sliding distance over the rolled one, (nx, ny)."""
    speed: float
    """Rolling speed, m/s."""


def rubbing(rolling: FrictionalHalfSpace, contact: SlidingContact, before: SlidingContact) -> Rubbing:
    """What rubs in a step from a state before to a contact; in steady rolling they are one.

    Traction is the mean of that before and after at the same material, also where that leaves the contact: so
    the work of a steady state is that of its forces, however coarse the grid.
    """
    dx = rolling.half_space.spacing[0]
    x, y = cell_places(rolling.half_space)
    now, past = (each.traction[0] + 1j * each.traction[1] for each in (contact, before))
    moved = rolling.displacement(now, contact.normal.pressure)
    moved = moved - rolling.displacement(past, before.normal.pressure, dx)
    xi, eta, spin = contact.creepage
    slip = xi + 1j * eta + spin * (1j * (x + SPIN_AHEAD * dx) - y) + moved / dx
    traction = now.copy()
    pressure = contact.normal.pressure.copy()
    traction[:-1] += past[1:]
    pressure[:-1] += before.normal.pressure[1:]
    work = -0.5 * (traction.conj() * slip).real
    sliding = np.abs(slip) * (pressure > 0.0)
    return Rubbing(work, 0.5 * pressure, sliding, contact.speed)


class WearLaw(Protocol):
    """What rubbing takes from one of the bodies: a frozen dataclass, whose fields name what is kept."""

    def removal(self, rubbing: Rubbing) -> tuple[Array, Indices]:
        """Depth over rolled distance (nx, ny), and the place in `REGIMES` of each cell (nx, ny)."""


@dataclass(frozen=True)
class EnergyWear:
    """Mass that friction work removes: in proportion while mild, then none more, then in proportion again.

    Parameters
    ----------
    mild : float
        Mass over friction work, kg/J.
    plateau : float
        Largest mass over rolled distance and area before wear is catastrophic, kg/m³; infinite without one.
    onset : float
        Friction work over rolled distance and area, Pa, from which wear is catastrophic; infinite if never.
    catastrophic : float
        Mass over friction work beyond it, kg/J.
    density : float
        Of what is worn, kg/m³.

    Raises
    ------
    InputError
        For numbers that are not above zero, or a catastrophic wear that begins before the plateau.

    Notes
    -----
    F. Braghin, R. Lewis, R. S. Dwyer-Joyce, S. Bruni, Wear 261 (2006) 1253: with Tγ/A the friction work
    over rolled distance and area, 5.3 Tγ/A µg/(m mm²) below 10.4 N/mm², 55.0 up to 77.2 N/mm², and a slope
    of 61.9 beyond; that it goes on from the plateau is chosen here. Of wheels of R8T on rails of UIC 900A,
    dry, from twin discs, whose Tγ/A is the mean of a contact; here it is that of each cell.

    Examples
    --------
    >>> from asperity import EnergyWear
    >>> wheel = EnergyWear()
    >>> f"{wheel.mild / wheel.density * 1e12:.2f} mm³ from a kilojoule"
    '0.68 mm³ from a kilojoule'
    """

    mild: float = 5.3e-9
    plateau: float = 0.055
    onset: float = 77.2e6
    catastrophic: float = 61.9e-9
    density: float = 7850.0

    def __post_init__(self) -> None:
        _check_numbers(self, ("plateau", "onset"))
        least = self.plateau / self.mild
        allowed = "friction work at which the plateau is reached"
        require(
            self.onset >= least, "onset", f"{self.onset:g} Pa", f"at least the {least:.4g} Pa of {allowed}"
        )

    def removal(self, rubbing: Rubbing) -> tuple[Array, Indices]:
        """As in `WearLaw`."""
        work = rubbing.work
        beyond = self.catastrophic * np.maximum(work - self.onset, 0.0)
        mass = np.minimum(self.mild * work, self.plateau) + beyond
        regime = (self.mild * work > self.plateau).astype(np.intp) + (work > self.onset)
        return mass / self.density, regime


@dataclass(frozen=True)
class ArchardWear:
    """Archard's law: depth k p s/H for a sliding distance s under a pressure p.

    Parameters
    ----------
    hardness : float
        H of what is worn, Pa.
    mild, severe, catastrophic : float
        k in each regime, without unit.
    velocities : (float, float)
        Slip velocities between which wear is severe, m/s; the contact's rolling speed makes them of its slip.
    limit : float
        Pressure over hardness above which it is catastrophic.

    Raises
    ------
    InputError
        For numbers that are not above zero.

    Notes
    -----
    Regimes and coefficients as in the wear map of T. Jendel, Wear 253 (2002) 89, for wheels on dry rails:
    1 to 10, 30 to 40 and 300 to 400, times 1e-4; the middles are the defaults. A border between regimes
    crosses cells: each wears by the shares of it on either side, where pressure and slip are linear as those
    of its neighbours in contact tell. With 6, 9 and 13 cells in the half-width of a contact the volume that
    is removed is within 2.4, 1.1 and 0.5 %; by whole cells 7.6, 5.7 and 4.9 %. The regime is told of the
    middle of a cell.

    Examples
    --------
    >>> from asperity import ArchardWear
    >>> ArchardWear(hardness=3e9).severe
    0.0035
    """

    hardness: float
    mild: float = 5.5e-4
    severe: float = 35e-4
    catastrophic: float = 350e-4
    velocities: tuple[float, float] = (0.2, 0.7)
    limit: float = 0.8

    def __post_init__(self) -> None:
        _check_numbers(self, ())
        two("velocities", self.velocities, "two slip velocities, m/s")
        finite_array(
            "velocities", self.velocities, "rising velocities of at least 0, m/s", rising=True, at_least=0.0
        )

    def removal(self, rubbing: Rubbing) -> tuple[Array, Indices]:
        """As in `WearLaw`."""
        slow, fast = (each / rubbing.speed for each in self.velocities)
        limit = self.limit * self.hardness
        touching = rubbing.pressure > 0.0
        regime = ((rubbing.sliding > slow) & (rubbing.sliding < fast)).astype(np.intp)
        regime[rubbing.pressure > limit] = 2
        faster, fastest = (_share_above(rubbing.sliding, each, touching) for each in (slow, fast))
        beyond = _share_above(rubbing.pressure, limit, touching)
        factor = self.mild + (self.severe - self.mild) * (faster - fastest)
        factor += (self.catastrophic - factor) * beyond
        return factor * rubbing.pressure * rubbing.sliding / self.hardness, regime


_STRIPS = (np.arange(8) - 3.5) / 8
"""Middles of strips of a cell, of whose shares above a limit the mean is taken."""


def _share_above(values: Array, limit: float, touching: Flags) -> Array:
    """Share of each cell (nx, ny) in which a quantity exceeds a limit, if it is linear across the cell."""
    rises = [_rise(values, touching, axis) for axis in (0, 1)]
    steep = np.maximum(*rises)
    gentle = np.minimum(*rises)
    above = values - limit
    level = (above[..., None] + gentle[..., None] * _STRIPS) / np.where(steep > 0.0, steep, 1.0)[..., None]
    return np.where(steep > 0.0, np.clip(0.5 + level, 0.0, 1.0).mean(axis=-1), above > 0.0)


def _rise(values: Array, touching: Flags, axis: int) -> Array:
    """Size of the change of a quantity (nx, ny) across a cell along an axis, by neighbours in contact."""
    values = np.moveaxis(values, axis, 0)
    touching = np.moveaxis(touching, axis, 0)
    both = touching[1:] & touching[:-1]
    step = np.diff(values, axis=0) * both
    rise = np.zeros_like(values)
    count = np.zeros_like(values)
    for side in (slice(1, None), slice(None, -1)):
        rise[side] += step
        count[side] += both
    return np.moveaxis(np.abs(rise) / np.maximum(count, 1.0), 0, axis)


def _check_numbers(law: Any, endless: tuple[str, ...]) -> None:
    for each in fields(law):
        value = getattr(law, each.name)
        if each.type in ("float", float) and not (each.name in endless and value == math.inf):
            positive(f"{each.name} of {type(law).__name__}", value)


def _check_law(law: object) -> None:
    allowed = "an object with removal(rubbing), as asperity.EnergyWear()"
    is_law = hasattr(law, "removal") and not isinstance(law, type)
    require(is_law, "law of wear", type(law).__name__, allowed)


def _removal(law: WearLaw, rubs: Rubbing) -> tuple[Array, Indices]:
    """What a law removes; it may be anyone's."""
    what = f"removal of {type(law).__name__}"
    shape = rubs.work.shape
    last = len(REGIMES) - 1
    allowed = f"depth over rolled distance, finite, and whole regimes from 0 to {last}, two arrays {shape}"
    depth, regimes = two(what, law.removal(rubs), allowed)
    rate = finite_array(what, depth, allowed, shape=shape)
    regime = np.asarray(regimes)
    known = regime.shape == shape and regime.dtype.kind in "biu" and np.isin(regime, range(last + 1)).all()
    require(known, what, f"regimes of {regime.dtype}, shape {regime.shape}", allowed)
    return rate, regime.astype(np.intp)


def wear_depth(rolling: FrictionalHalfSpace, contact: SlidingContact, law: WearLaw) -> Array:
    """Depth that each line along the rolling direction loses as a steadily rolling contact passes once.

    Parameters
    ----------
    rolling : FrictionalHalfSpace
        Bodies and friction.
    contact : SlidingContact
        As its `roll` finds it, rolling steadily.
    law : WearLaw
        For the body that is worn: `EnergyWear`, `ArchardWear` or one of your own.

    Returns
    -------
    ndarray (ny,)
        Depth, m. Of a wheel that loses it once in a turn, of a rail at each wheel.

    Raises
    ------
    InputError
        For a contact that does not roll.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import EnergyWear, FrictionalHalfSpace, HalfSpace, material, wear_depth
    >>> steel, x = material("steel"), 0.4e-3 * (np.arange(32) - 15.5)
    >>> wheel = np.add.outer(x**2, x**2) / (2 * 0.4)
    >>> space = HalfSpace(wheel.shape, 0.4e-3, 0.5 * 210e9 / (1 - 0.3**2))
    >>> rolling = FrictionalHalfSpace(space, (steel, steel), 0.3)
    >>> braked = rolling.roll(space.solve(wheel, load=50e3), creepage=(0.003, 0.0))
    >>> f"{wear_depth(rolling, braked, EnergyWear()).max() * 1e9:.1f} nm in a pass"
    '4.2 nm in a pass'
    """
    _check_law(law)
    here = isinstance(contact, SlidingContact) and contact.normal.half_space is rolling.half_space
    require(here, "contact", "none of these bodies", "one that their roll returns")
    require(contact.speed > 0.0, "contact", "one that was shifted, or stands", "one that rolls, at a speed")
    depth, _ = _removal(law, rubbing(rolling, contact, contact))
    return depth.sum(axis=0) * rolling.half_space.spacing[0]


@dataclass(frozen=True, eq=False)
class WornSurface:
    """A surface after passes, and what they took from it.

    Attributes
    ----------
    surface : HeightMap
        What is left.
    depth : ndarray (n, ny)
        By which it is lower, m.
    passes : ndarray (updates,)
        Passes that each solved pass stands for.
    volume : ndarray (updates, 3)
        Removed by all of them in each of `REGIMES`, m³.
    work : ndarray (updates,)
        Friction work of all of them, J.
    counts : Counts
        Contacts solved, and how they went.
    """

    surface: HeightMap
    depth: Array
    passes: Integers
    volume: Array
    work: Array
    counts: Counts

    @property
    def removed(self) -> float:
        """Volume removed, m³."""
        return float(self.volume.sum())

    @property
    def shares(self) -> dict[str, float]:
        """Share of it in each regime."""
        found = self.volume.sum(axis=0) / (self.removed or 1.0)
        return dict(zip(REGIMES, found.tolist(), strict=True))


class _Wearing(NamedTuple):
    """All that the wear depends on, beside the heights."""

    bodies: FrictionalHalfSpace
    law: WearLaw
    body: Array
    load: Array  # (positions,), N
    motion: tuple[float, ...]  # creepage along, across, and spin
    speed: float
    passes: int
    step: float
    rtol: float

    def key(self, heights: Array) -> str:
        """Name in the store of what these heights become."""
        space = self.bodies.half_space
        friction = self.bodies.friction
        bodies = [self.bodies.shear_modulus, self.bodies.poisson_ratio, self.bodies.unlikeness]
        parameters = [list(space.spacing), space.modulus, space.hardness, bodies, self.bodies.coupled]
        parameters += [] if space.cells == "whole" else [space.cells]
        with np.printoptions(threshold=sys.maxsize, floatmode="unique"):  # maps in full
            parameters += [repr(friction), repr(self.law), list(self.motion), *self[5:]]
        return content_key("worn", heights, self.body, self.load, np.asarray(friction.static), parameters)


def worn(
    rolling: FrictionalHalfSpace,
    surface: ArrayLike | HeightMap,
    body: ArrayLike,
    load: float | ArrayLike,
    law: WearLaw,
    creepage: tuple[float, float] = (0.0, 0.0),
    spin: float = 0.0,
    passes: int = 1,
    *,
    closed: bool = False,
    speed: float = 1.0,
    step: float | None = None,
    rtol: float = 1e-6,
    cache: Store | None = None,
    progress: Progress | None = None,
) -> WornSurface:
    """Roll a body over a surface that its friction wears, row by row, and as often as asked.

    Parameters
    ----------
    rolling : FrictionalHalfSpace
        Grid of the window, bodies and friction.
    surface : HeightMap, or array_like (n, ny)
        Heights, m, peaks positive, on the half-space's spacing; the first axis is the rolling direction.
    body : array_like (nx, ny)
        Shape of the body that rolls, m, zero at its lowest point. It stays as it is.
    load : float or array_like (positions,)
        Load, N; one for each position of the body's window, n − nx + 1 or, of a closed surface, n.
    law : WearLaw
        Of the surface: `EnergyWear`, `ArchardWear` or one of your own.
    creepage, spin : (float, float), float
        As in `FrictionalHalfSpace.roll`.
    passes : int
        How often it rolls over the surface, each time alike.
    closed : bool
        Whether the surface goes on from its beginning, as around a wheel or in whole waves: then each place
        is passed in full. If not, those within a window of either end stand out more and more.
    speed : float
        Rolling speed, m/s.
    step : float, optional
        Largest depth, m, between two solutions: a solved pass stands for as many as remove this. By default
        a tenth of the rms height, but no more than the pressure can follow.
    rtol : float
        Tolerance of each solution.
    cache, progress : optional
        As in `HalfSpace.scan`: passes that were interrupted go on after the last one kept.

    Returns
    -------
    WornSurface
        What is left, and what is not.

    Raises
    ------
    InputError
        For sizes that do not fit, or input that has no meaning.

    Notes
    -----
    Each position is one step of a transient, from steady rolling at the first. What a cell removes in it is
    taken from the place beneath.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import EnergyWear, FrictionalHalfSpace, HalfSpace, material, worn
    >>> steel, x = material("steel"), 0.4e-3 * (np.arange(32) - 15.5)
    >>> wheel = np.add.outer(x**2, x**2) / (2 * 0.4)
    >>> space = HalfSpace(wheel.shape, 0.4e-3, 0.5 * 210e9 / (1 - 0.3**2))
    >>> rolling, rail = FrictionalHalfSpace(space, (steel, steel), 0.3), np.zeros((40, 32))
    >>> after = worn(rolling, rail, wheel, 50e3, EnergyWear(), (0.003, 0.0), passes=1000)
    >>> f"{after.removed * 1e9:.2f} mm³ from {after.work.sum() / 1e3:.2f} kJ"
    '0.11 mm³ from 0.16 kJ'
    """
    _check_law(law)
    known = isinstance(rolling, FrictionalHalfSpace)
    require(known, "bodies that roll", type(rolling).__name__, "a half-space with two bodies and friction")
    given = (*two("creepage", creepage, "two numbers"), spin)
    space = rolling.half_space
    motion = tuple(real("creepage", each, "finite numbers") for each in given)
    heights = heights_on(space, surface, "surface to be worn")
    shape = space.shape
    shape_of = finite_array("body that wears", body, f"lengths in m, an array {shape}", shape=shape)
    check_window("wear", shape, heights.shape)
    check_settings(None, cache, progress)
    kept = cache is None or is_dataclass(law)
    require(kept, "law of wear", "one without fields to keep it by", "a frozen dataclass, or no cache")
    positions = len(heights) if closed else len(heights) - shape[0] + 1
    allowed = f"a force above 0, N, or one for each of {positions} positions"
    loads = finite_array("load", load, allowed, above=0.0)
    require(loads.shape in ((), (positions,)), "load", f"an array of shape {loads.shape}", allowed)
    loads = np.broadcast_to(loads, positions).copy()
    space.checked_load(float(loads.max()))
    speed = positive("rolling speed", speed)
    passes = whole("passes", passes, "a whole number from 1 to 1e12", at_least=1, at_most=1e12)
    rtol = real("rtol", rtol, "a number between 0 and 1, as 1e-6", above=0.0, below=1.0)
    if step is None:
        smooth = at_load(space, shape_of, float(loads.mean()), None, 1e-4)
        step = PRESSURE_SHARE * smooth.force / smooth.area * min(space.spacing) / space.modulus
        step = min(step, ROUGHNESS_SHARE * float(heights.std()) or step)
    step = positive("step", step)
    job = _Wearing(rolling, law, shape_of, loads, motion, speed, passes, step, rtol)
    depth, solved = _passed(heights, job, cache, progress)
    counts = Counts(*solved[:, 6:].sum(axis=0).astype(int).tolist())
    warn_of_flaws(counts, "wear", "rtol", "Enlarge the window.", "its wear too small")
    deepest = float(solved[:, 1].max())
    if deepest > step:
        OutOfRangeWarning.warn(
            f"a single pass removes {rounded(1e9 * deepest)} nm, more than the {rounded(1e9 * step)} nm "
            "after which the contact is solved again: its pressure does not follow what it removes. Lower "
            "the creepage, or allow for larger steps."
        )
    origin = f"{surface.source}; " if isinstance(surface, HeightMap) and surface.source else ""
    left = HeightMap(heights - depth, space.spacing, f"{origin}worn by {passes} passes")
    return WornSurface(left, depth, solved[:, 0].astype(np.int64), solved[:, 2:5], solved[:, 5], counts)


def _passed(
    heights: Array, job: _Wearing, cache: Store | None, progress: Progress | None
) -> tuple[Array, Array]:
    """Depth after all passes, and a row (10,) of each that was solved; those the cache knows are not rolled.

    How many it stands for, its largest depth, by all of these the volumes and the work, and its counts.
    """
    key = "" if cache is None else job.key(heights)
    state = (cache.get(key) if cache is not None else None) or {
        "depth": np.zeros(heights.shape),
        "solved": np.empty((0, 10)),
    }
    while (done := int(state["solved"][:, 0].sum())) < job.passes:
        message = f"wear, pass {done + 1} of {job.passes}"
        depth, volume, work, counts = _pass(heights - state["depth"], job, progress, message)
        deepest = max(float(depth.max()), np.finfo(float).tiny)
        left = job.passes - done
        alike = max(int(min(job.step / deepest, left)), 1)
        row = [alike, deepest, *(alike * volume), alike * work, *counts]
        state = {"depth": state["depth"] + alike * depth, "solved": np.vstack([state["solved"], row])}
        if cache is not None:
            cache.put(key, state)
    return state["depth"], state["solved"]


def _pass(
    heights: Array, job: _Wearing, progress: Progress | None, message: str
) -> tuple[Array, Array, float, Counts]:
    """Depth of one pass, its volume by regime, its friction work, and how its contacts went."""
    space = job.bodies.half_space
    rows = job.body.shape[0]
    counts = []
    tell = progress or (lambda *_: None)
    distance = space.spacing[0]
    along, across, spin = job.motion
    depth = np.zeros(heights.shape)
    volume = np.zeros(len(REGIMES))
    work = 0.0
    start = None
    before: SlidingContact | None = None
    positions = len(job.load)
    lead_in = rows if positions == len(heights) else 0  # a closed surface has been rolled over before
    for first in range(-lead_in, positions):
        refuse_to_go_on()
        tell(max(first, 0), positions, message)
        under = np.arange(first, first + rows) % len(heights)
        contact = at_load(space, job.body - heights[under], float(job.load[first]), start, job.rtol)
        with warnings.catch_warnings():  # those that did not converge are counted
            warnings.simplefilter("ignore", UnconvergedWarning)
            roll = partial(job.bodies.roll, contact, (along, across), spin, speed=job.speed, rtol=job.rtol)
            before = before or roll()
            after = roll(before=before)
        start = np.zeros_like(contact.pressure)
        start[:-1] = contact.pressure[1:]
        rubs = rubbing(job.bodies, after, before)
        before = after
        if first < 0:
            continue
        rate, regime = _removal(job.law, rubs)
        depth[under] += distance * rate
        volume += distance * space.cell_area * np.bincount(regime.ravel(), rate.ravel(), len(REGIMES))
        work += distance * space.cell_area * float(rubs.work.sum())
        flawed = not (contact.converged and after.converged)
        cut_off = contact.edge_share > TRUNCATED
        counts.append(Counts(1, contact.iterations, int(flawed), int(cut_off)))
    tell(positions, positions, message)
    return depth, volume, work, total(counts)
