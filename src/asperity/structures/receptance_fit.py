"""Fitted modes that can be rolled over: smooth shapes, and an even stiffness of modes above the band."""

import math
from dataclasses import replace

import numpy as np
import scipy

from asperity.arguments import Array, Complex, Indices
from asperity.errors import CoarseSamplingWarning, EnergyWarning, InputError, percent
from asperity.structures import modal, modal_fit
from asperity.structures.body import Body, Wheel
from asperity.structures.modal_fit import RESIDUAL_DAMPING, Modes
from asperity.written_numbers import count_of, rounded

INSIDE = 1.02
"""Of the highest frequency, up to which a mode is one of the band."""
ABOVE = (1.15, 1.5, 3.0)
"""Of the highest frequency: modes that stand for all above the band."""
FINER = 4
"""Places for each place of a record, at which shapes of these modes are given."""
DEGREE = 7
SPARE_KNOTS = 8
KNOTS_PER_WAVELENGTH = 4.0
MORE_KNOTS = 1.5
MOST_KNOTS = 0.6
"""Of the places; a shape that needs more is not smoothed."""
WORTH_KNOTS = 0.7
"""Of the scatter that fewer knots leave, which more must leave to be worthwhile: noise leaves the same."""


def with_stiffness_above(
    frequency: Array, at: Array, number: Indices, flexible: Complex, modes: Modes
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


def _squares_above(frequency: Array, number: Indices, flexible: Complex, modes: Modes) -> Array:
    """Squared shapes (e, above), 1/kg, of the modes above the band where forces act."""
    natural, ratios, shapes = modes
    answers = modal.modal_answers(frequency, natural, ratios)
    above = frequency[-1] * np.array(ABOVE)
    columns = modal.modal_answers(frequency, above, np.full(above.size, RESIDUAL_DAMPING))
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
    best = through
    noise = np.inf
    while count < MOST_KNOTS * at.size:
        inner = np.interp(np.linspace(0.0, at.size - 1.0, count - DEGREE + 1), np.arange(at.size), at)
        knots = np.r_[(at[0],) * DEGREE, inner, (at[-1],) * DEGREE]
        found = scipy.interpolate.make_lsq_spline(at, shape, knots, k=DEGREE)
        scatter = float(np.sum((found(at) - shape) ** 2) / (at.size - count))
        if scatter > WORTH_KNOTS * noise:
            return best
        best = found
        noise = scatter
        count = int(MORE_KNOTS * count)
    return through


def _wavenumber(at: Array, shape: Array) -> float:
    """Root mean square slope of a shape over its root mean square, rad/m."""
    distance = np.diff(at)
    rise = np.sum(np.diff(shape) ** 2 / distance)
    size = np.sum(distance * 0.5 * (shape[:-1] ** 2 + shape[1:] ** 2))
    return float(np.sqrt(rise / size)) if size > 0.0 else 0.0


CREATED = 0.05
"""Share of a receptance that its imaginary part may be on the wrong side, by noise."""


def fit_structure(
    positions: Array,
    driven: Array,
    frequency: Array,
    receptance: Complex,
    *,
    mass: float | None = None,
    inertia: float | None = None,
) -> modal.ModalStructure:
    """Structure that is rolled over, by its receptances at several places under forces at some of them.

    Parameters
    ----------
    positions : ndarray (p,)
        Of the responses along the path, rising, m: six or more in the shortest wavelength.
    driven : ndarray (e,)
        Positions of the forces, m, each one of those of the responses.
    frequency : ndarray (n,)
        Hz, above zero and rising; fine enough for a few points in each resonance.
    receptance : ndarray (n, p, e) of complex
        Displacements along the force per force, m/N, e^{+iωt}.
    mass, inertia : float, optional
        Of a structure that nothing holds, see `ModalStructure.with_rigid_body`.

    Returns
    -------
    ModalStructure
        With its `fit_error`: the root mean square of the level differences where forces act, dB.

    Raises
    ------
    InputError
        If the record is short, if it creates energy (the other time factor), or if modes meet it to 6 dB
        only.

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
    at = positions
    f = frequency
    given = receptance
    modal_fit.check_record(f, given)
    near = np.abs(at[:, None] - driven)
    number = np.argmin(near, axis=0)
    if near.min(axis=0).max() > 1e-6 * np.ptp(at) or len(set(number)) < driven.size:
        received = f"forces at {', '.join(f'{force:.4g}' for force in driven[:8])}"
        allowed = "different places among those of the responses"
        raise InputError("positions of the forces (m)", received, allowed)
    _check_energy(f, given[:, number])
    rigid = np.zeros_like(given)
    if mass is not None:
        still = modal.ModalStructure(at, np.ones(1), 0.0, np.ones((at.size, 1)))
        moved = still.with_rigid_body(mass, inertia=inertia).mode_shapes[:, :-1]
        rigid = -(moved @ moved[number].T) / (2.0 * np.pi * f[:, None, None]) ** 2 + 0j
    natural, ratios, shapes = modal_fit.fit_shapes(f, given, rigid, number)
    inside = natural <= INSIDE * f[-1]
    natural = natural[inside]
    ratios = ratios[inside]
    shapes = shapes[:, inside]
    modal.warn_of_coarse(at, shapes, natural)
    modal_fit.warn_of_wide_lines(f, natural, ratios)
    fine, modes = with_stiffness_above(f, at, number, given - rigid, (natural, ratios, shapes))
    error = _judged(f, given[:, number], rigid[:, number], (*modes[:2], modes[2][::FINER][number]))
    # what is above the band has no wavelength
    with CoarseSamplingWarning.ignored():
        structure = modal.ModalStructure(fine, *modes, fit_error=error)
        if mass is None:
            return structure
        return structure.with_rigid_body(mass, inertia=inertia)


def fit_body(mass: float, load: float, frequency: Array, receptance: Complex) -> Body:
    """Body on one contact, as a wheel, by its receptance there.

    The mass is taken off; what is left is fitted by modes with positive modal masses, so that the body cannot
    create energy. Modes above the band are represented by their stiffness.

    Parameters
    ----------
    mass : float
        Of its rigid motion, kg.
    load : float
        Static force of the contact, weight included, N.
    frequency : ndarray (n,)
        Hz, above zero and rising; fine enough for a few points in each resonance. To twice what matters: with
        2 % of noise, a mode just above the end takes decibels from the band at it.
    receptance : ndarray (n,) of complex
        Displacement of the contact per force there, m/N, e^{+iωt}.

    Returns
    -------
    Body
        With its `fit_error`, dB.

    Raises
    ------
    InputError
        If the record is short, if it creates energy (the other time factor), or if it is no receptance in
        m/N of a body of this mass: a fit error above 6 dB.

    Warns
    -----
    EnergyWarning, UnconvergedWarning, CoarseSamplingWarning
        As `fit_structure`.
    """
    record = receptance[:, None, None]
    modal_fit.check_record(frequency, record)
    _check_energy(frequency, record)
    modes = modal_fit.fit_modes(frequency, receptance, Wheel(mass, load).receptance(frequency))
    modal_fit.warn_of_wide_lines(frequency, *modes[:2])
    found = Wheel(mass, load, *modes)
    error = modal_fit.level_error(found.receptance(frequency), receptance)
    modal_fit.judge_fit("receptance", error, f"modes on a mass of {mass:.4g} kg")
    return replace(found.body, fit_error=error)


def receptances_in(rows: Array, source: str) -> tuple[Array, Array, Array, Complex]:
    """Gather receptances from the lines of a table, as `fit_structure` takes them.

    Lines (k, 5) hold frequency, Hz, position of the response and of the force, m, real and imaginary part,
    m/N, in any order. Returns positions (p,), those of the forces (e,), frequencies (n,) and receptances
    (n, p, e).
    """
    (f, i), (at, j), (forces, k) = (np.unique(rows[:, c], return_inverse=True) for c in range(3))
    shape = f.size, at.size, forces.size
    if len(rows) != math.prod(shape) or len(np.unique(np.ravel_multi_index((i, j, k), shape))) < len(rows):
        received = count_of(len(rows), "line")
        positions = count_of(at.size, "position")
        driven = count_of(forces.size, "force")
        each = f"{count_of(f.size, 'frequency')}, {positions} and {driven}"
        allowed = f"{math.prod(shape)}: one for each of {each}"
        raise InputError(source, received, allowed, "Complete the table; nothing is filled in silently.")
    given = np.empty(shape, dtype=complex)
    given[i, j, k] = rows[:, 3] + 1j * rows[:, 4]
    return at, forces, f, given


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
        EnergyWarning.warn(
            f"The receptance creates energy at {percent(float(np.mean(created > CREATED)))} of its "
            f"frequencies, most at {rounded(frequency[worst], 5)} Hz: its imaginary part there is up to "
            f"{percent(float(created[worst]))} of it positive, more than {percent(CREATED)} of noise. The "
            "modes fitted to it create none. Check phases, and that forces and responses are counted in one "
            "direction at the same places."
        )


def _judged(f: Array, given: Complex, rigid: Complex, modes: Modes) -> float:
    """Error of the level at the places of the forces (e,), dB, by receptances there (n, e, e)."""
    natural, ratios, shapes = modes
    fitted = np.einsum("njj->nj", rigid) + modal.modal_answers(f, natural, ratios) @ (shapes**2).T
    error = modal_fit.level_error(fitted, np.einsum("njj->nj", given))
    modal_fit.judge_fit("receptance", error, count_of(len(natural), "mode"))
    return error
