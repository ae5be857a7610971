"""What is warned of when bodies roll on several contacts, once for all of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.rolling.outcome import warn_if_beyond, warn_if_unconverged
from asperity.rolling.several.stepper import ContactsStepper


def warn_after_contacts(stepper: ContactsStepper, approach: NDArray[np.float64]) -> None:
    """Warn of forces that missed the tolerance, and of laws that were continued beyond their data.

    The approach (n, steps), m, is that which the laws saw. Contacts under laws of one name count together.
    """
    counts = stepper.motion.counts
    names = [law.name for law in stepper.laws]
    warn_if_unconverged(", ".join(dict.fromkeys(names)), counts, stacklevel=5)
    beyond = dict.fromkeys(names, 0)
    for name, law, seen in zip(names, stepper.prepared, approach, strict=True):
        if isinstance(law, Prepared):
            beyond[name] += int(evaluate_all(law, seen, 0)[2])
        else:
            law.warn_of_flaws()
    for name, count in beyond.items():
        warn_if_beyond(name, count, names.count(name) * approach.shape[1], stacklevel=5)
