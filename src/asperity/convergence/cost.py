"""What it takes to compute a case again with each of its settings made finer."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from asperity.convergence.running import brief, changed_case, settings_for
from asperity.errors import InputError, PhysicsWarning
from asperity.progress import Progress
from asperity.scenarios.expecting import Work, expect
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.refining import Setting
from asperity.scenarios.trial import try_contacts
from asperity.schema.convergence import PATH_LENGTH

ONCE = ("report", "compiling")
"""Parts of the work that are done once."""


def expected_convergence(prepared: PreparedCase, work: Work, progress: Progress) -> dict[str, float | str]:
    """Expect the time of each setting, s, or say why it will not be changed.

    Parameters
    ----------
    prepared : PreparedCase
        The case.
    work : Work
        What the case itself takes.
    progress : Progress
        Called between the pieces.

    Returns
    -------
    dict of str to float or str
        By setting, where nothing is found in the cache but what the case itself leaves there.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        states = _states(prepared, progress)
        settings = [s for s in settings_for(prepared, states) if s.name != PATH_LENGTH]
        return {setting.name: _expected(prepared, setting, work, progress) for setting in settings}


def _states(prepared: PreparedCase, progress: Progress) -> NDArray[np.float64]:
    """States much as the run will choose them, (k,), m; none without samples."""
    if not prepared.textures.maps:
        return np.zeros(0)
    return try_contacts(prepared, progress).approaches


def _expected(prepared: PreparedCase, setting: Setting, work: Work, progress: Progress) -> float | str:
    """Time of a setting: of the finer case, and of the case itself on its surface, s."""
    limit = setting.limit
    for way in setting.ways:
        try:
            changed = changed_case(prepared, way)
        except InputError as error:
            limit = limit or brief(error)
            continue
        alone = setting.laid_anew and not way.coarser
        return _repeated(expect(changed, progress), scans=not setting.scans_kept) + (
            _repeated(work) if alone else 0.0
        )
    return limit


def _repeated(work: Work, *, scans: bool = True) -> float:
    """Time of what is done again, with the scans or without, s."""
    kept = tuple(f"scanning for the {name}" for name in work.scans)
    left_out = ONCE if scans else (*ONCE, *kept)
    return sum(seconds for part, seconds in work.seconds.items() if part not in left_out)
