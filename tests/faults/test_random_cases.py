"""Random legal cases from the schema: each is computed, every value finite or marked, or refused."""

import random
from contextlib import suppress
from copy import deepcopy

import numpy as np
import pytest
from program import LONG

import asperity
from asperity.case.any_case import entries
from asperity.case.cases import case_class, case_of
from asperity.errors import AsperityError
from asperity.parameters import Choice, Number, Quantity, limits_in
from asperity.units import quantity
from small_cases import unmarked

ROUGH = {
    "duration": "20 ms",
    "settling": "10 ms",
    "surface": {"rms": "0.2 um", "shortest": "50 um"},
    "contact": {"samples": 1, "spacing": "20 um"},
}
SHORT = {
    "ball-on-beam": ROUGH,
    "wheel-on-rail": ROUGH | {"surface": {"spectrum": "iso3095"}, "contact": {"samples": 1}},
    "bodies": ROUGH | {"body": {"positions": ["0 m", "0.2 m"], "load": "20 N"}},
}
LAWS = ["areal", "shifted", "printed", "table", "hertz", "linear", "linear-filtered", "hertz-filtered"]
LEFT = (
    "duration", "settling", "laws", "kind", "seed", "samples", "window", "spacing", "time_step",
    "sleeper_spacing",
)  # fmt: skip
"""Keys that decide how long a case takes."""


def drawn(entry, source):
    """A value of a key: near its default mostly, at a limit of what is plausible now and then; or None."""
    kind, default = entry.key.kind, entry.key.default
    if isinstance(kind, Choice):
        return source.choice(kind.known)
    if isinstance(kind, Number) and not kind.whole and isinstance(default, int | float):
        low, high = kind.at_least or kind.above or 0.0, kind.at_most or 10.0
        return source.choice([low, high, source.uniform(low, high), 0.5 * default])
    within = entry.key.within
    if not isinstance(kind, Quantity) or not within:
        return None
    limits = [quantity(limit, kind.dimension) for limit in limits_in(within)[:2]]
    example = entry.key.written_example
    if not isinstance(example, str) or example == "inf":
        return None
    value = quantity(example, kind.dimension) * 10.0 ** source.uniform(-0.7, 0.7)
    if source.random() < 0.1:
        value = source.choice(limits)
    return f"{min(max(value, limits[0]), limits[1])!r} {kind.dimension}"


def random_case(source):
    kind = source.choice(list(SHORT))
    case = deepcopy(SHORT[kind]) | {
        "kind": kind,
        "laws": source.sample(LAWS, 2),
        "seed": source.randrange(100),
    }
    known = [entry for entry in entries(case_class(kind)) if entry.name not in LEFT]
    for entry in source.sample(known, source.randint(1, 5)):
        section, _, name = entry.dotted.rpartition(".")
        value = drawn(entry, source)
        if value is not None:
            (case.setdefault(section, {}) if section else case)[name] = value
    return case


@pytest.mark.parametrize("seed", range(300) if LONG else (1,))
@pytest.mark.filterwarnings("ignore")
def test_a_random_case_is_computed_or_refused(seed, own_cache):
    source = random.Random(seed)
    for case in (random_case(source) for _ in range(50)):
        with suppress(AsperityError):
            case_of(case)
            break
    try:
        tree = asperity.run(case)
    except AsperityError as error:
        assert len(str(error)) < 2000, case  # noqa: PT017 (either is right)
        return
    assert list(unmarked(tree)) == [], case
    assert np.isfinite(tree["rolling/contact_force"].values).all(), case
