"""What of its table a study shows: what is usual for a kind of case, or what was asked for by name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from asperity.arguments import nearest, shown
from asperity.errors import InputError
from asperity.kinds import KINDS
from asperity.schema import contact, rolling, spectra
from asperity.studies.kept import names_kept

WEIGHTED = f"{spectra.FORCE_LEVEL.name}_a"
OVER = f"{WEIGHTED}_difference_to_"
"""Beginning of the names of differences, which are printed, and drawn where they are asked for."""
_FIRST = (WEIGHTED, f"{OVER}linear_filtered", f"{OVER}linear")
_THEN = (
    contact.TRACK_RMS.name,
    contact.YIELDED_SHARE.name,
    contact.RUNNING_IN_LOWERING.name,
    contact.TRACK_STIFFNESS.name,
    "rms_force",
    "peak_force",
    rolling.CONTACT_LOSS_SHARE.name,
)


def usual(kind: str) -> tuple[str, ...]:
    """Names of what a study of a kind of case shows unasked, where its table has it."""
    return (*_FIRST, *KINDS[kind].shown, *_THEN)


def usual_in_figures(kind: str) -> tuple[str, ...]:
    """Names of what its figures show unasked."""
    return tuple(name for name in usual(kind) if not name.startswith(OVER))


def chosen(words: Iterable[str], kind: str) -> tuple[str, ...]:
    """Names that words of the command line ask for, each word with commas between names.

    Spaces may stand for underscores, as in the headings that are printed.
    """
    known = names_kept(kind)
    names = ["_".join(name.split()) for word in words for name in word.split(",")]
    for name in names:
        if name not in known:
            raise InputError("--show", shown(name), _listed(sorted(known)), nearest(name, list(known)))
    return tuple(dict.fromkeys(names))


def _listed(names: Sequence[str]) -> str:
    return f"names of what a study keeps: {', '.join(names)}"
