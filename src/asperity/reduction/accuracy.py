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
"""Tolerance from which single precision reaches it in as many iterations as double."""
SINGLE_PAYS = 2e9
"""Cells of all contacts of a scan from which single precision saves more than the 10 s to compile it."""


def in_single(rtol: float, cells: float) -> bool:
    """Whether single precision is enough for a scan, and pays.

    Parameters
    ----------
    rtol : float
        Tolerance of each solution.
    cells : float
        Cells of a window times the number of solutions.

    Returns
    -------
    bool
        Known before the scan, and the same on all machines.
    """
    return rtol >= SINGLE_ENOUGH and cells >= SINGLE_PAYS


def rtol_for(accuracy: float) -> float:
    """Tolerance of a contact solution whose force shall have a relative accuracy.

    Parameters
    ----------
    accuracy : float
        Largest relative error of the force, above 0 and at most 0.1.

    Returns
    -------
    float
        `rtol` of `HalfSpace.solve`: the largest complementarity residual relative to the largest overlap.

    Raises
    ------
    InputError
        If the accuracy is out of range.

    Notes
    -----
    A residual e on the contact set acts as an error of the approach: by reciprocity it changes the force by
    no more than k_t max|e|. Relative to the force, with F growing as the n-th power of the overlap, that is n
    times the relative residual: 1.5 for Hertz, 1 to 3 for rough contacts, if the residual had everywhere its
    largest value and one sign. It alternates: on smooth, rough and flowing contacts, from first touches to
    heavy loads, the largest error found is twice the relative residual
    (``benchmarks/force_accuracy.py``).
    """
    if not 0.0 < accuracy <= 0.1:
        raise InputError("accuracy of the force", accuracy, "a number above 0, at most 0.1", "Try 1e-4.")
    return accuracy / SAFETY
