"""Fitted modes that can be rolled over: smooth shapes, and an even stiffness of modes above the band."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import real_array
from asperity.errors import CoarseSamplingWarning, EnergyWarning, InputError, UnconvergedWarning, percent
from asperity.structures.body import GRAVITY, Body, carriage
from asperity.structures.modal import ModalStructure, warn_of_coarse
from asperity.structures.modal_fit import (
    RESIDUAL_DAMPING,
    Complex,
    Modes,
    check_range,
    fit_shapes,
    modal_answers,
    warn_of_wide_lines,
)
from asperity.structures.wheel import DOUBTFUL_FIT, REFUSED_FIT, Wheel

Array = NDArray[np.float64]

INSIDE = 1.02
"""Of the highest frequency, up to which a mode is one of the band."""
ABOVE = (1.15, 1.5, 3.0)
"""Of the highest frequency: modes that stand for all above the band."""
FINER = 4
"""Places for each place of a record, at which shapes of these modes are given."""
DEGREE = 7
SPARE_KNOTS, KNOTS_PER_WAVELENGTH, MORE_KNOTS = 8, 4.0, 1.5
MOST_KNOTS = 0.6
"""Of the places; a shape that needs more is not smoothed."""
WORTH_KNOTS = 0.7
"""Of the scatter that fewer knots leave, which more must leave to be worthwhile: noise leaves the same."""


def in_band(modes: Modes, highest: float) -> Modes:
    """Modes, with shapes (p, m), up to a frequency, Hz."""
    natural, ratios, shapes = modes
    inside = natural <= INSIDE * highest
    return natural[inside], ratios[inside], shapes[:, inside]


def with_stiffness_above(
    frequency: Array, at: Array, number: NDArray[np.intp], flexible: Complex, modes: Modes
) -> tuple[Array, Modes]:
    """Modes at finer places, m, their shapes smoothed, and others for the stiffness of those above the band.

    Flexible receptances (n, p, e) of places `at` (p,) under forces at those with the numbers `number` (e,).
    What the modes leave of each force's own receptance is that of modes of positive masses at `ABOVE`.
    Between forces it goes on evenly, as waves of two phases, r cos κ(x − x₀): they have the same flexibility
    everywhere. Wavenumbers follow from that of the highest mode as those of bending waves do.
    """
    natural, ratios, shapes = modes
    parts = [at[:-1] + k / FINER * np.diff(at) for k in range(FINER)]
    fine = np.append(np.stack(parts, axis=1).ravel(), at[-1])
    finer = np.array([smoothed(at, shape)(fine) for shape in shapes.T]).reshape(-1, fine.size).T
    squares = _squares_above(frequency, number, flexible, modes)
    wave = _wavenumber(at, shapes[:, -1]) if natural.size else 0.0
    order = np.argsort(at[number])
    added: list[Array] = []
    frequencies: list[float] = []
    for k, ratio in enumerate(ABOVE):
        size = np.sqrt(np.interp(fine, at[number][order], squares[order, k]))
        phase = wave * np.sqrt(ratio) * (fine - fine[0])
        for shape in (size * np.cos(phase), size * np.sin(phase)):
            if shape.any():
                added.append(shape)
                frequencies.append(ratio * float(frequency[-1]))
    return fine, (
        np.concatenate([natural, frequencies]),
        np.concatenate([ratios, np.full(len(added), RESIDUAL_DAMPING)]),
        np.column_stack([finer, *added]),
    )


def _squares_above(frequency: Array, number: NDArray[np.intp], flexible: Complex, modes: Modes) -> Array:
    """Squared shapes (e, above), 1/kg, of the modes above the band where forces act."""
    natural, ratios, shapes = modes
    answers = modal_answers(frequency, natural, ratios)
    above = frequency[-1] * np.array(ABOVE)
    columns = modal_answers(frequency, above, np.full(above.size, RESIDUAL_DAMPING))
    squares = []
    for j, i in enumerate(number):
        own = flexible[:, i, j]
        weight = 1.0 / np.maximum(np.abs(own), np.finfo(float).tiny)
        left = weight * (own - answers @ shapes[i] ** 2)
        matrix = np.concatenate([(weight[:, None] * columns).real, (weight[:, None] * columns).imag])
        size = np.linalg.norm(matrix, axis=0)
        squares.append(scipy.optimize.nnls(matrix / size, np.concatenate([left.real, left.imag]))[0] / size)
    return np.array(squares)


def smoothed(at: Array, shape: Array) -> scipy.interpolate.BSpline:
    """Spline through a shape (p,) at places (p,), with as many knots as leave no more than its noise."""
    degree = min(DEGREE, at.size - 1)
    through = scipy.interpolate.make_interp_spline(at, shape, k=degree - (degree + 1) % 2)
    count = int(KNOTS_PER_WAVELENGTH * _wavenumber(at, shape) * np.ptp(at) / (2.0 * np.pi)) + SPARE_KNOTS
    best, noise = through, np.inf
    while count < MOST_KNOTS * at.size:
        inner = np.interp(np.linspace(0.0, at.size - 1.0, count - DEGREE + 1), np.arange(at.size), at)
        knots = np.r_[(at[0],) * DEGREE, inner, (at[-1],) * DEGREE]
        found = scipy.interpolate.make_lsq_spline(at, shape, knots, k=DEGREE)
        scatter = float(np.sum((found(at) - shape) ** 2) / (at.size - count))
        if scatter > WORTH_KNOTS * noise:
            return best
        best, noise, count = found, scatter, int(MORE_KNOTS * count)
    return through


def _wavenumber(at: Array, shape: Array) -> float:
    """Root mean square slope of a shape over its root mean square, rad/m."""
    distance = np.diff(at)
    rise = np.sum(np.diff(shape) ** 2 / distance)
    size = np.sum(distance * 0.5 * (shape[:-1] ** 2 + shape[1:] ** 2))
    return float(np.sqrt(rise / size)) if size > 0.0 else 0.0


FEWEST_FREQUENCIES = 10
CREATED = 0.05
"""Share of a receptance that its imaginary part may be on the wrong side, by noise."""


def fit_structure(
    positions: ArrayLike,
    driven: ArrayLike,
    frequency: ArrayLike,
    receptance: ArrayLike,
    *,
    mass: float | None = None,
    inertia: float | None = None,
    centre: float | None = None,
) -> ModalStructure:
    """Structure that is rolled over, by its receptances at several places under forces at some of them.

    Parameters
    ----------
    positions : array_like (p,)
        Of the responses along the path, rising, m: six or more in the shortest wavelength.
    driven : array_like (e,)
        Positions of the forces, m, each one of those of the responses.
    frequency : array_like (n,)
        Hz, above zero and rising; fine enough for a few points in each resonance.
    receptance : array_like (n, p, e) of complex
        Displacements along the force per force, m/N, e^{+iωt}; (n, p) for one force.
    mass, inertia, centre : float, optional
        Of a structure that nothing holds, see `ModalStructure.with_rigid_body`.

    Returns
    -------
    ModalStructure
        With its `fit_error`: the root mean square of the level differences where forces act, dB.

    Raises
    ------
    InputError
        If the record is short, disordered or not finite, if it creates energy (the other time factor), or if
        modes meet it to 6 dB only.

    Warns
    -----
    EnergyWarning
        If the receptances create energy at some frequencies.
    UnconvergedWarning
        If the fit error is above 1 dB.
    CoarseSamplingWarning
        If places or frequencies are too far apart for a mode.

    Notes
    -----
    All modes have real shapes and positive modal masses: the fit takes energy at every frequency, also
    outside of the band. Shapes are smoothed by as much as the record is noisy, as an uneven shape under a
    static load is a roughness. What no force excites is not in the record: a mode with a node at each force
    is missing. The stiffness of modes above the band is known where forces act, and taken as even between
    and beyond: let one act near an end that is rolled over, and give receptances to twice the highest
    frequency that matters: to one and a half times it, the force on a ball on a beam was up to 0.8 dB low in
    the last one-third octave, to twice it 0.1 dB.
    """
    at = real_array("positions of the receptances (m)", positions, "rising numbers")
    forces = np.atleast_1d(real_array("positions of the forces (m)", driven, "numbers"))
    f, given = _checked(frequency, receptance, at.size, forces.size)
    near = np.abs(at[:, None] - forces) if at.ndim == 1 else np.ones((1, forces.size))
    number = np.argmin(near, axis=0)
    if near.min(axis=0).max(initial=0.0) > 1e-6 * np.ptp(at) or len(set(number)) < forces.size:
        received = f"forces at {', '.join(f'{force:.4g}' for force in forces[:8])}"
        raise InputError(
            "positions of the forces (m)", received, "different places among those of the responses"
        )
    check_range(f, given)
    _check_energy(f, given[:, number])
    rigid = _rigid(f, at, number, mass, inertia, centre)
    modes = in_band(fit_shapes(f, given, rigid, number), f[-1])
    warn_of_coarse(at, modes[2], modes[0])
    warn_of_wide_lines(f, *modes[:2])
    fine, modes = with_stiffness_above(f, at, number, given - rigid, modes)
    natural, ratios, shapes = modes
    error = _fit_error(f, given[:, number], rigid[:, number], (natural, ratios, shapes[::FINER][number]))
    _judge(error, len(natural))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CoarseSamplingWarning)  # what is above the band has no wavelength
        structure = ModalStructure(fine, natural, ratios, shapes, fit_error=error)
        if mass is None:
            return structure
        return structure.with_rigid_body(mass, inertia=inertia, centre=centre)


def fit_body(
    mass: float,
    load: float,
    frequency: ArrayLike,
    receptance: ArrayLike,
    *,
    places: ArrayLike | None = None,
    inertia: float | None = None,
    centre: float | None = None,
) -> Body:
    """Body that rolls, by its receptances at its contacts.

    Parameters
    ----------
    mass : float
        Of its rigid motion, kg.
    load : float
        Static force of all contacts, weight included, N.
    frequency : array_like (n,)
        Hz, above zero and rising.
    receptance : array_like (n,) or (n, c, c) of complex
        Displacement of the contact per force there, m/N, e^{+iωt}; of several contacts each per force at
        each.
    places : array_like (c,), optional
        Of several contacts along the path, m.
    inertia, centre : float, optional
        Moment of inertia in pitch, kg m², and place of the centre of mass, m, of a body on several contacts.

    Returns
    -------
    Body
        With its `fit_error`, dB.

    Raises
    ------
    InputError
        As `fit_structure` and `Wheel.from_receptance`.

    Warns
    -----
    EnergyWarning, UnconvergedWarning
        As `fit_structure`.
    """
    if places is None:
        wheel = Wheel.from_receptance(mass, load, frequency, receptance)
        f, given = np.asarray(frequency, dtype=float), np.asarray(receptance, dtype=complex)
        _check_energy(f, given[:, None, None])
        masses = 1.0 / (2j * wheel.poles.imag * wheel.residues).real
        body = Body.from_modes(mass, load, wheel.natural_frequencies, wheel.damping_ratios, masses)
        return replace(body, fit_error=wheel.fit_error)
    at = np.atleast_1d(real_array("places of the contacts (m)", places, "numbers"))
    f, given = _checked(frequency, receptance, at.size, at.size)
    if inertia is None:
        raise InputError("moment of inertia (kg m^2)", "none", "one, of a body on several contacts")
    rigid_body = carriage(mass, inertia, at, centre=centre, load=load - mass * GRAVITY)
    _check_energy(f, given)
    every = np.arange(at.size)
    rigid = rigid_body.receptance(f)
    natural, ratios, shapes = fit_shapes(f, given, rigid, every)
    warn_of_wide_lines(f, natural, ratios)
    error = _fit_error(f, given, rigid, (natural, ratios, shapes))
    _judge(error, len(natural))
    return replace(
        rigid_body, natural_frequencies=natural, damping_ratios=ratios, shapes=shapes, fit_error=error
    )


def receptances_in(rows: Array, source: str) -> tuple[Array, Array, Array, Complex]:
    """Gather receptances from the lines of a table, as `fit_structure` takes them.

    Lines (k, 5) hold frequency, Hz, position of the response and of the force, m, real and imaginary part,
    m/N, in any order. Returns positions (p,), those of the forces (e,), frequencies (n,) and receptances
    (n, p, e).
    """
    (f, i), (at, j), (forces, k) = (np.unique(rows[:, c], return_inverse=True) for c in range(3))
    shape = f.size, at.size, forces.size
    if len(rows) != math.prod(shape) or len(np.unique(np.ravel_multi_index((i, j, k), shape))) < len(rows):
        received = f"{len(rows)} lines"
        each = f"{f.size} frequencies, {at.size} positions and {forces.size} forces"
        allowed = f"{math.prod(shape)}: one for each of {each}"
        raise InputError(source, received, allowed, "Complete the table; nothing is filled in silently.")
    given = np.empty(shape, dtype=complex)
    given[i, j, k] = rows[:, 3] + 1j * rows[:, 4]
    return at, forces, f, given


def _checked(frequency: ArrayLike, receptance: ArrayLike, p: int, e: int) -> tuple[Array, Complex]:
    """Frequencies (n,) and receptances (n, p, e) of a record that makes sense."""
    what = "receptance"
    f, given = np.asarray(frequency, dtype=float), np.asarray(receptance, dtype=complex)
    if given.ndim == 2 and e == 1:
        given = given[..., None]
    if f.ndim != 1 or given.shape != (f.size, p, e):
        received = f"shapes {f.shape} and {given.shape}"
        raise InputError(what, received, f"n frequencies, and (n, {p}, {e}): of each place and force")
    if f.size < FEWEST_FREQUENCIES:
        raise InputError(what, f"{f.size} frequencies", f"at least {FEWEST_FREQUENCIES}")
    if not (np.isfinite(f).all() and np.isfinite(given).all()):
        raise InputError(what, "values that are not finite", "finite values")
    if not (f[0] > 0.0 and (np.diff(f) > 0.0).all()):
        raise InputError(what, "frequencies in disorder", "frequencies above 0 Hz and rising")
    if not np.abs(given).any(axis=(1, 2)).all():
        raise InputError(what, "nothing but zeros at a frequency", "a response", "Leave it out.")
    return f, given


def _check_energy(frequency: Array, at_forces: Complex) -> None:
    """Refuse the other time factor, and warn where forces, each at its place, would be given energy.

    The power that forces F give is −ω/2 F* (H − H*)/(2i) F: its matrix must have no positive eigenvalue.
    """
    point = np.einsum("nii->ni", at_forces)
    sine = point.imag / np.maximum(np.abs(point), np.finfo(float).tiny)
    if sine.sum() > 3.0 * np.linalg.norm(sine):  # more than noise of random sign
        raise InputError(
            "receptance",
            "an imaginary part under the forces that is mostly positive",
            "the time factor e^{+iωt}, whose imaginary part is negative where there are losses",
            "Conjugate the values; divide a mobility by iω first.",
        )
    lost = (at_forces - at_forces.conj().swapaxes(1, 2)) / 2j
    created = np.linalg.eigvalsh(lost)[:, -1] / np.linalg.norm(at_forces, axis=(1, 2))
    created = np.maximum(created, sine.max(axis=1))
    if created.max() > CREATED:
        worst = int(np.argmax(created))
        warnings.warn(
            f"The receptance creates energy at {percent(float(np.mean(created > CREATED)))} of its "
            f"frequencies, most at {frequency[worst]:.5g} Hz: its imaginary part there is up to "
            f"{percent(float(created[worst]))} of it positive, more than {percent(CREATED)} of noise. The "
            "modes fitted to it create none. Check phases, and that forces and responses are counted in one "
            "direction at the same places.",
            EnergyWarning,
            stacklevel=4,
        )


def _rigid(
    f: Array,
    at: Array,
    number: NDArray[np.intp],
    mass: float | None,
    inertia: float | None,
    centre: float | None,
) -> Complex:
    """Receptances (n, p, e) of the motion of a rigid body, zero without a mass."""
    if mass is None:
        return np.zeros((f.size, at.size, number.size), dtype=complex)
    still = ModalStructure(at, np.ones(1), 0.0, np.ones((at.size, 1)))
    shapes = still.with_rigid_body(mass, inertia=inertia, centre=centre).mode_shapes[:, :-1]
    return np.asarray(-(shapes @ shapes[number].T) / (2.0 * np.pi * f[:, None, None]) ** 2, dtype=complex)


def _fit_error(f: Array, given: Complex, rigid: Complex, modes: Modes) -> float:
    """Root mean square of the level differences at the places of the forces, dB."""
    natural, ratios, shapes = modes
    answers = modal_answers(f, natural, ratios)
    fitted = np.einsum("njj->nj", rigid) + answers @ (shapes**2).T
    with np.errstate(divide="ignore"):
        difference = 20.0 * np.log10(np.abs(fitted / np.einsum("njj->nj", given)))
    return float(np.sqrt(np.mean(difference**2)))


def _judge(error: float, count: int) -> None:
    if not error <= REFUSED_FIT:
        raise InputError(
            "receptance",
            f"values that {count} modes meet to {error:.1f} dB only",
            f"a receptance that modes meet within {REFUSED_FIT:.0f} dB",
            "Check that it is m/N, displacement along the force, and the mass of what nothing holds.",
        )
    if error > DOUBTFUL_FIT:
        warnings.warn(
            f"{count} modes meet the given receptances to {error:.1f} dB only, more than "
            f"{DOUBTFUL_FIT:.0f} dB: resonances are uncertain by as much. Give finer or smoother "
            "receptances, or the modes.",
            UnconvergedWarning,
            stacklevel=4,
        )
