"""The moving point force: contact laws, one file and one line in the registry each.

What is known of a law before it is built is a `LawSpec`. Built from the materials of a case, a law is a
frozen description of the contact; ``law.prepare(positions)`` lays it out on the path, for the compiled
stepper (`asperity.kernels.pointforce.Prepared`) or for stepping from Python (`SteppedLaw`). Nothing here
imports compiled code before it is needed.
"""

import importlib
from collections.abc import Iterable, Mapping

from asperity import extensions
from asperity.arguments import nearest, require, shown
from asperity.errors import InputError
from asperity.laws.areal import Areal
from asperity.laws.direct import Direct
from asperity.laws.hertz import HertzLaw
from asperity.laws.linear import Linear
from asperity.laws.printed import Printed
from asperity.laws.shifted import Shifted
from asperity.laws.spec import (
    Law,
    LawSpec,
    Look,
    Materials,
    Need,
    PairedLaw,
    Role,
    SteppedLaw,
    Variant,
    from_materials,
)
from asperity.laws.table import Table
from asperity.parameters import Key

__all__ = [
    "Areal", "Direct", "HertzLaw", "Law", "LawSpec", "Linear", "Look", "Materials", "Need", "PairedLaw",
    "Printed", "Role", "Shifted", "SteppedLaw", "Table", "Variant", "baselines", "built", "family_of",
    "from_materials", "in_role", "law_keys", "names", "needs_of", "reference", "register", "spec_of",
    "unregister",
]  # fmt: skip

BUILT_IN = (
    "areal",
    "shifted",
    "printed",
    "table",
    "direct",
    "hertz",
    "linear",
)
"""Modules of this package, each with its ``LAW``, in the order in which people read of them."""

_specs: dict[str, LawSpec] = {}  # of laws and variants
_families: dict[str, tuple[str, ...]] = {}  # names of each law and its variants
_keys: dict[str, Mapping[str, Key]] = {}  # of the laws that have some of their own


def _installed() -> tuple[str, ...]:
    """Laws that every process knows: those of the program, and of packages beside it, which it registers."""
    return (*BUILT_IN, *extensions.taken(extensions.LAWS, _take))


def _take(name: str, law: object) -> LawSpec:
    """Register a law of another package, which calls it by its name."""
    if not isinstance(law, LawSpec):
        raise InputError("law", shown(law), "an asperity.laws.LawSpec")
    require(law.name == name, "name of the law", shown(law.name), f'"{name}", as its entry point has it')
    _add(law)
    return law


def _known() -> dict[str, LawSpec]:
    """All laws and variants by name, those of packages beside the program, which it registers, among them."""
    extensions.taken(extensions.LAWS, _take)
    return _specs


def names() -> tuple[str, ...]:
    """List the names that may stand in a case, each law followed by its variants."""
    return tuple(_known())


def spec_of(name: object) -> LawSpec:
    """Find a law, or a variant of one, by its name, as ``"linear-filtered"``."""
    known = _known()
    if not isinstance(name, str) or name not in known:
        allowed = ", ".join(f'"{each}"' for each in known)
        raise InputError("law", shown(name), allowed, nearest(name, names()))
    return known[name]


def family_of(name: str) -> str:
    """Name of the law that a law is a variant of, or is itself."""
    _installed()
    return next(family for family, members in _families.items() if name in members)


def built(materials: Materials) -> Law:
    """Build the law that some materials are for, and hold it to what a law is."""
    spec = materials.law
    law = spec.build(materials)
    if not isinstance(law, Law):
        allowed = "an object with name, damping and prepare(positions)"
        raise InputError(f"law {spec.name}", shown(law), allowed)
    if law.name != spec.name:
        remedy = "Hand the name of the materials on to it."
        raise InputError(f"law {spec.name}", f"one built as {shown(law.name)}", shown(spec.name), remedy)
    if spec.both_surfaces and not isinstance(law, PairedLaw):
        allowed = "an object with prepare_pair(positions, other, other_positions) as well"
        raise InputError(f"law {spec.name}", shown(law), allowed)
    return law


def law_keys() -> dict[str, Mapping[str, Key]]:
    """Keys of the laws that have some of their own, by the name of the law and by theirs."""
    _installed()
    return _keys


def register(law: LawSpec) -> None:
    """Add a law, which may then stand in cases of any kind.

    It is known to this process until `unregister`, where the members of a study that roll it are computed. A
    law of an installed package, which names it by an entry point ``asperity.laws``, is known to all.

    Parameters
    ----------
    law : LawSpec
        The law, with its variants.

    Raises
    ------
    InputError
        If it is no `LawSpec`, or a name or role of it is taken.

    Examples
    --------
    >>> from asperity import laws
    >>> def build(materials):
    ...     constant = 2.0 * materials.hertz_constant
    ...     return laws.HertzLaw(constant, materials.line, materials.damping, materials.name)
    >>> laws.register(laws.LawSpec("stiffer", "Hertzian contact, twice as stiff.", build))
    >>> "stiffer" in laws.names()
    True
    >>> laws.unregister("stiffer")
    """
    require(isinstance(law, LawSpec), "law", shown(law), "an asperity.laws.LawSpec")
    _installed()
    _add(law)


def _add(law: LawSpec) -> None:
    """Add a law whose names and roles no other law has."""
    taken: dict[Role | None, str] = {spec.role: spec.name for spec in _specs.values() if spec.role}
    remedy = "Take another name, or unregister that law first."
    for spec in law.family:
        allowed = "a name that no other law has"
        require(spec.name not in _specs, "name of a law", shown(spec.name), allowed, remedy)
        received = f'"{spec.role}", which the law {taken.get(spec.role)} has'
        allowed = "a role that no other law has, or None"
        require(spec.role not in taken, f"role of law {spec.name}", received, allowed)
    _specs.update({spec.name: spec for spec in law.family})
    _families[law.name] = tuple(spec.name for spec in law.family)
    if law.parameters:
        _keys[law.name] = law.parameters


def comes_with_the_program(name: str) -> bool:
    """Whether every process knows a law, or it was registered in this one."""
    return family_of(name) in _installed()


def unregister(name: str) -> None:
    """Forget a law that was registered, with its variants; those that are installed stay."""
    spec_of(name)
    own = [law for law in _families if law not in _installed()]
    registered = ", ".join(f'"{law}"' for law in own) or "none is"
    require(name in own, "law", shown(name), f"a law that was registered ({registered})")
    _keys.pop(name, None)
    for member in _families.pop(name):
        del _specs[member]


def needs_of(laws: Iterable[str]) -> frozenset[Need]:
    """Collect what any of some laws needs."""
    return frozenset().union(*(spec_of(name).needs for name in laws))


def in_role(role: Role, laws: Iterable[str]) -> str | None:
    """Find the law that has a role among some laws."""
    return next((name for name in laws if spec_of(name).role is role), None)


def baselines(laws: Iterable[str]) -> list[str]:
    """List the laws, among some, that levels are compared with, that of practice first."""
    among = list(laws)
    found = (in_role(role, among) for role in (Role.PRACTICE, Role.BARE))
    return [name for name in found if name is not None]


def reference(laws: Iterable[str]) -> str | None:
    """Find the law, among some, that the others are held against."""
    among = list(laws)
    return in_role(Role.REFERENCE, among) or in_role(Role.STAND_IN, among)


for _module in BUILT_IN:
    _add(importlib.import_module(f"asperity.laws.{_module}").LAW)
