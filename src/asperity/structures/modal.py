"""Structures by their modes along the path: the protocol, and tables of modes."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from math import factorial
from typing import NamedTuple, Protocol

import numpy as np
import scipy

from asperity.arguments import (
    Array,
    ArrayLike,
    Complex,
    as_row,
    finite_array,
    positive,
    real,
    real_array,
    require,
)
from asperity.errors import CoarseSamplingWarning, InputError
from asperity.kernels.curves import evaluate_pieces, turn_on
from asperity.written_numbers import count_of, rounded


class Modal(Protocol):
    """A linear structure as the sum of its modes along a path, mass-normalised, displacement along the force.

    Each mode obeys q″ + 2ζω q′ + ω² q = Σ φ(x_k) F_k over the contacts k; the structure is displaced by
    Σ φ(x) q. A mode with ω = 0 is one of a rigid body that nothing holds.
    """

    @property
    def natural_frequencies(self) -> Array:
        """Undamped, of all modes (m,), Hz."""

    @property
    def damping_ratios(self) -> Array:
        """ζ of all modes (m,)."""

    @property
    def extent(self) -> tuple[float, float]:
        """Where it begins and ends on the path, m."""

    def shapes(self, x: ArrayLike) -> tuple[Array, Array]:
        """Mode shapes φ, kg^(−1/2), and their slopes, kg^(−1/2)/m, at positions (n,), m: both (n, m)."""

    def shapes_along(self, start: float, spacing: float, count: int) -> tuple[Array, Array]:
        """As `shapes`, at equally spaced positions."""
        return self.shapes(start + spacing * np.arange(count))


def turned_on(
    wave: Array, slope: Array, wavenumbers: Array, spacing: float, count: int
) -> tuple[Array, Array]:
    """Sinusoidal mode shapes and slopes (count, m) at places a spacing apart, by angle addition.

    From exact values (k, m) at every `STRIDE` places; wavenumbers (m,) are 0 of what moves evenly.
    """
    shapes, slopes = np.empty((2, count, len(wavenumbers)))
    angle = wavenumbers * spacing
    sine_over_k = spacing * np.sinc(angle / np.pi)  # the limit of k = 0 moves rigid modes
    turn = np.array([2.0 * np.sin(0.5 * angle) ** 2, sine_over_k, wavenumbers * np.sin(angle)])
    turn_on(wave, slope, turn, shapes, slopes)
    return shapes, slopes


def modal_receptance(structure: Modal, frequency: ArrayLike, x: float, x0: float) -> Complex:
    """Displacement at `x` per harmonic force at `x0`, by modal superposition.

    Parameters
    ----------
    structure : Modal
        Where this is a method of it, the structure itself.
    frequency : array_like
        Hz; zero gives the static compliance. Time factor exp(+i omega t).
    x, x0 : float
        Positions of the response and of the force, m.

    Returns
    -------
    ndarray of complex
        m/N, of the shape of `frequency`.

    Raises
    ------
    InputError
        If a position is off the structure, or a frequency zero and there are modes of a rigid body.
    """
    return receptances_between(structure, frequency, [(x, x0)])[0]


def receptances_between(
    structure: Modal, frequency: ArrayLike, pairs: Iterable[tuple[float, float]]
) -> list[Complex]:
    """Receptances as `modal_receptance`, of pairs of positions: of the response and of the force, m."""
    natural = structure.natural_frequencies
    if not np.all(frequency) and not natural.all():
        raise InputError("frequency (Hz)", 0, "above 0: what nothing holds has no static receptance")
    answers = modal_answers(frequency, natural, structure.damping_ratios)
    return [answers @ np.prod(structure.shapes(pair)[0], axis=0) for pair in pairs]


def modal_answers(frequency: ArrayLike, natural: Array, ratios: Array) -> Complex:
    """Displacement of modes of unit mass per modal force (..., m), s²; frequencies (...) in Hz, e^{+iωt}."""
    omega = 2.0 * np.pi * np.asarray(frequency)[..., None]
    own = 2.0 * np.pi * natural
    return np.asarray(1.0 / (own**2 - omega**2 + 2j * ratios * own * omega), dtype=complex)


STATIC = 1e8
"""Hz, of modes that stand for residual flexibility: static in any time step above 5 ns."""
STATIC_DAMPING = 0.5
NEGLIGIBLE = 1e-9
"""Share of the largest residual flexibility that is left out."""
ROUNDED = 1e-6
"""Share of it that may be asymmetric or negative by rounding in a file."""


def checked_flexibility(given: ArrayLike | None, count: int) -> Array | None:
    """Take a residual flexibility that creates no energy; None where there is none."""
    if given is None:
        return None
    what = "residual flexibility (m/N)"
    allowed = f"{count} numbers, or a matrix of so many rows and columns"
    values = real_array(what, given, allowed)
    if values.shape not in ((count,), (count, count)) or not np.isfinite(values).all():
        raise InputError(what, f"shape {values.shape}, or numbers that are not finite", allowed)
    remedy = "It is the static compliance less that of the modes given."
    largest = np.abs(values).max()
    if values.ndim == 1 and values.min() < 0.0:
        raise InputError(what, float(values.min()), "0 and more at each place", remedy)
    if values.ndim == 2:
        if np.abs(values - values.T).max() > ROUNDED * largest:
            raise InputError(what, "a matrix that is not symmetric", "a symmetric one", remedy)
        least = np.linalg.eigvalsh(0.5 * (values + values.T))[0]
        if least < -ROUNDED * largest:
            received = f"a matrix with an eigenvalue of {rounded(least, 2)} m/N"
            raise InputError(what, received, "no negative one: it would create energy", remedy)
    return values if largest > 0.0 else None


def static_modes(flexibility: Array | None, count: int) -> Array:
    """Shapes (p, s) of modes at STATIC that have this flexibility, m/N."""
    if flexibility is None:
        return np.zeros((count, 0))
    omega = 2.0 * np.pi * STATIC
    if flexibility.ndim == 1:
        return omega * np.sqrt(flexibility)[:, None]
    values, vectors = np.linalg.eigh(0.5 * (flexibility + flexibility.T))
    kept = values > NEGLIGIBLE * values[-1]
    return omega * vectors[:, kept] * np.sqrt(values[kept])


class Pieces(NamedTuple):
    """Polynomials between breaks."""

    coefficients: Array  # (pieces, degree + 1, modes), highest power of the distance from the break first
    breaks: Array  # (pieces + 1,), m


def pieces_of(spline: "scipy.interpolate.BSpline") -> Pieces:
    """Polynomials of a spline of many columns."""
    breaks = np.unique(spline.t)
    powers = range(spline.k, -1, -1)
    coefficients = np.stack([spline(breaks[:-1], nu=p) / factorial(p) for p in powers], axis=1)
    return Pieces(np.ascontiguousarray(coefficients), breaks)


def shapes_at(pieces: Pieces, x: ArrayLike) -> tuple[Array, Array]:
    """Shapes and slopes (n, modes) at positions, m; an `InputError` where one lies beyond the breaks."""
    at = np.ascontiguousarray(as_row(x))
    first = float(pieces.breaks[0])
    last = float(pieces.breaks[-1])
    slack = 1e-9 * (last - first)
    if not (at.min() >= first - slack and at.max() <= last + slack):
        received = f"{at.min():.6g} to {at.max():.6g}"
        raise InputError("positions on the structure (m)", received, f"{first:.6g} to {last:.6g}")
    shapes, slopes = np.empty((2, at.size, pieces.coefficients.shape[-1]))
    evaluate_pieces(pieces.coefficients, pieces.breaks, at, shapes, slopes)
    return shapes, slopes


DEGREES = (3, 5, 7, 9)
"""Of splines through the mode shapes; the best is found by leaving every fifth point out."""
FEWEST_POINTS = 12
"""From here on a degree above the third is tried."""
HIGHEST = 0.1 * STATIC
"""Hz, of a mode that moves by itself."""
POINTS_PER_WAVELENGTH = 6
"""Fewer of them in the shortest mode are warned of."""


@dataclass(frozen=True, eq=False)
class ModalStructure(Modal):
    """A structure that is rolled over, by its modes at points along the path: computed or measured.

    Parameters
    ----------
    positions : array_like (p,)
        Along the path, rising, m; at unequal distances where that suits.
    frequencies : array_like (m,)
        Undamped natural frequencies, Hz; 0 for a mode of a rigid body.
    damping : array_like (m,) or float
        Damping ratios, 0 and more, below 1.
    mode_shapes : array_like (p, m)
        Displacements along the contact force, mass-normalised, kg^(−1/2); or of any scale with modal masses.
    modal_masses : array_like (m,), optional
        kg, that belong to the scale of the mode shapes; these are kept mass-normalised, without them.
    residual_flexibility : array_like (p,) or (p, p), optional
        Static displacement at the points for each newton, by all modes that are not among these, m/N: of the
        force at its own place, or the symmetric matrix of all places, which several contacts need. Of a
        vector r, the displacement at x under a force at x₀ is taken as √(r(x) r(x₀)), the largest there can
        be.

    Raises
    ------
    InputError
        If sizes do not fit, values are out of range, or the residual flexibility would create energy.

    Warns
    -----
    CoarseSamplingWarning
        If a mode has fewer than six points in a wavelength.

    Notes
    -----
    Between the points run splines of degree 3 to 9, the one that best meets every fifth point from the
    others (`degree`). The residual flexibility is that of modes at 100 MHz, which follow a force at once.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import ModalStructure
    >>> x = np.linspace(0.0, 1.0, 101)
    >>> plate = ModalStructure(x, [120.0], 0.01, np.sin(np.pi * x)[:, None], modal_masses=[2.0])
    >>> bool(np.isclose(plate.receptance(0.0, 0.5, 0.5).real, 1 / (2.0 * (2 * np.pi * 120.0) ** 2)))
    True
    """

    positions: Array
    frequencies: Array
    damping: Array | float
    mode_shapes: Array
    modal_masses: Array | None = None
    residual_flexibility: Array | None = None
    fit_error: float = 0.0
    """Of one that was fitted to receptances: root mean square of the differences of level, dB."""

    def __post_init__(self) -> None:
        at, shapes, natural, ratios = self._checked()
        flexibility = checked_flexibility(self.residual_flexibility, at.size)
        if natural.size == 0 and flexibility is None:
            raise InputError("natural frequencies (Hz)", "none", "at least one mode")
        warn_of_coarse(at, shapes, natural)
        checked = {"positions": at, "frequencies": natural, "damping": ratios, "mode_shapes": shapes}
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "modal_masses", None)  # the shapes are mass-normalised from here on
        object.__setattr__(self, "residual_flexibility", flexibility)

    def _checked(self) -> tuple[Array, Array, Array, Array]:
        """Positions, mass-normalised shapes, frequencies and damping ratios, of fitting sizes."""
        what = "positions of the modes (m)"
        allowed = "two or more rising finite numbers"
        at = finite_array(what, self.positions, allowed, shape=(None,), rising=True)
        require(at.size > 1, what, count_of(at.size, "number"), allowed)
        what = "natural frequencies (Hz)"
        allowed = "0 and more, below 10 MHz"
        natural = finite_array(what, self.frequencies, allowed, shape=(None,), at_least=0.0, below=HIGHEST)
        count = natural.size
        allowed = f"finite numbers ({at.size}, {count}): a row for each position, a column for each mode"
        shapes = finite_array("mode shapes", self.mode_shapes, allowed, shape=(at.size, count))
        given = self.damping if np.ndim(self.damping) else np.full(count, self.damping)
        what = "damping ratios"
        allowed = "0 and more, below 1"
        ratios = finite_array(what, given, allowed, count=count, at_least=0.0, below=1.0)
        if self.modal_masses is not None:
            masses = finite_array("modal masses (kg)", self.modal_masses, "above 0", count=count, above=0.0)
            shapes = shapes / np.sqrt(masses)
        silent = np.flatnonzero(~np.abs(shapes).any(axis=0))
        if silent.size:
            received = f"mode {silent[0] + 1} that does not move anywhere"
            raise InputError("mode shapes", received, "modes that move along the force", "Leave it out.")
        return at, shapes, natural, ratios

    def with_rigid_body(
        self, mass: float, *, inertia: float | None = None, centre: float | None = None
    ) -> "ModalStructure":
        """Add the modes of a rigid body that nothing holds.

        Parameters
        ----------
        mass : float
            kg: a translation along the force.
        inertia : float, optional
            Moment of inertia about the centre of mass, kg m²: a pitching rotation.
        centre : float, optional
            Position of the centre of mass, m; the middle of the extent.

        Returns
        -------
        ModalStructure
            With one or two modes of frequency 0 before the others.

        Raises
        ------
        InputError
            If a value is not positive.
        """
        at = self.positions
        rigid = [np.full(at.size, positive("mass (kg)", mass) ** -0.5)]
        if inertia is not None:
            moment = positive("moment of inertia (kg m^2)", inertia)
            middle = 0.5 * (at[0] + at[-1]) if centre is None else centre
            rigid.append((at - real("centre of mass (m)", middle, "a finite number")) / np.sqrt(moment))
        none = np.zeros(len(rigid))
        return replace(
            self,
            frequencies=np.concatenate([none, self.frequencies]),
            damping=np.concatenate([none, self.damping]),
            mode_shapes=np.column_stack([*rigid, self.mode_shapes]),
        )

    def numbers(self) -> dict[str, Array]:
        """All that it is made of, by name: a case that holds it is named by these."""
        residual = np.zeros(0) if self.residual_flexibility is None else self.residual_flexibility
        numbers = {"positions": self.positions, "frequencies": self.frequencies, "shapes": self.mode_shapes}
        return numbers | {"damping": np.asarray(self.damping), "residual": residual}

    @cached_property
    def _static(self) -> Array:
        """Shapes (p, s) of the modes that stand for the residual flexibility."""
        return static_modes(self.residual_flexibility, self.positions.size)

    @cached_property
    def natural_frequencies(self) -> Array:
        """Undamped natural frequencies of all modes, Hz; those of the residual flexibility last."""
        return np.concatenate([self.frequencies, np.full(self._static.shape[1], STATIC)])

    @cached_property
    def damping_ratios(self) -> Array:
        """Damping ratio of each mode."""
        return np.concatenate([self.damping, np.full(self._static.shape[1], STATIC_DAMPING)])

    @property
    def extent(self) -> tuple[float, float]:
        """First and last position, m."""
        return float(self.positions[0]), float(self.positions[-1])

    @cached_property
    def degree(self) -> int:
        """Degree of the splines between the positions."""
        natural = self.natural_frequencies
        softer = np.maximum(natural, natural[natural > 0.0].min(initial=np.inf)) if natural.any() else 1.0
        return _best_degree(self.positions, np.hstack([self.mode_shapes, self._static]) / softer)

    @cached_property
    def _pieces(self) -> Pieces:
        table = np.hstack([self.mode_shapes, self._static])
        return pieces_of(scipy.interpolate.make_interp_spline(self.positions, table, k=self.degree))

    def shapes(self, x: ArrayLike) -> tuple[Array, Array]:
        """Mass-normalised mode shapes and their slopes.

        Parameters
        ----------
        x : array_like (n,)
            Positions, m.

        Returns
        -------
        shapes, slopes : ndarray (n, modes)
            kg^(−1/2), and kg^(−1/2) per metre.

        Raises
        ------
        InputError
            If a position is off the structure.
        """
        return shapes_at(self._pieces, x)

    receptance = modal_receptance


def warn_of_coarse(at: Array, shapes: Array, natural: Array) -> None:
    """Warn of modes that the positions do not resolve.

    A sine of n points in a wavelength has differences 2 sin(π/n) times its own size: of six, the same size.
    """
    distance = np.diff(at)
    if not natural.size:
        return
    rise = distance @ np.diff(shapes, axis=0) ** 2
    size = distance @ (0.5 * (shapes[:-1] ** 2 + shapes[1:] ** 2))
    chord = np.sqrt(rise / np.where(size > 0.0, size, np.inf))
    limit = 2.0 * np.sin(np.pi / POINTS_PER_WAVELENGTH)
    if chord.max() > limit * (1.0 + 1e-9):
        coarse = int(np.argmax(chord))
        points = np.pi / np.arcsin(min(0.5 * chord[coarse], 1.0))
        count = int(np.sum(chord > limit))
        CoarseSamplingWarning.warn(
            f"The mode at {rounded(natural[coarse], 4)} Hz has {rounded(points, 2)} points in a "
            f"wavelength, fewer than {POINTS_PER_WAVELENGTH} ({count} of {natural.size} modes have so "
            "few): its shape between them is a guess. Give mode shapes at more positions, or leave such "
            "modes out and give their residual flexibility."
        )


def _best_degree(at: Array, table: Array) -> int:
    """Degree of the splines that miss every fifth point the least, when those are left out."""
    if at.size < FEWEST_POINTS:
        return min(DEGREES[0], at.size - 1)
    left = np.arange(2, at.size - 2, 5)
    kept = np.setdiff1d(np.arange(at.size), left)
    errors = {}
    for degree in DEGREES:
        if degree < kept.size:
            guess = scipy.interpolate.make_interp_spline(at[kept], table[kept], k=degree)(at[left])
            errors[degree] = float(np.sum((guess - table[left]) ** 2))
    return min(errors, key=lambda degree: errors[degree])
