"""The tangential problem of a contact that is known: shift, transient and steady rolling with friction."""

import math
import warnings
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from asperity import arguments
from asperity.arguments import Array, ArrayLike, Complex, NDArray, real, require
from asperity.contact.elastic_grid import box_around
from asperity.contact.friction import Friction, SlidingContact, cell_places, doubts
from asperity.contact.friction_work import with_work
from asperity.contact.halfspace import HalfSpace
from asperity.contact.periodic import refuse_period
from asperity.contact.pressed import at_load
from asperity.contact.solved import Contact
from asperity.contact.traction_rims import (
    Turn,
    free_slip,
    left_ahead,
    left_by,
    rows_ahead,
    slip_ahead,
    stored_energy,
    turn_at,
    with_patches,
)
from asperity.errors import ComputationError, Outcome, OutOfRangeWarning, UnconvergedWarning, percent
from asperity.kernels import traction as kernel
from asperity.kernels.fourier import smooth_length
from asperity.kernels.projected_cg import inverse_stencil
from asperity.kernels.traction_influence import (
    means_of_pressure,
    means_of_traction,
    pressure_displacement,
    traction_displacement,
)
from asperity.kernels.traction_rims import TractionRims, traction_rims
from asperity.reference.materials import Material
from asperity.written_numbers import rounded

MAX_ITERATIONS, MAX_ROUNDS = 300, 60
"""Of Newton's iteration, and of solutions whose bound, pressure or motion follows the last one."""
CARRIED, DIRECTIONS = 0.95, 16
"""Of steady rolling: share of a row's slip that the row ahead tells the preconditioner, found by trial, and
directions of search that are held."""
ROUNDS_AGREE, FORCES_AGREE = 1e-4, 1e-6
"""Change of the bound, and error of a force that is given, over the largest there is."""
LARGE_CREEPAGE = 0.05
"""Above this strains are no longer small."""
LAST_AGREE = 1e-5
"""The same of a search that ends."""
CLOSER = 0.1
"""Share of the tolerance of slip to which it is found where a force is given."""
NEWTON_LIKE = 10
"""Steps towards a force before every other one halves the interval that holds its creepage."""
SPIN_AHEAD = 1.0 / 6.0
"""Share of the rolled distance by which spin is counted ahead of a cell, as the program CONTACT does."""
SPIN_ON_MEANS = 0.5
"""On covered cells, the mean of the way: what slips on counts at its end, see `kernels.traction_rims`."""
Forces = tuple[float | None, float | None]


class _Manner(NamedTuple):
    """How two bodies move."""

    ahead: float  # rolled distance, m; zero for a shift
    steady: bool
    before: SlidingContact | None
    start: SlidingContact | None
    speed: float  # m/s
    rtol: float
    curvature: float = 0.0  # of the creepage along over places across, 1/m²

    @property
    def kernel(self) -> tuple[float, bool]:
        """How far ahead a traction is felt, and whether that is taken from what is felt here."""
        return (self.ahead if self.steady else 0.0), self.steady

    @property
    def step(self) -> float:
        """Over which slip is counted."""
        return self.ahead or 1.0


class FrictionalHalfSpace:
    """The tangential problem of two bodies on the grid of a half-space.

    Parameters
    ----------
    half_space : HalfSpace
        Grid and modulus. The contact rolls along the first axis: material enters at its upper end.
    bodies : (Material, Material)
        Of the half-space's modulus. Traction acts on the first, whose creepage counts against the second.
    friction : float, array_like (nx, ny) or Friction
        Coefficient of friction.
    coupled : bool
        Whether pressure and traction of unlike bodies act on each other, iterated under constant load until
        the bound changes by no more than 1e-4 of the largest. If not, a warning tells what is neglected.

    Raises
    ------
    InputError
        If the bodies have another modulus than the half-space.

    Notes
    -----
    Slip over a rolled distance δ is ``s = δ (ξ − χ y² − φ y, η + φ x) + u(x) − u'(x + δ)``, χ the curvature
    of the creepage and u' the displacement before, at the same material; in steady rolling u' is u. Traction
    is at most µ p, and opposite to the slip where there is any: J. J. Kalker, Three-Dimensional Elastic
    Bodies in Rolling Contact (1990). Small creepages, no inertia, nothing between the bodies.

    On whole cells the error of steady rolling is of first order in their length. On covered ones it is of
    second order (`asperity.kernels.traction_rims`): with six cells in the semi-axis of a smooth contact 0.2 %
    of the friction, for 3 %. Few rough contacts do not settle there, which a warning tells.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import FrictionalHalfSpace, HalfSpace, material
    >>> steel, x = material("steel"), 0.4e-3 * (np.arange(32) - 15.5)
    >>> wheel = np.add.outer(x**2, x**2) / (2 * 0.4)
    >>> space = HalfSpace(wheel.shape, 0.4e-3, 0.5 * 210e9 / (1 - 0.3**2))
    >>> rolling = FrictionalHalfSpace(space, (steel, steel), 0.3)
    >>> found = rolling.roll(space.solve(wheel, load=50e3), creepage=(0.001, 0.0))
    >>> found.converged, f"{-found.force[0] / found.limit:.2f}"
    (True, '0.50')
    """

    def __init__(
        self,
        half_space: HalfSpace,
        bodies: tuple[Material, Material],
        friction: float | ArrayLike | Friction,
        coupled: bool = True,
    ) -> None:
        allowed = 'two materials, as asperity.material("steel")'
        bodies = arguments.two("bodies", bodies, allowed)
        known = all(isinstance(each, Material) for each in bodies)
        require(known, "bodies", arguments.shown(bodies), allowed)
        refuse_period(half_space, "a contact with friction")
        self.half_space = half_space
        self.bodies = bodies
        self.coupled = coupled
        self.friction = friction if isinstance(friction, Friction) else Friction(friction)
        nu = np.array([body.poisson_ratio for body in bodies])
        compliance = 2.0 * (1.0 + nu) / np.array([body.youngs_modulus for body in bodies])  # 1/G
        total = float(compliance.sum())
        self.shear_modulus = 2.0 / total
        self.poisson_ratio = float(compliance @ nu) / total
        self.unlikeness = 0.25 * float(np.subtract(*((1.0 - 2.0 * nu) * compliance)))  # K/G, 1/Pa
        modulus = self.shear_modulus / (1.0 - self.poisson_ratio)
        shape = np.shape(self.friction.static)
        same = math.isclose(modulus, half_space.modulus, rel_tol=1e-6)
        allowed = f"the {half_space.modulus:.6g} Pa of the half-space"
        require(
            same, "modulus of the bodies", f"{modulus:.6g} Pa", allowed, "Take the same materials for both."
        )
        fits = shape in ((), half_space.shape)
        require(fits, "friction", f"a map of shape {shape}", f"a number, or a map {half_space.shape}")
        dx, dy = half_space.spacing
        x = dx * np.arange(32.0)[:, None]
        y = dy * np.arange(32.0)[None, :]
        along, across, _ = traction_displacement(x, y, dx, dy, self.poisson_ratio)
        own = along[0, 0]
        self._taps = inverse_stencil(0.5 * (along + across) / own)
        self._influences: dict[tuple[float, bool], tuple[Array, Complex, float]] = {}
        self._prepared: dict[tuple[int, int, float, bool, bool], kernel.TractionConvolution] = {}

    def shift(
        self,
        normal: Contact,
        shift: tuple[float, float] = (0.0, 0.0),
        rotation: float = 0.0,
        *,
        force: Forces = (None, None),
        before: SlidingContact | None = None,
        rtol: float = 1e-6,
    ) -> SlidingContact:
        """Shift the first body against the second.

        Parameters
        ----------
        normal : Contact
            The contact after the shift.
        shift : tuple of float
            Along and across, m, from the state before.
        rotation : float
            About the middle of the grid, rad.
        force : tuple of (float or None)
            On the first body, N, where it is given instead of a component of the shift.
        before : SlidingContact, optional
            Where the shift starts, as in a load that grows or turns back; by default without traction.
        rtol : float
            Largest slip that is against Coulomb's law, over the largest without traction.

        Returns
        -------
        SlidingContact
            With the shift as its creepage.

        Raises
        ------
        InputError
            For input that has no meaning, or a force that friction does not carry.
        """
        shift = arguments.two("shift", shift, "two lengths, m")
        return self._find(normal, (*shift, rotation), force, _Manner(0.0, False, before, before, 0.0, rtol))

    def roll(
        self,
        normal: Contact,
        creepage: tuple[float, float] = (0.0, 0.0),
        spin: float = 0.0,
        *,
        creepage_curvature: float = 0.0,
        distance: float | None = None,
        force: Forces = (None, None),
        before: SlidingContact | None = None,
        start: SlidingContact | None = None,
        speed: float = 1.0,
        rtol: float = 1e-6,
    ) -> SlidingContact:
        """Roll steadily, or over a distance from a state before: one step of a transient.

        Parameters
        ----------
        normal : Contact
            The contact, after the distance; in steady rolling it stays as it is.
        creepage : tuple of float
            Velocity of the first body against the second over the rolling speed, along and across.
        spin : float
            Likewise the turning velocity about the normal through the middle of the grid, 1/m.
        creepage_curvature : float
            By how much, over y², the creepage along is less at y across, 1/m²: of a ball in its groove, see
            `asperity.contact.groove_creepage`.
        distance : float, optional
            Over which slip is counted, m; by default the length of a cell. On covered cells a whole number of
            them, one in steady rolling.
        force : tuple of (float or None)
            On the first body, N, where it is given instead of a component of the creepage.
        before : SlidingContact, optional
            Where a transient starts, as ``shift(normal)`` without traction; by default it rolls steadily.
        start : SlidingContact, optional
            A solution nearby, as the last point of a creep curve.
        speed : float
            Rolling speed, m/s, for friction that falls with the slip velocity and for the power.
        rtol : float
            As in `shift`.

        Returns
        -------
        SlidingContact
            The state after the distance.

        Raises
        ------
        InputError
            For input that has no meaning, or a force that friction does not carry.
        """
        allowed = "a distance above 0, m"
        distance = self.half_space.spacing[0] if distance is None else distance
        distance = real("rolled distance", distance, allowed, above=0.0)
        speed = real("rolling speed", speed, "at least 0, m/s", at_least=0.0)
        curvature = real("curvature of the creepage", creepage_curvature, "a finite number, 1/m^2")
        manner = _Manner(distance, before is None, before, start or before, speed, rtol, curvature)
        creepage = arguments.two("creepage", creepage, "two numbers, along and across")
        return self._find(normal, (*creepage, spin), force, manner)

    def displacement(self, traction: Complex, pressure: Array, ahead: float = 0.0) -> Complex:
        """Displacement (nx, ny) of the first body against the second, m, x + iy, at places so far ahead, m.

        Under a traction x + iy (nx, ny), Pa, and, of unlike bodies that are coupled, a pressure (nx, ny), Pa.
        """
        nx, ny = self.half_space.shape
        convolution = self._convolution(nx, ny, ahead, False)
        box = kernel.traction_box(nx, ny, convolution)
        _cells(box.traction, box)[:] = traction
        kernel.convolve_traction(convolution, box.traction, nx, ny, box.pitch, box.work, box.response)
        found = _cells(box.response, box)
        if self._couples:
            found = found - _convolved(self._influence(ahead, False)[1], pressure)
        return found

    def _influence(self, ahead: float, steady: bool) -> tuple[Array, Complex, float]:
        """Of a cell on those around it, up to the width of the grid, so far ahead, m.

        In steady rolling that here, less that ahead. By traction: displacement along x by x, y by y and x by
        y (3, 2 nx - 1, 2 ny - 1), m/Pa. Of unlike bodies that are coupled: by pressure, displacement x + iy
        against it, which is the gap by a traction (2 nx - 1, 2 ny - 1). And its own by traction.
        """
        if (ahead, steady) not in self._influences:
            nx, ny = self.half_space.shape
            dx, dy = self.half_space.spacing
            beside = 1 if self._covers else 0  # means take cells beside them
            x = dx * np.arange(1.0 - nx - beside, nx + beside)[:, None] + ahead
            y = dy * np.arange(1.0 - ny - beside, ny + beside)[None, :]
            by_traction = means_of_traction if self._covers else traction_displacement
            by_pressure = means_of_pressure if self._covers else pressure_displacement
            found = by_traction(x, y, dx, dy, self.poisson_ratio)
            traction = np.array(found) / (math.pi * self.shear_modulus)
            spread = np.zeros((1, 1), complex)
            if self._couples:
                spread = self.unlikeness / math.pi * by_pressure(x, y, dx, dy)
            if steady:
                here, spread_here, _ = self._influence(0.0, False)
                traction = here - traction
                spread = spread_here - spread
            own = float(traction[:2, nx - 1, ny - 1].mean())
            self._influences[ahead, steady] = traction, spread, own
        return self._influences[ahead, steady]

    @property
    def _covers(self) -> bool:
        """Whether cells are covered in part."""
        return self.half_space.cells == "covered"

    @property
    def _sides(self) -> tuple[float, float]:
        """Sides of a cell over the shear modulus, m/Pa."""
        dx, dy = self.half_space.spacing
        return dx / self.shear_modulus, dy / self.shear_modulus

    @property
    def _couples(self) -> bool:
        """Whether pressure and traction act on each other."""
        return self.coupled and self.unlikeness != 0.0

    def _convolution(
        self, nx: int, ny: int, ahead: float, steady: bool, single: bool = False
    ) -> kernel.TractionConvolution:
        """Influence of tractions on a box; in single precision over what displaces a cell by its own.

        On as many cells as transforms of the same length hold, so that few boxes need one of their own.
        """
        nx, ny = (min(smooth_length(m), n) for m, n in zip((nx, ny), self.half_space.shape, strict=True))
        key = (nx, ny, ahead, steady, single)
        if key not in self._prepared:
            middle = self.half_space.shape
            traction, _, own = self._influence(ahead, steady)
            inside = (slice(m - n, m + n - 1) for m, n in zip(middle, (nx, ny), strict=True))
            kernels = traction[:, *inside] / (own if single else 1.0)
            dtype = np.float32 if single else np.float64
            self._prepared[key] = kernel.traction_convolution(kernels, nx, ny, dtype)
        return self._prepared[key]

    def _find(
        self, normal: Contact, motion: tuple[float, ...], force: Forces, manner: _Manner
    ) -> SlidingContact:
        """Check the input, find the components of the motion whose force is given, and look at the result."""
        here = getattr(normal, "half_space", None) is self.half_space
        require(here, "contact", "one on another half-space, or none", "one on this")
        for state in (manner.before, manner.start):
            fits = state is None or np.shape(getattr(state, "bound", 0.0)) == self.half_space.shape
            require(fits, "state before", "one on another grid", f"one on {self.half_space.shape}")
        real("rtol", manner.rtol, "a number between 0 and 1, as 1e-6", above=0.0, below=1.0)
        allowed = "two forces, N, or None where the motion is given"
        asked = enumerate(arguments.two("force", force, allowed))
        wanted = {i: real("force", f, allowed) for i, f in asked if f is not None}
        motion = tuple(real("creepage or shift", each, "a finite number") for each in motion)
        found = self._rounds(normal, motion, manner)
        if wanted:
            index = np.array(list(wanted))
            target = np.array(list(wanted.values()))
            found = self._under_force(normal, found, index, target, manner)
        if not found.converged:
            why = "let it fall over more slip velocity" if self.friction.falls else found.outcome.value
            words = f"friction at {found.creepage} did not converge: {why}"
            warnings.warn(words, UnconvergedWarning, stacklevel=3)
        self._doubt(found, manner)
        if self._covers and manner.ahead:
            stored = stored_energy(found, self.displacement, self._sides, self.poisson_ratio)
            found = replace(found, elastic_energy=stored)
        return with_work(found, manner.before, manner.ahead, self.displacement, self._couples)

    def _doubt(self, found: SlidingContact, manner: _Manner) -> None:
        """Warn of what is outside the range of the theory."""
        words = doubts(found, LARGE_CREEPAGE if manner.ahead else math.inf)
        if self.unlikeness and not self.coupled:
            neglected = abs(self.unlikeness) * self.shear_modulus / (1.0 - self.poisson_ratio)
            words.append(
                "The bodies are unlike, and that is neglected: a pressure displaces along the surface about "
                f"{percent(neglected)} of what it displaces into it. Take coupled = True."
            )
        for each in words:
            warnings.warn(OutOfRangeWarning(each), stacklevel=4)

    def _under_force(
        self, normal: Contact, found: SlidingContact, index: Array, target: Array, manner: _Manner
    ) -> SlidingContact:
        """Find a motion by Broyden's iteration on −ln(1 − |F|/limit), which is about linear in creepage."""
        size = float(np.linalg.norm(target))
        allowed = f"less than {rounded(found.limit, 6)} N of friction"
        remedy = "Press more, or ask for less."
        require(size < found.limit or size == 0.0, "force", f"{rounded(size, 6)} N", allowed, remedy)

        if not found.limit:
            return found

        def stretched(force: Array) -> Array:
            share = min(float(np.linalg.norm(force)) / found.limit, 1.0 - 1e-12)
            return force * (-math.log1p(-share) / share if share else 1.0)

        # a solution that starts close enough stays as it is: the force would not follow its creepage
        manner = manner._replace(rtol=CLOSER * manner.rtol)
        motion = np.array(found.creepage)
        softness = self._influence(*manner.kernel)[2] / (manner.step * normal.area)
        jacobian_inverse = -softness * np.eye(len(index))
        low = -math.inf
        high = math.inf
        longest = math.inf
        missing = stretched(np.array(found.force)[index]) - stretched(target)
        for done in range(MAX_ROUNDS):
            if np.abs(np.array(found.force)[index] - target).max() <= FORCES_AGREE * found.limit:
                return found
            change = -jacobian_inverse @ missing
            if len(index) == 1:  # a force falls with its creepage: stay between both sides
                at = float(motion[index[0]])
                low, high = (at, high) if missing[0] > 0.0 else (low, at)
                middle = 0.5 * (low + high)
                inside = low < at + change[0] < high
                # a few steps are enough, but where the force hardly changes until a line of cells turns
                if math.isfinite(middle) and not (inside and (done < NEWTON_LIKE or done % 2)):
                    change[0] = middle - at
                change[0] = math.copysign(min(abs(change[0]), longest), missing[0])
                longest = 4.0 * abs(change[0])
            motion[index] += change
            found = self._rounds(normal, tuple(motion.tolist()), manner._replace(start=found))
            after = stretched(np.array(found.force)[index]) - stretched(target)
            along = change @ jacobian_inverse
            moved = after - missing
            if along @ moved:
                jacobian_inverse += np.outer(change - jacobian_inverse @ moved, along) / (along @ moved)
            missing = after
        if np.abs(np.array(found.force)[index] - target).max() <= LAST_AGREE * found.limit:
            return found  # next to it slips change by less than they are found to
        problem = f"no creepage was found for a force of {rounded(size, 6)} N"
        raise ComputationError(problem, "a smaller force")

    def _rounds(self, normal: Contact, motion: tuple[float, ...], manner: _Manner) -> SlidingContact:
        """Solve until bound and pressure are those of the solution."""
        space = self.half_space
        before = manner.before
        velocity = np.zeros(space.shape)
        slipped = np.zeros(space.shape, dtype=bool)
        past = np.zeros(space.shape, complex)
        behind = np.zeros(space.shape)
        counts = np.zeros(2, dtype=int)
        if before is not None:
            rows = self._rows_ahead(manner)
            traction = before.traction[0] + 1j * before.traction[1]
            past = self.displacement(traction, before.normal.pressure, manner.ahead)
            if rows:
                left, behind = left_ahead(before, rows, self._sides, self.poisson_ratio)
                past += left + behind * traction  # instead of which the traction counts that is asked for
        loaded = normal
        bound = self.friction.coefficient(velocity, slipped) * normal.pressure
        for _ in range(MAX_ROUNDS):
            found = self._solve(loaded, bound, past, behind, motion, manner)
            counts += found.iterations, found.convolutions
            if not (self.friction.falls or self._couples):
                break
            slipping = (found.bound > 0.0) & np.logical_not(found.sticks)
            # half of the way: slip and coefficient chase each other where friction falls steeply
            velocity = 0.5 * (velocity + np.hypot(*found.slip) * manner.speed * slipping)
            slipped |= with_patches(slipping, found.bound) if self._covers else slipping
            if self._couples:
                drawn = found.traction[0] - 1j * found.traction[1]
                gap = normal.undeformed_gap + _convolved(self._influence(0.0, False)[1], drawn).real
                loaded = at_load(space, gap, normal.force, loaded.pressure, 1e-8)
            last = bound
            bound = self.friction.coefficient(velocity, slipped) * loaded.pressure
            if np.abs(bound - last).max() <= ROUNDS_AGREE * last.max():
                break
            manner = manner._replace(start=found)
        else:
            found = replace(found, outcome=Outcome.ITERATION_LIMIT)
        return replace(found, iterations=int(counts[0]), convolutions=int(counts[1]))

    def _rows_ahead(self, manner: _Manner) -> int:
        """Number of covered cells in the rolled distance; zero for a shift, or on whole cells."""
        if not (self._covers and manner.ahead):
            return 0
        return rows_ahead(manner.ahead, self.half_space.spacing[0], manner.steady)

    def _kept(
        self, past: Complex, bound: Array, motion: tuple[float, ...], manner: _Manner
    ) -> tuple[Complex, Turn | None]:
        """Displacement before, m, with what rims leave of it in cells that stick; and where a shift turns."""
        before = manner.before
        if before is None or manner.ahead or not self._covers:
            return past, None
        turn = turn_at(before, motion, bound, self._sides, self.poisson_ratio)
        if turn is None:  # as loads change it stays: by the bound that there is now
            traction = before.traction[0] + 1j * before.traction[1]
            past = past + left_by(bound, traction, self._sides, self.poisson_ratio)
        return past, turn

    def _rims(
        self, normal: Contact, box: kernel.TractionBox, inside: tuple[slice, slice], manner: _Manner
    ) -> TractionRims:
        """Rims of a contact on its box."""
        beyond = np.zeros(len(box.bound))
        enters = np.zeros(len(box.bound), bool)
        _, steady = manner.kernel
        rows = self._rows_ahead(manner)
        if rows:
            last = manner.before.normal if manner.before else normal
            entering, softness = free_slip(normal, last, rows, self.poisson_ratio)
            _cells(enters, box)[:] = entering[inside] & (_cells(box.bound, box) > 0.0)
            _cells(beyond, box)[:] = softness[inside]
        ahead = box.pitch if steady else 0
        rims = traction_rims(self._sides, self.poisson_ratio, box.pitch, ahead, enters, beyond)
        rims.room[:] = box.bound
        if rows and manner.before:
            _cells(rims.earlier, box)[:] = manner.ahead * slip_ahead(manner.before, rows)[inside]
        return rims

    def _solve(
        self,
        normal: Contact,
        bound: Array,
        past: Complex,
        behind: Array,
        motion: tuple[float, ...],
        manner: _Manner,
    ) -> SlidingContact:
        """Solve at a bound, on the box of the contact."""
        x, y = cell_places(self.half_space)
        xi, eta, spin = motion
        ahead, steady = manner.kernel
        _, spread, own = self._influence(ahead, steady)
        past, turn = self._kept(past, bound, motion, manner)
        rigid = manner.step * complex(xi, eta) - past
        if spin:
            share = SPIN_ON_MEANS if self._covers else SPIN_AHEAD
            rigid += manner.step * spin * (1j * (x + share * manner.ahead) - y)
        if manner.curvature:
            rigid -= manner.step * manner.curvature * y**2
        if self._couples:
            rigid -= _convolved(spread, normal.pressure)
        contact = normal.pressure > 0.0
        inside = box_around(contact)
        nx, ny = bound[inside].shape
        box = kernel.traction_box(nx, ny, self._convolution(nx, ny, ahead, steady))
        carried, directions = (CARRIED, DIRECTIONS) if steady else (0.0, 2)
        single = self._convolution(nx, ny, ahead, steady, single=True)
        linear = kernel.linear_problem(box, single, self._taps, directions)
        _cells(box.bound, box)[:] = bound[inside]
        _cells(box.rigid, box)[:] = rigid[inside]
        if manner.start is not None:
            start = manner.start.traction[:, *inside]
            _cells(box.traction, box)[:] = start[0] + 1j * start[1]
        rims = None
        if self._covers:
            rims = self._rims(normal, box, inside, manner)
            _cells(rims.behind, box)[:] = behind[inside]
            if turn:
                _cells(rims.origin, box)[:] = turn.traction[inside]
                _cells(rims.room, box)[:] = turn.room[inside]
        task = kernel.TractionTask(own, carried, not steady, manner.rtol, MAX_ITERATIONS)
        iterations, convolutions, worst = kernel.solve_traction(box, linear, rims, task)
        outcome = Outcome.CONVERGED if worst <= manner.rtol else Outcome.ITERATION_LIMIT
        fields = np.zeros((5, *contact.shape))
        p = _cells(box.traction, box)
        s = _cells(box.slip, box) / manner.step
        fields[:, *inside] = p.real, p.imag, s.real, s.imag, _cells(box.normal, box) == 0.0
        sticks = (fields[4] > 0.0) & (bound > 0.0)
        stored = math.nan  # in steady rolling what displaces here less that ahead tells nothing of it
        left = None
        if not steady:
            displaced = box.slip - box.rigid
            if rims and turn:
                _cells(displaced, box)[:] += turn.left[inside]
                left = turn.to(_cells(rims.left, box), inside)
            stored = 0.5 * float((box.traction.conj() * displaced).real.sum()) * self.half_space.cell_area
        return SlidingContact(
            normal, fields[:2], fields[2:4] * contact, sticks, bound, (xi, eta, spin), manner.speed,
            math.nan, stored, iterations, convolutions, worst, outcome, manner.curvature, manner.ahead, left,
        )  # fmt: skip


def _cells(flat: NDArray[Any], box: kernel.TractionBox) -> NDArray[Any]:
    """View (nx, ny) of the cells of a box in a field."""
    return flat.reshape(box.nx, box.pitch)[:, : box.ny]


def _convolved(spread: Complex, values: NDArray[Any]) -> Complex:
    """Values (nx, ny) convolved with a kernel whose origin is in its middle."""
    from scipy.signal import fftconvolve

    return fftconvolve(spread, values, mode="valid")
