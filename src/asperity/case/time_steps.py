"""Time step of a case that gives none: spectra are resolved, contacts, and what moves under them."""

import math
from typing import TYPE_CHECKING

import numpy as np

from asperity.case.rolled_over import TrackKeys
from asperity.case.rolling_case import RollingCase
from asperity.errors import InputError, PhysicsWarning
from asperity.rolling.resolution import PER_MODE, PER_RESONANCE, PER_RESONANCE_ON_RAIL, PER_SLEEPER
from asperity.structures.track import Track

if TYPE_CHECKING:
    from asperity.structures.modal import Modal

SPARE = 1.1
"""How much shorter steps are than a run asks for, where they are chosen by that."""
PLACES = 9
"""Places along the run at which a structure is looked at."""
ROUNDS = 8
"""Times that a step is shortened, whose resonance depends on it."""


def on_grid(wanted: float, per_cell: float) -> float:
    """Time step, s, near the one wanted, with positions on the grid of the contact solution.

    A whole multiple, rounded down, or a whole fraction of the time, s, in which one cell is rolled over.
    """
    if wanted >= per_cell:
        return per_cell * math.floor(wanted / per_cell * (1 + 1e-9))
    parts = math.ceil(per_cell / wanted * (1 - 1e-9))
    # on the grid the texture needs no interpolation: rather a slightly longer step than a finer one
    nearest = min((parts, max(parts - 1, 1)), key=lambda n: abs(math.log(per_cell / n / wanted)))
    return per_cell / nearest


def resolving(case: RollingCase, usual: float) -> float:
    """A time step as usual, s, or the longest on the grid with which no run doubts what it resolves."""
    longest = longest_step(case, usual)
    step = usual
    per_cell = case.contact.spacing / case.speed
    for _ in range(ROUNDS):
        if step <= longest:
            return step
        wanted = longest / SPARE
        whole = per_cell * math.floor(wanted / per_cell) if wanted >= per_cell else 0.0
        step = whole or per_cell / math.ceil(per_cell / wanted)
        longest = longest_step(case, step)
    return step


def longest_step(case: RollingCase, step: float) -> float:
    """Time in s up to which a step of about this length, s, is short for all that it has to resolve."""
    over = case.rolled_over
    stiffness = case.resting_stiffness
    with PhysicsWarning.ignored():
        try:
            if isinstance(over, TrackKeys):
                track = over.model()
                bay = math.sqrt(stiffness / (track.mass_per_length * track.sleeper_spacing)) / (2.0 * math.pi)
                sleepers = case.speed / track.sleeper_spacing
                return 1.0 / max(PER_RESONANCE_ON_RAIL * bay, PER_SLEEPER * sleepers)
            under = over.liveliest(case.numerics.highest_frequency)
            most = _wanted(under.frequency, _resonance(case, stiffness, under.inverse_mass), case)
            if step * most > 1.0 and over.extent is not None:
                model = over.model(case.numerics.highest_frequency)
                if not (model is None or isinstance(model, Track)):
                    most = _wanted(*_looked_at(case, model, stiffness, step), case)
            return 1.0 / most
        except InputError:  # of what is rolled over: the case is refused
            return math.inf


def _wanted(mode: float, resonance: float, case: RollingCase) -> float:
    """Time steps in a second that a mode of a structure and the contact resonance on it ask for, Hz each."""
    return max(PER_MODE * mode, PER_RESONANCE * max(resonance, case.contact_resonance))


def _resonance(case: RollingCase, stiffness: float, inverse_mass: float) -> float:
    """Natural frequency, Hz, of what rolls on contacts, N/m, on what moves like so much per mass, 1/kg."""
    body = case.rolling
    moved = 1.0 / body.contact_mass + len(body.offsets) * inverse_mass
    return math.sqrt(stiffness * moved) / (2.0 * math.pi)


def _looked_at(case: RollingCase, model: "Modal", stiffness: float, step: float) -> tuple[float, float]:
    """Highest mode of a structure, and the contact resonance on it, Hz, as a run finds them for a step, s."""
    from asperity.rolling import steps
    from asperity.structures.modal import HIGHEST

    frequencies = model.natural_frequencies
    coefficients = steps.resolved_step(2.0 * math.pi * frequencies, model.damping_ratios, step)
    each = steps.alternating_of_modes(coefficients)
    places = np.linspace(*case.rolled_range, PLACES)[:, None] + np.array(case.rolling.offsets)
    shapes = model.shapes(places.ravel())[0].reshape(*places.shape, -1)
    least = float(np.linalg.eigvalsh((shapes * each) @ shapes.transpose(0, 2, 1)).min())
    direct = float((shapes**2 @ coefficients[3]).max())
    own = step**2 / case.rolling.contact_mass  # of a mass: direct a sixth of it, alternating less a twelfth
    compliances = np.array([direct + own / 6.0]), np.array([least - own / 12.0])
    found = steps.contact_resonance(np.array([stiffness]), *compliances, step)
    return float(frequencies[frequencies <= HIGHEST].max(initial=0.0)), float(found[0])
