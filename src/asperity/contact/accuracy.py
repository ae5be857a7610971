"""How tightly a contact is solved, by what its force is for."""

from __future__ import annotations

from asperity.errors import InputError

FORCE_ACCURACY = 1e-4
"""Largest relative error of a scanned force: at most 0.2 dB in a band of the force on a path, to ka = 16."""
FILTER_SHARE = 0.1
"""Accuracy of the scans for contact filters, relative to that: short waves are small parts of a force."""
SAFETY = 2.5
"""Residual asked for, below the accuracy of the force: see `rtol_for`."""

SINGLE_ENOUGH = 2e-6
"""`rtol` from which single precision reaches it in as many iterations as double."""
SINGLE_PAYS = 2e9
"""Cells of all contacts of a scan from which single precision saves more than the 10 s to compile it."""


def rtol_for(force_accuracy: float) -> float:
    """`rtol` of a contact solution whose force shall have a relative accuracy, above 0 and at most 0.1.

    Notes
    -----
    A residual e on the contact set acts as an error of the approach: by reciprocity it changes the force by
    no more than k_t max|e|. Relative to the force, with F growing as the n-th power of the overlap, that is n
    times the relative residual: 1.5 for Hertz, 1 to 3 for rough contacts, if the residual had everywhere its
    largest value and one sign. It alternates: on smooth, rough and flowing contacts, from first touches to
    heavy loads, the largest error found is twice the relative residual
    (``benchmarks/force_accuracy.py``).
    """
    if not 0.0 < force_accuracy <= 0.1:
        raise InputError("force_accuracy", force_accuracy, "a number above 0, at most 0.1", "Try 1e-4.")
    return force_accuracy / SAFETY
