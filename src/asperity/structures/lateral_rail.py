"""The rail sideways: lateral bending and torsion on periodic supports, solved exactly."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, finite_array
from asperity.structures import modal, periodic_rail, rail_web
from asperity.structures.lateral_parameters import LateralParameters
from asperity.structures.track import (
    EN_15461_BAYS,
    VANISHING_DAMPING,
    Track,
    decay_rate_of_responses,
)
from asperity.structures.wheel_modes import WheelModes

THIRD = 1.0 / 3.0
"""Lateral stiffness of a pad over its vertical one."""
SIDE = 0.02
"""Depth below the top of the head at which a hammer strikes its side, m: about its middle."""
KEPT = 2
"""Waves that are kept: on the lines of a spectrum, and at the frequencies that are shown."""


@dataclass(frozen=True, eq=False)
class FreeWaves:
    """Receptance of a free infinite rail, sum over i of amplitude_i shape_i shape_iᵀ exp(−i k_i |x|)."""

    wavenumbers: Complex  # (w, f), k_i, rad/m, Im k_i <= 0
    shapes: Complex  # (m, w, f), motions, m, and twists, rad, of the section
    amplitudes: Complex  # (w, f), for shapes in m and rad per N and N m


def _roots(cubic: Complex) -> tuple[Complex, Complex]:
    """Roots (3, f) of cubics (4, f), of the third degree first, and the slopes there."""
    companion = np.zeros((cubic.shape[1], 3, 3), dtype=complex)
    companion[:, 0] = -(cubic[1:] / cubic[0]).T
    companion[:, 1, 0] = companion[:, 2, 1] = 1.0
    root = np.asarray(np.linalg.eigvals(companion).T, dtype=complex)
    derived = cubic[:3] * np.array([[3.0], [2.0], [1.0]])
    return root, np.asarray(np.polyval(derived[:, None], root), dtype=complex)


@dataclass(frozen=True, eq=False)
class LateralWaves:
    """The Floquet waves of a rail that bends sideways and twists on equal supports, L apart.

    Of a section that keeps its form there are w = 3, and m = 2 motions: of the centre of twist, m, and twist,
    rad; of one whose web bends 6, and 4 of `asperity.structures.rail_web`. Forces on them are N and N m. With
    0 <= x0 <= L and x = p L + xi >= x0, the motion at x per force at x0 is sum_j coefficients_j
    multipliers_j**p outgoing(xi)_j incoming(x0)_jᵀ.
    """

    multipliers: Complex  # (w, f), the change of wave j over one bay, |λ_j| < 1
    coefficients: Complex  # (w, f)
    wavenumbers: Complex  # (w, f), k_i of the free rail, rad/m
    weights: Complex  # (m, w, w, f), motion by the free wave i in wave j, axes (motion, i, j, f)
    spacing: float  # L, m

    def outgoing(self, x: float) -> Complex:
        """Shapes (m, w, f) of the waves that decay towards growing x, 0 <= x <= L, m."""
        return self._of(self.spacing - x) + self.multipliers * self._of(x)

    def incoming(self, x: float) -> Complex:
        """Shapes (m, w, f) of the waves that grow towards growing x, 0 <= x <= L, m."""
        return self._of(self.spacing - x) + self._of(x) / self.multipliers

    def _of(self, x: float) -> Complex:
        return np.einsum("aijf,if->ajf", self.weights, np.sin(self.wavenumbers * x))

    def outgoing_at(self, places: Array) -> Complex:
        """Shapes (f, x, m, w) of the waves that decay towards growing x at places (x,), m, from 0 to L."""
        back = np.sin(self.wavenumbers * (self.spacing - places)[:, None, None])
        ahead = np.sin(self.wavenumbers * places[:, None, None])
        by_free = np.moveaxis(self.weights, -1, 0).swapaxes(1, 2)  # (f, i, m, j)
        both = np.concatenate([by_free, by_free * self.multipliers.T[:, None, None]], axis=1)
        sines = np.concatenate([back, ahead], axis=1).transpose(2, 0, 1)
        found = sines @ both.reshape(*both.shape[:2], -1)
        return found.reshape(*sines.shape[:2], *both.shape[2:])

    def receptance(self, x: float, x0: float) -> Complex:
        """Motion at `x` per force at `x0`, (m, m, f); positions from any support, m."""
        found = self.receptances([max(x, x0)], min(x, x0))[0]
        return found if x >= x0 else found.swapaxes(0, 1)

    def receptances(self, places: ArrayLike, x0: float) -> Complex:
        """Motion at places (x,), none before `x0`, per force there, (x, m, m, f); from any support, m."""
        start = math.floor(x0 / self.spacing)
        incoming = self.incoming(x0 - start * self.spacing)
        found = []
        for last in np.asarray(places, dtype=float).tolist():
            end = math.floor(last / self.spacing)
            outgoing = self.outgoing(last - end * self.spacing)
            to = outgoing * self.coefficients * periodic_rail.whole_power(self.multipliers, end - start)
            found.append(np.einsum("ajf,bjf->abf", to, incoming))
        return np.stack(found)


def lateral_waves(free: FreeWaves, support: Complex, spacing: float) -> LateralWaves:
    """Floquet waves of a rail on supports of dynamic stiffness K (m, m, f), spacing m apart.

    An `InputError` says if a free wave decays by more than exp(−200) in one bay.

    With the multiplier λ and c = (λ + 1/λ)/2 of a wave, the reactions r λ^n of the supports send out the
    free waves i α_i a_i (a_iᵀ r)/(cos k_i L − c) [sin k_i(L − x) + λ sin k_i x], and answer their motion:
    with z_i for the factor of a_i [ ], cos k_i L z_i + i α_i Σ_l a_iᵀ K a_l sin k_l L z_l = c z_i, an
    eigenvalue problem of as many as there are free waves. The superposition of all supports is the sum of
    the residues at its roots, −2/((λ − 1/λ) Σ_i z_i² sin k_i L/(i α_i)), as in
    `asperity.structures.periodic_rail` for one motion.
    """
    phase = free.wavenumbers * spacing
    amplitude = 1j * free.amplitudes
    periodic_rail.refuse_decay(phase.imag)
    sine = np.sin(phase)
    shapes = free.shapes
    matrix = np.einsum("if,aif,abf,blf,lf->fil", amplitude, shapes, support, shapes, sine, optimize=True)
    matrix += np.einsum("if,il->fil", np.cos(phase), np.eye(len(phase)))
    c, z = np.linalg.eig(matrix)
    c = c.T
    z = np.moveaxis(z, 0, -1)  # (j, f), (i, j, f)
    multipliers = periodic_rail.multipliers_of(c)
    square = np.sum(z**2 * (sine / amplitude)[:, None], axis=0)
    coefficients = -2.0 / ((multipliers - 1.0 / multipliers) * square)
    return LateralWaves(multipliers, coefficients, free.wavenumbers, shapes[:, :, None] * z, spacing)


@dataclass(frozen=True)
class LateralTrack(LateralParameters):
    """A `Track` sideways: its rail, UIC 60 by default, on pads and half sleepers that move in the ballast.

    The rail bends by Timoshenko and twists by St Venant about its centre of twist, which moves centroid, head
    and foot (D. Kostovasilis, D. J. Thompson and M. F. M. Hussein, J. Sound Vib. 2017, doi
    10.1016/j.jsv.2016.12.033, whose beam also warps). Mass per length, losses, sleepers and spacing are those
    of the track; a pad is by default a third as stiff sideways, as in an example of the program rolland (40
    beside 120 MN/m), and against roll, k_p b²/12, as an even one as wide as the foot, b = `foot_width`, m;
    the ballast is as stiff, as in the same example.

    Raises
    ------
    InputError
        If a value is not positive.

    Notes
    -----
    Head and foot of a UIC 60 rail, or of any whose `web_thickness` is given, are beams of their own, and the
    web bends between them (`asperity.structures.rail_web`): most of why lateral decay rates measured at
    1.25 kHz were 2.5 to 4 times lower than those of a section that keeps its form, and warps freely
    (docs/evidence/measured_railway.md). Any other section keeps it, and each whose `web_thickness` is
    infinite. Pads and ballast lose as they do vertically, by the same share
    at every frequency; other springs below are as stiff as vertically. Sleepers move sideways as rigid bodies
    and do not roll. Bays are all nominal, and rail dampers are left out.

    Examples
    --------
    >>> from asperity import Track
    >>> from asperity.structures.lateral_rail import LateralTrack
    >>> head = LateralTrack(Track.named("uic60")).receptance([100.0, 1000.0], 0.3, 0.3)
    >>> bool(abs(head[0]) > abs(head[1]))
    True
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.web is not None:
            rail_web.section_of(self)  # refuses what cannot be

    @property
    def height(self) -> float:
        """From the bottom of the foot to the top of the head, m."""
        return self.head_height + self.foot_depth

    @cached_property
    def section(self) -> rail_web.WebbedSection | None:
        """Head, foot and the web that bends between them; None of a section that keeps its form."""
        return None if self.web is None else rail_web.section_of(self)

    def contact_shapes(self, place: float) -> Array:
        """What moves a contact, a place (m) off the middle of the head, down and sideways (2, m), by rows.

        1 by the motion of the centre of twist or of the head, m by twist.
        """
        if self.section is None:
            return np.array([[0.0, place], [1.0, self.head_height]])
        return np.stack([[0.0, place, 0.0, 0.0], self.section.top])

    @property
    def mean_squares(self) -> Array:
        """Mean over the height of the rail of its displacement squared, by motions (m, m)."""
        if self.section is not None:
            return self.section.squares
        low = -self.foot_depth
        high = self.head_height
        slope = 0.5 * (high + low)
        return np.array([[1.0, slope], [slope, (high**2 + high * low + low**2) / 3.0]])

    def support(self, omega: ArrayLike) -> Complex:
        """Dynamic stiffness of a support (m, m, f) at angular frequencies (f,), rad/s, as of `Track.waves`.

        That of the chain of springs and masses below, on the foot, and the pad's stiffness against roll.
        """
        track = self.track
        foot = np.array([1.0, -self.foot_depth]) if self.section is None else self.section.bottom
        found = np.multiply.outer(np.outer(foot, foot), self._moved_sideways.support.stiffness(omega))
        even = self.foot_width**2 / 12.0
        roll = _share(self.pad_roll_stiffness, track.pad_stiffness, even)
        found[-1, -1] += roll * track.springs["pad"].stiffness(omega)
        return found

    @cached_property
    def _moved_sideways(self) -> Track:
        """The track whose vertical supports are the lateral ones of this: sleepers do not bend sideways."""
        pad = _share(self.pad_stiffness, self.track.pad_stiffness, THIRD)
        ballast = _share(self.ballast_stiffness, self.track.ballast_stiffness, 1.0)
        bends = "measured_sleeper", "sleeper_bending_stiffness", "sleeper_loss_factor"
        rigid: dict[str, Any] = dict.fromkeys(bends)
        rigid |= {name: getattr(Track, name) for name in ("sleeper_length", "seat_distance")}
        return replace(self.track.scaled(pad, ballast), **rigid)

    @cached_property
    def _is_damped(self) -> bool:
        """Whether its waves die away without rail dampers."""
        dampers = "rail_damper_mass", "rail_damper_frequency", "rail_damper_loss_factor"
        without: dict[str, Any] = dict.fromkeys(dampers)
        return replace(self.track, **without).is_damped

    def free_waves(self, omega: Complex, foundation: Complex | float = 0.0) -> FreeWaves:
        """Waves of the rail without supports at angular frequencies (f,), rad/s, as of `Track.waves`.

        Stiffness per length of a foundation all along the rail (m, m, f), which takes from the inertia.

        Of a section that keeps its form, with q = k², t = EI q − ρI ω² and p = 1 + t/S, the answer to a
        harmonic force and torque along the rail is [[p (GJ q − I ω²), p m' e ω²], [p m' e ω², q t − p m'
        ω²]]/Δ(q), Δ the cubic (q t − p m' ω²) (GJ q − I ω²) − p (m' e ω²)², I the polar inertia about the
        centre of twist and e the height of the centroid above it. Each root is a wave, and its residue has
        one shape; of a section whose web bends as in `asperity.structures.rail_web`.
        """
        losses = self.track.rail.losses.at(omega)
        if self.section is not None:
            return FreeWaves(*rail_web.webbed_waves(self.section, omega, losses, foundation))
        square = omega**2
        e = self.centroid_height
        mass = self.track.mass_per_length
        bending = self.bending_stiffness * losses
        torsion = self.torsional_stiffness * losses
        soft = self.bending_stiffness / self.shear_stiffness  # EI/S, m²: both lose alike
        held = np.broadcast_to(foundation, (2, 2, len(omega)))
        turning = (self.polar_inertia + mass * e**2) * square - held[1, 1]
        moved = mass * square - held[0, 0]
        coupled = mass * e * square - held[0, 1]
        rotary = self.rotary_inertia * square
        rest = 1.0 - rotary * soft / bending  # p = rest + soft q
        along = -(rotary + moved * soft)  # q t − p m' ω² = bending q² + along q − moved rest
        cubic = np.broadcast_arrays(
            torsion * bending,
            torsion * along - turning * bending,
            -torsion * moved * rest - turning * along - coupled**2 * soft,
            rest * (turning * moved - coupled**2),
        )
        q, slope = _roots(np.stack(cubic))
        shear = rest + soft * q
        lateral = shear * (torsion * q - turning)
        cross = shear * coupled
        twist = q * (bending * q + along) - moved * rest
        bends = np.abs(lateral * turning) >= np.abs(twist * moved)
        larger = np.where(bends, lateral, twist)
        one = np.ones_like(q)
        ratio = cross / larger
        k = periodic_rail.decaying(q)
        shapes = np.stack([np.where(bends, one, ratio), np.where(bends, ratio, one)])
        return FreeWaves(k, shapes, -0.5j * larger / (k * slope))

    def waves(self, omega: ArrayLike) -> LateralWaves:
        """The waves of the supported rail at angular frequencies (f,), rad/s, as of `Track.waves`.

        Those that were asked for last are kept: force, decay and sound ask for the same.
        """
        omega = np.atleast_1d(np.asarray(omega, dtype=complex))
        asked = omega.tobytes()
        if asked not in self._kept:
            while len(self._kept) >= KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[asked] = self._waves(omega)
        return self._kept[asked]

    @cached_property
    def _kept(self) -> dict[bytes, LateralWaves]:
        return {}

    def _waves(self, omega: Complex) -> LateralWaves:
        track = self.track
        if not self._is_damped:
            omega = omega * (1.0 - VANISHING_DAMPING * 1j)
        support = self.support(omega)
        spacing = track.sleeper_spacing
        if track.continuous:
            return lateral_waves(self.free_waves(omega, support / spacing), 0.0 * support, spacing)
        return lateral_waves(self.free_waves(omega), support, spacing)

    def receptance(self, frequency: ArrayLike, x: float, x0: float) -> Complex:
        """Lateral displacement of the head at `x` per lateral force on the head at `x0`.

        Parameters
        ----------
        frequency : array_like (f,)
            Hz, positive. Time factor exp(+iωt).
        x, x0 : float
            m from a sleeper.

        Returns
        -------
        ndarray (f,) of complex
            m/N. Exact for the infinite track.
        """
        _, sideways = self.contact_shapes(0.0)
        motion = self.waves(_angular(frequency)).receptance(x, x0)
        return np.einsum("a,abf,b->f", sideways, motion, sideways)

    def answers(self, omega: Array | Complex, x: float | Array, x0: float | Array, place: float) -> Complex:
        """Receptances of the head at a place across it, (2, 2, f), m/N, with those of vertical bending.

        Displacement at `x`, vertical and lateral, per vertical and lateral force at `x0`, both at a `place` m
        from the middle, positive towards the field side; downwards, and towards the field side. A vertical
        force off the middle twists the rail. Angular frequencies (f,), rad/s, that may be complex. At several
        x and x0 (n,) by the same waves (2, 2, n, f).
        """
        sideways, upright = self.waves(omega), self.track.waves(omega)
        moved = self.contact_shapes(place)

        def between(x: float, x0: float) -> Complex:
            found = np.einsum("ma,abf,nb->mnf", moved, sideways.receptance(x, x0), moved)
            found[0, 0] += upright.receptance(x, x0)
            return found

        if not isinstance(x, np.ndarray):
            return between(x, float(x0))
        return np.stack([between(*pair) for pair in np.broadcast(x, x0)], axis=2)

    def decay_rate(self, frequency: ArrayLike) -> Array:
        """Decay rate (f,), dB/m, of the wave that reaches farthest, −20 lg|λ|/L; frequencies (f,), Hz."""
        largest = np.abs(self.waves(_angular(frequency)).multipliers).max(axis=0)
        return -20.0 * np.log10(largest) / self.track.sleeper_spacing

    def hammered(self, frequency: ArrayLike) -> tuple[Array, Complex]:
        """Distances of EN 15461 (x,), m, from a force at mid-span, and receptances there (x, f), m/N.

        Of the side of the head, where the force is, by all waves at once; frequencies (f,), Hz.
        """
        twist, top = self.contact_shapes(SIDE)
        side = top - twist
        spacing = self.track.sleeper_spacing
        distances = spacing * np.array(EN_15461_BAYS)
        force = 0.5 * spacing
        motion = self.waves(_angular(frequency)).receptances(force + distances, force)
        return distances, np.asarray(np.einsum("a,xabf,b->xf", side, motion, side))

    def decay_rate_en15461(self, frequency: ArrayLike) -> Array:
        """Decay rate (f,), dB/m, as a hammer on the side of the head at mid-span finds it; (f,), Hz."""
        distances, motion = self.hammered(frequency)
        return decay_rate_of_responses(distances, np.abs(motion))


def _share(stiffness: float | None, vertical: float, usual: float) -> float:
    """Of the vertical stiffness; the usual one where nothing is given, or nothing gives way."""
    return usual if stiffness is None or np.isinf(vertical) else stiffness / vertical


def _angular(frequency: ArrayLike) -> Array:
    at = finite_array("frequency (Hz)", frequency, "finite positive numbers", above=0.0)
    return 2.0 * np.pi * np.atleast_1d(at)


def wheel_receptances(
    modes: WheelModes | None, mass: float, frequency: Array | Complex, place: float
) -> Complex:
    """Displacement of a wheel at its contact per force there, (2, 2, f), m/N, downwards and sideways.

    A free mass, kg, in both directions, and modes, at a place, m from the running circle, positive towards
    the field side; frequencies (f,), Hz, above zero, or complex. The wheel's rigid roll is left out.
    """
    rigid = np.multiply.outer(np.eye(2), -1.0 / (mass * (2.0 * np.pi * frequency) ** 2))
    if modes is None:
        return rigid.astype(complex)
    shape = np.stack(modes.at(place))  # (2, p)
    answers = modal.modal_answers(frequency, modes.natural_frequencies, modes.damping_ratios)
    return rigid + np.einsum("ap,bp,fp->abf", shape, shape, answers)


def at_springs(receptances: Complex, normal: float, tangential: float) -> Complex:
    """Both bodies' receptances (2, 2, ...), and those of the springs of the contact, N/m: A, m/N."""
    springs = np.diag([1.0 / normal, 1.0 / tangential])
    return receptances + np.expand_dims(springs, tuple(range(2, receptances.ndim)))


def lateral_force(answer: Complex) -> Complex:
    """Lateral force per vertical force (f,), T/F = −A_vl/A_ll: the lateral motion of both bodies agrees."""
    return -answer[1, 0] / answer[1, 1]


def vertical_change(answer: Complex) -> Complex:
    """Vertical force over that of a contact that is free sideways (f,), 1/(1 − A_vl²/(A_vv A_ll)).

    What the lateral force does to the vertical one, which a run in time leaves out.
    """
    return 1.0 / (1.0 - answer[0, 1] * answer[1, 0] / (answer[0, 0] * answer[1, 1]))
