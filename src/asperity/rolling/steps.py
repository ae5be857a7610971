"""Steps of oscillators and bodies, exact for forces that are linear over a step, and their stability.

A force that is linear over each step moves bodies exactly. One that alternates from step to step
meets their *alternating compliance*: inertia makes it negative, −h²/12m for a free mass. As the poles of
bodies and contact interlace on the unit circle, the coupled step is stable while 1/K + (alternating
compliance) is positive, K being what the contact opposes to an alternating approach. Each body states its
own; those of both add up. Where a strong damper on a light body violates that,
the contact is softened by this compliance in series, and a tenth more, since on the bound itself nothing
damps the alternation: then the step is stable whatever K is. For a free mass that is Newmark's method with
β = 0.258 instead of 1/6.

A contact that opens and closes asks for more. A free mass m under forces that are linear over steps h meets
them as impulses hF between which it flies: with x + h²F/6m for its place x it moves by the leapfrog, on the
stiffness k = 1/(1/K + h²/6m). Over an impact the leapfrog keeps v² − (k/m)|ab|, with a and b the places at
the ends of the step in which the contact closes, or opens; |ab| is v²h²/4 at most. An impact may therefore
return more energy than it receives, by a factor up to 1/(1 − kh²/4m): without bound where the step is barely
stable, by 2 for kh² = 2m. What makes a contact no stiffer than that is a compliance of h²/3m − 1/K, four
times the alternating one less that of the contact; a rigid contact then returns what it receives. Modes are
such masses; an endless rail carries impacts away.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from scipy.linalg import block_diag, eigh

from asperity.arguments import Array, ArrayLike, Flags, NDArray
from asperity.errors import CoarseSamplingWarning, InputError, percent
from asperity.kernels.pointforce import DRY, Prepared, evaluate_all
from asperity.laws.spec import SteppedLaw
from asperity.quadrature import gauss
from asperity.structures.body import Body
from asperity.written_numbers import engineering, rounded

TAYLOR_RADIUS, TAYLOR_TERMS = 0.5, 14  # remainder below 1e-16
RESOLVED = 0.9 * np.pi
"""Angle by which a mode may turn in a step to be followed."""
STIFF = 0.1
"""Rate of a damper times the step from which what it takes is not found by the powers at both ends."""
GAUSS_POINTS = 8
ROUNDING = 1e-12
"""Share of the largest squared natural frequency of a body that counts as none."""


def exact_step(stiffness: Array, damping: Array, time_step: float) -> Array:
    """Exact steps of ``z'' + D z' + K z = p`` for forces p linear over the step, (k, 2 d, 4 d).

    Of k systems with d coordinates of unit mass, K and D (k, d, d). Factors of z, z', p at the start and p at
    the end: first those that give z at the end of the step, then those that give z' there. They are the
    matrix exponential of the system extended by its force, in time units of the step (Van Loan, IEEE Trans.
    Autom. Control 23 (1978) 395-404): one form for all kinds of systems, without division by a frequency.
    """
    h = time_step
    k, d, _ = stiffness.shape
    generator = np.zeros((k, 4 * d, 4 * d))
    place, rate, force, rise = (slice(i * d, (i + 1) * d) for i in range(4))
    generator[:, place, rate] = generator[:, rate, force] = generator[:, force, rise] = np.eye(d)
    generator[:, rate, place] = -(h**2) * stiffness
    generator[:, rate, rate] = -h * damping
    # rows and columns in z, h z', h^2 p_start, h^2 (p_end - p_start)
    step = exponentials(generator)[:, : 2 * d]
    step[..., force] -= step[..., rise]
    step[..., rate] *= h
    step[..., 2 * d :] *= h**2
    step[:, rate] /= h
    return step


def exponentials(matrices: Array) -> Array:
    """Exponentials of small matrices (k, n, n), all at once: Taylor series, scaled and squared."""
    largest = max(float(np.abs(matrices).sum(axis=2).max(initial=0.0)), 1e-300)  # no logarithm of zero
    squarings = max(0, int(np.ceil(np.log2(largest / TAYLOR_RADIUS))))
    scaled = matrices / 2.0**squarings
    unit = np.eye(matrices.shape[-1])
    result = unit + scaled / TAYLOR_TERMS
    for term in range(TAYLOR_TERMS - 1, 0, -1):
        result = unit + scaled @ result / term
    for _ in range(squarings):
        result = result @ result
    return result


def modal_coefficients(natural: ArrayLike, damping_ratio: ArrayLike, time_step: float) -> Array:
    """`exact_step` of modes ``q'' + 2 ζ ω q' + ω² q = p``, one after another: (8, modes).

    ω in rad/s, zero for a free mode; ζ one or more for an overdamped one; the time step in s.
    """
    omega, ratio = (np.asarray(given, dtype=float)[:, None, None] for given in (natural, damping_ratio))
    return np.ascontiguousarray(exact_step(omega**2, 2.0 * ratio * omega, time_step).reshape(-1, 8).T)


def resolved_step(natural: Array, damping_ratio: Array, time_step: float) -> Array:
    """`modal_coefficients`, but of modes that turn by more than RESOLVED in a step only their static answer.

    That is to the force at its end: sampled, they would seem slow, and move the wrong way.
    """
    coefficients = modal_coefficients(natural, damping_ratio, time_step)
    damped = natural * np.sqrt(np.maximum(1.0 - damping_ratio**2, 0.0))
    fast = damped * time_step > RESOLVED
    coefficients[:, fast] = 0.0
    coefficients[3, fast] = 1.0 / natural[fast] ** 2
    return coefficients


def alternating_of_modes(coefficients: Array) -> Array:
    """Alternating compliance of each mode, of coefficients (8, ...), for a shape of one."""
    a = coefficients
    # q and q' change their sign from step to step, as the force does
    determinant = (1.0 + a[0]) * (1.0 + a[5]) - a[1] * a[4]
    return ((a[3] - a[2]) * (1.0 + a[5]) - a[1] * (a[7] - a[6])) / determinant


def _natural(body: Body, time_step: float) -> tuple[Array, Array, Array, Flags]:
    """Squares of natural angular frequencies (d,), basis of natural coordinates and damping in it (d, d).

    And which of these coordinates turn by at most RESOLVED in a step.
    """
    for what in ("mass", "damping", "stiffness"):
        matrix = getattr(body, what)
        if np.abs(matrix - matrix.T).max() > 1e-9 * np.abs(matrix).max():
            raise InputError(f"{what} of a body", "a matrix that is not symmetric", "a symmetric matrix")
    squares, basis = eigh(body.stiffness, body.mass)  # y = basis z
    largest = float(np.abs(squares).max())
    if squares.min() < -1e-9 * largest:
        raise InputError("stiffness of a body", "a negative one", "springs that pull back")
    squares = np.where(squares > ROUNDING * largest, squares, 0.0)
    damping = basis.T @ body.damping @ basis
    turned = np.sqrt(np.maximum(squares - 0.25 * np.diag(damping) ** 2, 0.0)) * time_step
    return squares, basis, damping, turned <= RESOLVED


def body_step(body: Body, time_step: float) -> Array:
    """Exact step of the coordinates y of a body, as `exact_step`: (2, d, 4, d), of y, y' and forces on them.

    Natural coordinates that turn by more than RESOLVED in a step only answer as those of `resolved_step`.
    """
    squares, basis, damping, followed = _natural(body, time_step)
    slow = np.flatnonzero(followed)
    fast = np.flatnonzero(~followed)
    d = len(squares)
    step = np.zeros((2 * d, 4 * d))
    places = np.concatenate([slow, d + slow])
    stiffness = np.diag(squares[slow])
    step[np.ix_(places, np.concatenate([places, 2 * d + places]))] = exact_step(
        stiffness[None], damping[np.ix_(slow, slow)][None], time_step
    )[0]
    step[fast, 3 * d + fast] = 1.0 / squares[fast]
    natural = basis.T @ body.mass  # z = natural y
    step = np.kron(np.eye(2), basis) @ step @ block_diag(natural, natural, basis.T, basis.T)
    return step.reshape(2, d, 4, d)


def stiff_dampers(body: Body, time_step: float) -> bool:
    """Whether what a damper of a body takes over a step is not seen by the powers at its ends."""
    _, _, damping, followed = _natural(body, time_step)
    largest = np.linalg.eigvalsh(damping[np.ix_(followed, followed)]).max(initial=0.0)
    return bool(largest * time_step > STIFF)


def taken_by_dampers(body: Body, time_step: float) -> Array:
    """Energy that the dampers of a body take over a step, (4, d, 4, d): a quadratic form.

    Of y and y' at the start and of the forces on y at start and end, linear between. With the generator G of
    `exact_step` it is the integral of exp(Gᵀt) S exp(G t): by Gauss's rule over a part of the step in which
    little happens, and doubled from there, which is stable however stiff the dampers are.
    """
    squares, basis, damping, followed = _natural(body, time_step)
    d = len(squares)
    slow = np.flatnonzero(followed)
    h = time_step
    s = len(slow)
    place, rate, force, rise = (slice(i * s, (i + 1) * s) for i in range(4))
    damping = damping[np.ix_(slow, slow)]
    generator, power = np.zeros((2, 4 * s, 4 * s))
    generator[place, rate] = generator[rate, force] = generator[force, rise] = np.eye(s)
    generator[rate, place] = -(h**2) * np.diag(squares[slow])
    generator[rate, rate] = -h * damping
    power[rate, rate] = damping / h
    size = float(np.abs(generator).sum(axis=1).max(initial=TAYLOR_RADIUS))
    doublings = max(0, int(np.ceil(np.log2(size / TAYLOR_RADIUS))))
    part = 0.5**doublings
    places, weights = gauss(GAUSS_POINTS, 0.0, part)
    on_the_way = exponentials(generator * places[:, None, None])
    taken = np.einsum("n,nij,ik,nkl->jl", weights, on_the_way, power, on_the_way)
    (step,) = exponentials(generator[None] * part)
    for _ in range(doublings):
        taken = taken + step.T @ taken @ step
        step = step @ step
    natural = (basis.T @ body.mass)[slow]
    pushed = h**2 * basis.T[slow]  # z = natural y
    into = block_diag(natural, h * natural, np.zeros((2 * s, 2 * d)))
    into[force, 2 * d : 3 * d] = pushed
    into[rise, 2 * d : 3 * d] = -pushed
    into[rise, 3 * d :] = pushed
    return (into.T @ taken @ into).reshape(4, d, 4, d)


def missed_by_powers(body: Body, h: float, coordinates: Array, rates: Array, forces: Array) -> float:
    """Energy, J, that stiff dampers of a body take beyond the trapezoidal rule on the powers at steps, h s.

    Of a motion y (d, n) that started with rates (d,) and went on under contact forces (c, n), N.
    """
    from scipy.signal import lfilter

    step = body_step(body, h)
    pushed = body.contacts.T @ forces - body.pressing[:, None]
    y = coordinates[:, :-1]
    before = pushed[:, :-1]
    now = pushed[:, 1:]
    on_rates = step[1, :, 1]
    from_place = step[1, :, 0]
    from_before = step[1, :, 2]
    from_now = step[1, :, 3]
    driven = from_place @ y + from_before @ before + from_now @ now
    decay, shapes = np.linalg.eig(on_rates)
    amplitudes = np.linalg.solve(shapes, np.column_stack([rates, driven]).astype(complex))
    found = [lfilter([1.0], [1.0, -each], row) for each, row in zip(decay, amplitudes, strict=True)]
    rate = np.real(shapes @ np.array(found))
    given = np.stack([y, rate[:, :-1], before, now])
    taken = np.einsum("adn,adbe,ben->", given, taken_by_dampers(body, h), given, optimize=True)
    powers = np.sum(rate * (body.damping @ rate), axis=0)
    return float(taken - h * (powers.sum() - 0.5 * (powers[0] + powers[-1])))


def padded(parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Stack arrays of different sizes, (parts, ...), with zeros behind each."""
    if len({part.shape for part in parts}) == 1:
        return np.stack(parts)
    sizes = np.max([part.shape for part in parts], axis=0).astype(int)
    stack = np.zeros((len(parts), *sizes), dtype=parts[0].dtype)
    for k, part in enumerate(parts):
        where: tuple[Any, ...] = tuple(map(slice, part.shape))
        stack[k, *where] = part
    return stack


MARGIN = 0.5
"""Share of the bound up to which a step is taken as it is."""
STABLE = 1.1
"""Alternating compliances with which a step is stable on a rigid contact."""
ELASTIC = 4.0
"""Alternating compliances with which an impact on a rigid contact returns its energy."""
NEGLIGIBLE = 0.01
"""Share of the contact's compliance that may be added without a word."""
Limit = tuple[str, float, float]
"""What must be resolved: its name, its frequency, Hz, and the time steps in a period that it takes."""
RISE = 4.0
"""How much stiffer than at rest a contact may become: Hertz's does under 64 times the load."""


def largest_values(law: Prepared | SteppedLaw, at_rest: float) -> tuple[float, float, float]:
    """Largest stiffness, N/m, stiffness in impacts, N/m, and force, N, of a law within what it was made for.

    `at_rest` is the stiffness under the load, N/m. The stiffness in impacts is zero of a contact that never
    opens, the force where it is not known.
    """
    if not isinstance(law, Prepared):
        return RISE * at_rest, RISE * at_rest, 0.0
    stiffness = at_rest
    force = 0.0
    if np.isfinite(law.upper):
        height = law.values.max(axis=1) if not len(law.slopes) else 0.0
        dry = law._replace(film=DRY)  # which is stiffer
        forces, slopes, _ = evaluate_all(dry, law.planes + height + law.upper, 0)
        stiffness = max(at_rest, float(slopes.max()))
        force = float(forces.max())
    # a force δⁿ becomes stiffer by (load)^(1 − 1/n)
    rise = RISE ** (3.0 * (law.exponent - 1.0) / law.exponent)
    return stiffness, 0.0 if law.bilateral else max(stiffness, rise * at_rest), force


def softening(
    alternating: Array,
    thrown: Array,
    stiffness: Array,
    impacts: Array,
    damping: Array,
    at_rest: Array,
    time_step: float,
) -> Array:
    """Compliances in series with contacts (n,), m/N, that keep a time step stable, s, and impacts elastic.

    Zero if they are so already. Least alternating compliances of both bodies, and of what throws them apart,
    m/N; the largest stiffness of the contacts, that of impacts, and that at rest, N/m; damping in N s/m. Of
    contacts that become softer by more than NEGLIGIBLE, the one that does most is warned of.
    """
    opposed = -alternating * (stiffness + 4.0 * damping / time_step) / MARGIN
    impact = ELASTIC * -thrown * impacts
    rigid = np.where(impact > 1.0, (impact - 1.0) / np.where(impacts > 0.0, impacts, 1.0), 0.0)
    softer = np.maximum(np.where(opposed > 1.0, STABLE * -alternating, 0.0), rigid)
    worst = int(np.argmax(softer * at_rest))
    share = float(softer[worst] * at_rest[worst])
    if share >= NEGLIGIBLE:
        stable = opposed if damping[worst] > 0.0 else np.sqrt(np.maximum(opposed, 0.0))
        shorter = max(stable[worst], np.sqrt(max(impact[worst], 0.0)))
        CoarseSamplingWarning.warn(
            f"the time step of {engineering(time_step, 's', 2)} is too long for a contact as stiff, or as "
            f"damped, on bodies as light: it is kept stable by softening the contact by {percent(share)}, "
            f"and motion near {rounded(0.5 / time_step, 2)} Hz is distorted; take at most "
            f"{engineering(time_step / shorter, 's', 2)}"
        )
    return softer


def contact_resonance(stiffness: Array, direct: Array, alternating: Array, time_step: float) -> Array:
    """Natural frequencies, Hz, of bodies on contacts, N/m, from their two compliances in a time step, m/N.

    A mass m has α = h²/6m and β = −h²/12m, a spring of compliance c has α = β = c.
    """
    inverse_mass = np.maximum(4.0 * (direct - alternating), 0.0) / time_step**2
    compliance = np.maximum(direct + 2.0 * alternating, 0.0) / 3.0
    return np.sqrt(inverse_mass * stiffness / (1.0 + stiffness * compliance)) / (2.0 * np.pi)


def warn_if_coarse(time_step: float, limits: Iterable[Limit]) -> None:
    """Compare the time step with the periods that it must resolve."""
    for what, frequency, least in limits:
        if frequency * time_step * least > 1.0:
            CoarseSamplingWarning.warn(
                f"{what}, {rounded(frequency, 4)} Hz, has {rounded(1.0 / (frequency * time_step))} time "
                f"steps in a period, fewer than {least:.0f}: its response is distorted; take a time step "
                f"of at most {engineering(1.0 / (least * frequency), 's', 2)}"
            )
