"""What a rail lies on: elements below one another, each with a dynamic stiffness, down to rigid ground."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, Flags, finite_array
from asperity.errors import InputError
from asperity.quadrature import gauss
from asperity.written_numbers import count_of, rounded


def keep_as_tuples(frozen: object, *names: str) -> None:
    """Turn rows of numbers that a frozen object was given, as arrays or lists, into tuples: it has a hash."""
    for name in names:
        object.__setattr__(frozen, name, tuple(np.asarray(getattr(frozen, name), dtype=float).tolist()))


@dataclass(frozen=True)
class Relaxation:
    """Stiffness relative to a nominal one: a spring beside Maxwell elements (springs in line with dampers).

    K(ω)/k = static + Σ_j strength_j iω/(iω + 2π f_j). It is analytic in the lower half-plane, hence causal,
    and Im K >= 0 at all ω > 0, hence passive.
    """

    static: float  # of the spring, zero or more: the stiffness at rest
    # of the Maxwell elements, zero or more: what each adds well above its frequency
    strengths: tuple[float, ...]
    frequencies: tuple[float, ...]  # at which they dissipate most, Hz

    def __post_init__(self) -> None:
        keep_as_tuples(self, "strengths", "frequencies")

    def at(self, omega: ArrayLike) -> Complex:
        """Stiffness relative to the nominal one at angular frequencies, rad/s, with Im ω <= 0."""
        return relaxing(omega, self.frequencies) @ np.array([self.static, *self.strengths])


def relaxing(omega: ArrayLike, frequencies: ArrayLike) -> Complex:
    """Stiffnesses (..., 1 + j) of a spring, 1, and of Maxwell elements of unit strength, iω/(iω + 2π f_j).

    Angular frequency (...), rad/s; frequencies f_j (j,), Hz.
    """
    rate = 1j * np.asarray(omega, dtype=complex)[..., None]
    elements = rate / (rate + 2.0 * np.pi * np.asarray(frequencies, dtype=float))
    return np.concatenate([np.ones_like(rate), elements], axis=-1)


@dataclass(frozen=True)
class ConstantLoss:
    """Stiffness relative to a nominal one, 1 + iη, with one loss factor at all frequencies: not causal."""

    factor: float | None
    static = 1.0

    def at(self, omega: ArrayLike) -> Complex:
        """Stiffness relative to the nominal one."""
        return np.asarray(1.0 + 1j * (self.factor or 0.0))


NOMINAL = 300.0
"""Frequency at which the real part of a table is the nominal stiffness of a pad, Hz; chosen here."""
FEWEST = 3
"""Frequencies of a table at one preload."""


@dataclass(frozen=True)
class StiffnessTable:
    """Dynamic stiffness over frequency, as of the pad of a track.

    Between the frequencies real and imaginary part are linear in the logarithm of frequency; below the first
    and above the last they are as there.

    Parameters
    ----------
    frequencies : sequence of float
        Hz, rising, three or more.
    real, imaginary : sequence of float
        N/m, e^{+iωt}.

    Raises
    ------
    InputError
        If frequencies do not rise, or in some band a real part is not positive, or an imaginary part is
        negative, so that the pad would make energy.
    """

    frequencies: tuple[float, ...]
    real: tuple[float, ...]
    imaginary: tuple[float, ...]

    def __post_init__(self) -> None:
        allowed = f"{FEWEST} or more, rising, all above 0 Hz"
        at = finite_array(
            "frequencies of a stiffness (Hz)", self.frequencies, allowed, above=0.0, rising=True
        )
        if at.ndim != 1 or at.size < FEWEST:
            raise InputError("frequencies of a stiffness (Hz)", count_of(at.size, "frequency"), allowed)
        finite_array("dynamic stiffness (N/m)", [self.real, self.imaginary], shape=(2, at.size))
        if wrong := band_of(at, np.asarray(self.real) <= 0.0):
            remedy = "Is the unit right, and the phase that of force over displacement?"
            raise InputError(
                "dynamic stiffness", f"a real part of zero or less {wrong}", "above zero", remedy
            )
        if wrong := band_of(at, np.asarray(self.imaginary) < 0.0):
            received = f"an imaginary part below zero {wrong}, by which the pad would make energy"
            remedy = "With a time factor e^{-iωt} change its sign; else leave these lines out."
            raise InputError("dynamic stiffness", received, "zero or more", remedy)
        keep_as_tuples(self, "frequencies", "real", "imaginary")

    @property
    def nominal(self) -> float:
        """Real part at 300 Hz, N/m."""
        return float(np.interp(np.log(NOMINAL), np.log(self.frequencies), self.real))

    @property
    def static(self) -> float:
        """Real part at its lowest frequency, which stands for the stiffness at rest, over the nominal one."""
        return self.real[0] / self.nominal

    def at(self, omega: ArrayLike) -> Complex:
        """Stiffness relative to the nominal one at angular frequencies, rad/s, zero or more."""
        frequency = np.maximum(np.real(omega) / (2.0 * np.pi), self.frequencies[0])
        place = np.log(frequency)
        known = np.log(self.frequencies)
        real, imaginary = (np.interp(place, known, part) for part in (self.real, self.imaginary))
        return np.asarray((real + 1j * imaginary) / self.nominal, dtype=complex)


STIFFENING = tuple((5.0 * 10.0 ** (np.arange(38) / 10.0)).tolist())
"""Frequencies of a pad that stiffens, 5 Hz to 25 kHz: below the first it is as stiff as there."""


@cache
def stiffening(factor: float) -> StiffnessTable:
    """Stiffness that keeps its loss factor η over frequency, as (if/300 Hz)^α with tan(πα/2) = η.

    Causal, as what loses and does not stiffen is not (Kramers and Kronig); a fractional derivative, as rail
    pads are described by (S. Zhu, C. Cai and P. D. Spanos, J. Sound Vib. 335 (2015) 304).
    """
    exponent = 2.0 / math.pi * math.atan(factor)
    grown = (1j * np.array(STIFFENING) / NOMINAL) ** exponent
    return StiffnessTable(STIFFENING, tuple(grown.real.tolist()), tuple(grown.imag.tolist()))


def stiffness_at_preload(rows: Array, preload: float) -> StiffnessTable:
    """Dynamic stiffness at a preload, N, from a table of several.

    Rows (n, 3) of frequency, Hz, real and imaginary part, N/m, or with the preload, N, (n, 4), in any order,
    are the table. Between two preloads real and imaginary part are linear in preload, beyond them as there.
    An `InputError` says what is wrong with the table.
    """
    preloads = preloads_of(rows)
    place = np.interp(preload, preloads, np.arange(len(preloads)))
    beside = preloads[int(place) : int(place) + 2]
    tables = [_table(rows if rows.shape[1] < 4 else rows[rows[:, 3] == each]) for each in beside]
    below = tables[0]
    above = tables[-1]
    at = np.union1d(below.frequencies, above.frequencies)
    low, high = (each.at(2.0 * np.pi * at) * each.nominal for each in (below, above))
    mixed = low + (place - int(place)) * (high - low)
    return StiffnessTable(*(tuple(part.tolist()) for part in (at, mixed.real, mixed.imag)))


def check_stiffness_tables(rows: Array) -> None:
    """Refuse a table, see `stiffness_at_preload`, that is none of a stiffness at one of its preloads."""
    if rows.shape[1] < 4:
        _table(rows)
        return
    sorted_rows = rows[np.argsort(rows[:, 3], kind="stable")]
    for each in np.split(sorted_rows, np.flatnonzero(np.diff(sorted_rows[:, 3])) + 1):
        _table(each)


def preloads_of(rows: Array) -> Array:
    """Preloads of a table, N, rising; one, zero, of a table that does not tell them."""
    return np.unique(rows[:, 3]) if rows.shape[1] > 3 else np.zeros(1)


def _table(rows: Array) -> StiffnessTable:
    sorted_rows = rows[np.argsort(rows[:, 0], kind="stable")]
    return StiffnessTable(*(tuple(column.tolist()) for column in sorted_rows[:, :3].T))


def band_of(frequencies: Array, wrong: Flags) -> str:
    """The first band in which something is wrong; nothing where it is nowhere."""
    found = np.flatnonzero(wrong)
    if not found.size:
        return ""
    after = found[0] + np.argmin(np.append(wrong[found[0] :], False)) - 1
    ends = frequencies[found[0]], frequencies[after]
    return f"at {ends[0]:g} Hz" if ends[0] == ends[1] else f"from {ends[0]:g} to {ends[1]:g} Hz"


Losses = ConstantLoss | Relaxation | StiffnessTable
"""How a stiffness depends on frequency, relative to a nominal one."""


class Element:
    """One of the things between rail and ground; `below` is the stiffness under it, None on rigid ground.

    By default all of it moves as its top.
    """

    def on(self, omega: ArrayLike, below: Complex | None) -> Complex | None:
        """Dynamic stiffness at its top, N/m, at angular frequencies, rad/s; None if it cannot move."""
        raise NotImplementedError

    def passed(self, omega: ArrayLike, below: Complex | None) -> Complex:
        """Displacement of its lower end per displacement of its top."""
        return np.ones(np.shape(omega), complex)

    def spread(self, omega: ArrayLike, below: Complex | None) -> Array | float:
        """Mean square displacement over its length per square of that at its top."""
        return 1.0


@dataclass(frozen=True)
class Spring(Element):
    """A stiffness over frequency: with losses of its own, and a viscous damper beside it."""

    nominal: float  # N/m
    losses: Losses
    damping: float  # N s/m

    def stiffness(self, omega: ArrayLike) -> Complex:
        """Dynamic stiffness, N/m, at angular frequencies, rad/s, as of `Chain`."""
        rate = 1j * np.asarray(omega, dtype=complex)
        return self.nominal * self.losses.at(omega) + rate * self.damping

    @property
    def at_rest(self) -> "Spring":
        """Without losses, as stiff as it is at rest."""
        return Spring(self.nominal * self.losses.static, ConstantLoss(None), 0.0)

    def on(self, omega: ArrayLike, below: Complex | None) -> Complex:
        """In line with what is below."""
        own = self.stiffness(omega)
        return own if below is None else own * below / (own + below)

    def passed(self, omega: ArrayLike, below: Complex | None) -> Complex:
        """As two springs in line share it."""
        own = self.stiffness(omega)
        return np.zeros_like(own) if below is None else own / (own + below)


@dataclass(frozen=True)
class RigidMass(Element):
    """A mass that moves as a whole: a sleeper, a block, ballast."""

    mass: float  # kg

    def on(self, omega: ArrayLike, below: Complex | None) -> Complex | None:
        """Less its inertia."""
        return None if below is None else below - self.mass * np.asarray(omega, dtype=complex) ** 2


@dataclass(frozen=True)
class BendingSleeper(Element):
    """Half of a free Euler-Bernoulli beam that lies, all along, on what is below; both rails press alike.

    Or, `opposed`, the other rail presses upwards by as much. B w'''' + (s − μω²) w = F δ(x − a) and its
    mirror image, with mass μ and stiffness s below per length, and
    seats a from the middle. Solved in closed form: the waves of the seats on an endless beam, and those that
    the free ends throw back. Without shear and rotary inertia, which lower the higher natural frequencies.
    Its bending stiffness may have losses.
    """

    mass: float  # of the half, kg
    length: float  # of the whole sleeper, m
    bending_stiffness: float  # B, N m²
    seat_distance: float  # 2 a, m
    losses: Losses = ConstantLoss(None)
    opposed: bool = False

    @property
    def at_rest(self) -> "BendingSleeper":
        """Without losses, as stiff as it is at rest."""
        stiffness = self.bending_stiffness * self.losses.static
        return replace(self, bending_stiffness=stiffness, losses=ConstantLoss(None))

    def _bending(self, omega: ArrayLike) -> Complex | float:
        """B, N m², at angular frequencies, rad/s."""
        if self.losses == ConstantLoss(None):
            return self.bending_stiffness
        return self.bending_stiffness * self.losses.at(omega)

    def on(self, omega: ArrayLike, below: Complex | None) -> Complex | None:
        """Inverse of the receptance at the seat."""
        return None if below is None else 1.0 / self._waves(omega, below).at(0.5 * self.seat_distance)

    def spread(self, omega: ArrayLike, below: Complex | None) -> Array | float:
        """By Gauss's rule from the middle to the seat, and from there to the end."""
        if below is None:
            return 1.0
        waves = self._waves(omega, below)
        seat = 0.5 * self.seat_distance
        total = self._along(waves, lambda x: np.abs(waves.at(x)) ** 2)
        return total / (0.5 * self.length) / np.abs(waves.at(seat)) ** 2

    def lost(self, omega: ArrayLike, below: Complex | None) -> Array:
        """Imaginary stiffness, N/m, by which it dissipates itself, per square of how it moves by `spread`."""
        lost: Array = np.imag(self._bending(omega))
        if below is None or not np.any(lost):
            return np.zeros(np.shape(omega))
        waves = self._waves(omega, below)
        bent = self._along(waves, lambda x: np.abs(waves.curvature(x)) ** 2)
        moved = self._along(waves, lambda x: np.abs(waves.at(x)) ** 2) / (0.5 * self.length)
        return lost * bent / moved

    def _along(self, waves: "_SleeperWaves", value: Callable[[float], Array]) -> Array:
        """Integral over the half of what there is at a distance from the middle."""
        seat = 0.5 * self.seat_distance
        half = 0.5 * self.length
        most = float(np.abs(waves.wavenumber).max(initial=0.0))
        nodes, weights = gauss(8 + math.ceil(most * half))
        total = np.zeros(np.shape(waves.wavenumber))
        for begin, length in ((0.0, seat), (seat, half - seat)):
            for at, share in zip(nodes, weights, strict=True):
                total += length * share * value(begin + length * at)
        return total

    def _waves(self, omega: ArrayLike, below: Complex) -> "_SleeperWaves":
        half = 0.5 * self.length
        stiffness = (below - self.mass * np.asarray(omega, dtype=complex) ** 2) / half
        mirror = -1.0 if self.opposed else 1.0
        return _SleeperWaves(stiffness, self._bending(omega), half, 0.5 * self.seat_distance, mirror)


class _SleeperWaves:
    """Displacement of a half beam under a unit force at its seat, and `mirror` times it at its mirror image.

    Stiffness per length less inertia, s − μω², N/m², in the upper half-plane: all exponentials decay. The
    amplitudes of what the end throws back follow from w'' = w''' = 0 there.
    """

    def __init__(
        self, stiffness: Complex, bending: Complex | float, half: float, seat: float, mirror: float
    ) -> None:
        k = np.exp(-0.25j * np.pi) * (stiffness / bending) ** 0.25
        self.wavenumber = k
        self.half = half
        self.seat = seat
        self.mirror = mirror
        self.scale = 1.0 / (4.0 * bending * k**3)
        near = half - seat
        far = half + seat
        running, fading = (np.exp(-each * k * near) + mirror * np.exp(-each * k * far) for each in (1j, 1.0))
        moment = self.scale * (1j * running - fading)
        shear = self.scale * (running + fading)
        turn = mirror * np.exp(-2j * k * half)
        fall = mirror * np.exp(-2.0 * k * half)
        both = 1j * (1.0 - turn) * (1.0 + fall) - (1.0 + turn) * (1.0 - fall)
        self.running = ((1.0 + fall) * shear - (1.0 - fall) * moment) / both
        self.fading = ((1.0 + turn) * shear - 1j * (1.0 - turn) * moment) / both

    def at(self, x: float) -> Complex:
        """Displacement at a distance from the middle, m/N."""
        return self._sum(x, 1.0, 1.0)

    def curvature(self, x: float) -> Complex:
        """Second derivative of the displacement there, 1/(N m)."""
        return self._sum(x, -(self.wavenumber**2), self.wavenumber**2)

    def _sum(self, x: float, of_running: Complex | float, of_fading: Complex | float) -> Complex:
        """Sum of the waves that run, and of those that fade, each with a factor."""
        found = np.zeros_like(self.scale)
        for distance, side in ((abs(x - self.seat), 1.0), (x + self.seat, self.mirror)):
            running, fading = (side * np.exp(-each * self.wavenumber * distance) for each in (1j, 1.0))
            found = found - self.scale * (1j * running * of_running + fading * of_fading)
        for distance, side in ((self.half - x, 1.0), (self.half + x, self.mirror)):
            running, fading = (side * np.exp(-each * self.wavenumber * distance) for each in (1j, 1.0))
            found = found + self.running * running * of_running + self.fading * fading * of_fading
        return found


@dataclass(frozen=True)
class HangingMass(RigidMass):
    """A mass with nothing below."""

    def on(self, omega: ArrayLike, below: Complex | None) -> Complex | None:
        """Its inertia alone."""
        return super().on(omega, np.zeros(np.shape(omega), complex))


@dataclass(frozen=True)
class Chain:
    """Elements from the rail down, to rigid ground or a hanging mass; the first of them is a spring.

    Angular frequencies, rad/s, have a positive real part or, if all is causal, are in the lower half-plane.
    """

    elements: tuple[Element, ...]

    def stiffness(self, omega: ArrayLike) -> Complex:
        """Dynamic stiffness under the rail, N/m.

        Of a pad on a rigid sleeper on ballast K = K_p (K_b - m_s omega^2)/(K_p + K_b - m_s omega^2).
        """
        stiffness = self.elements[0].on(omega, self.below(omega)[0])
        assert stiffness is not None
        return stiffness

    def below(self, omega: ArrayLike) -> list[Complex | None]:
        """Dynamic stiffness under each element, N/m; None on rigid ground."""
        stiffnesses: list[Complex | None] = [None]
        for element in reversed(self.elements[1:]):
            stiffnesses.append(element.on(omega, stiffnesses[-1]))
        return stiffnesses[::-1]

    def squares(self, omega: ArrayLike) -> list[tuple[Array, Array]]:
        """Mean squares of how each element moves, and of how much it is squeezed, per square of the rail's.

        Two (f,) for each; over the length of a sleeper that bends, for itself and all that lies under it.
        """
        moved = np.ones(np.shape(omega), complex)
        over = np.ones(np.shape(omega))
        found = []
        for element, below in zip(self.elements, self.below(omega), strict=True):
            passed = moved * element.passed(omega, below)
            over = over * element.spread(omega, below)
            found.append((over * np.abs(moved) ** 2, over * np.abs(moved - passed) ** 2))
            moved = passed
        return found

    def sleeper_square(self, omega: ArrayLike) -> Array:
        """Mean square displacement of the sleeper per square of the rail's above it; zero without one.

        Of a pad on a rigid sleeper on ballast it is that of K_p/(K_p + K_b - m_s ω²).
        """
        for element, (square, _) in zip(self.elements, self.squares(omega), strict=True):
            if not isinstance(element, Spring):
                return square
        return np.zeros(np.shape(omega))

    @property
    def static(self) -> float:
        """Stiffness at rest, N/m."""
        lossy = Spring, BendingSleeper
        still = [each.at_rest if isinstance(each, lossy) else each for each in self.elements]
        return float(Chain(tuple(still)).stiffness(0.0).real)


def tuned_damper(mass: float, frequency: float, loss_factor: float) -> Chain:
    """A mass m that hangs at the rail on a standard linear solid: a spring beside a Maxwell element.

    At its frequency f, where it dissipates most, the solid has the stiffness m (2πf)² and the loss factor η,
    below 1: 1 − η of that stiffness is the spring's, 2 η the Maxwell element's. It is causal as it is.
    """
    solid = Relaxation(1.0 - loss_factor, (2.0 * loss_factor,), (frequency,))
    return Chain((Spring(mass * (2.0 * np.pi * frequency) ** 2, solid, 0.0), HangingMass(mass)))


CREATED = 0.05
"""Share of a receptance that its imaginary part may be above zero, by noise."""


@dataclass(frozen=True)
class MeasuredSleeper(Element):
    """Half a sleeper by its modes at the rail seat while it is free, both seats pressed alike.

    Its rigid motion is the first mode, of no frequency. What lies below counts as spread like its mass, with
    the share m_k/m in mode k: exact for an even sleeper on even ballast. It is causal and passive.
    """

    mass: float  # m, of the half, kg
    natural_frequencies: tuple[float, ...]  # Hz
    damping_ratios: tuple[float, ...]
    modal_masses: tuple[float, ...]  # m_k, of the half, kg, where the seat is displaced by one
    fit_error: float = 0.0  # root mean square of the level difference to a table, dB
    fitted: str = ""  # by what, in words

    def __post_init__(self) -> None:
        keep_as_tuples(self, "natural_frequencies", "damping_ratios", "modal_masses")

    def on(self, omega: ArrayLike, below: Complex | None) -> Complex | None:
        """Inverse of the sum of its modes."""
        return None if below is None else 1.0 / self._modes(omega, below).sum(axis=-1)

    def spread(self, omega: ArrayLike, below: Complex | None) -> Array | float:
        """Mean over its mass, in which its modes are orthogonal: Σ m_k |q_k|²/(m |Σ q_k|²)."""
        if below is None:
            return 1.0
        modes = self._modes(omega, below)
        squares = np.abs(modes) ** 2 @ np.array(self.modal_masses) / self.mass
        return squares / np.abs(modes.sum(axis=-1)) ** 2

    def lost(self, omega: ArrayLike, below: Complex | None) -> Array:
        """Imaginary stiffness, N/m, by which it dissipates itself, per square of how it moves by `spread`."""
        if below is None:
            return np.zeros(np.shape(omega))
        squares = np.abs(self._modes(omega, below)) ** 2
        masses = np.array(self.modal_masses)
        damping = 4.0 * np.pi * np.array(self.damping_ratios) * self.natural_frequencies * masses
        return self.mass * np.real(omega) * (squares @ damping) / (squares @ masses)

    def _modes(self, omega: ArrayLike, below: Complex) -> Complex:
        """Displacement of the seat in each mode per force (..., k), m/N."""
        at = np.asarray(omega, dtype=complex)[..., None]
        own = 2.0 * np.pi * np.array(self.natural_frequencies)
        held = below[..., None] / self.mass
        stiffness = own**2 + held - at**2 + 2j * np.array(self.damping_ratios) * own * at
        return 1.0 / (np.array(self.modal_masses) * stiffness)


def check_receptance(frequency: Array, receptance: Complex) -> None:
    """Refuse a receptance (n,) at its own place, m/N, that makes energy, and say in which band, Hz."""
    from asperity.structures.modal_fit import check_range

    check_range(frequency, receptance)
    finite_array("size of a receptance (m/N)", np.abs(receptance), above=0.0)
    if wrong := band_of(frequency, receptance.imag > CREATED * np.abs(receptance)):
        received = f"an imaginary part above zero {wrong}, by which the sleeper would make energy"
        allowed = f"zero or less, but for noise of {CREATED:.0%} of the receptance"
        remedy = "With a time factor e^{-iωt} change its sign; divide a mobility by iω first."
        raise InputError("receptance of the sleeper", received, allowed, remedy)


def measured_sleeper(frequency: Array, receptance: Complex, mass: float) -> MeasuredSleeper:
    """Modes of half a sleeper that meet its receptance at the rail seat, both seats pressed alike.

    Parameters
    ----------
    frequency : ndarray (n,)
        Hz, rising, above zero; ten or more, fine enough for a few in each resonance.
    receptance : ndarray of complex (n,)
        m/N, e^{+iωt}, of the free sleeper: displacement of a seat per force there, with the same force at the
        other.
    mass : float
        Of the half, kg.

    Returns
    -------
    MeasuredSleeper
        With its `fit_error`, of which a `Track` that is built from a case is judged.

    Raises
    ------
    InputError
        If the receptance makes energy, or is out of all range.

    Notes
    -----
    Vector fitting, modal masses by least squares without negative values. Modes above the band are there by
    their flexibility. On a bed of the stiffness K that is spread like its mass, mode k answers with
    1/(m_k (ω_k² − ω² + K/m)).
    """
    from asperity.structures import modal_fit

    check_receptance(frequency, receptance)
    omega = 2.0 * np.pi * frequency
    rigid = np.asarray(-1.0 / (mass * omega**2), dtype=complex)
    own, ratios, masses = modal_fit.fit_modes(frequency, receptance, rigid)
    rigidly = ((0.0, own), (0.0, ratios), (mass, masses))
    natural, damping, modal = (tuple(np.append(*each).tolist()) for each in rigidly)
    found = MeasuredSleeper(mass, natural, damping, modal)
    fitted = found._modes(omega, np.zeros(omega.shape, complex)).sum(axis=-1)
    off = 20.0 * np.log10(np.abs(fitted / receptance))
    worst = int(np.argmax(np.abs(off)))
    words = f"{count_of(len(own), 'mode')} on {mass:.4g} kg"
    words += f" ({rounded(abs(off[worst]), 2)} dB off at most, at {rounded(frequency[worst], 4)} Hz)"
    return replace(found, fit_error=modal_fit.level_error(fitted, receptance), fitted=words)
