"""Keys: those that messages name exist, each has plausible limits, and none is read by nothing."""

import ast
import math
import re
from functools import cache

import pytest

from asperity.case import PRESETS
from asperity.case.any_case import entries
from asperity.case.cases import as_case, case_class
from asperity.errors import CaseError
from asperity.parameters import ListOf, Number, Quantity, Text, limits_in
from asperity.structures.track_parameters import LAYERS
from asperity.units import quantity
from package_source import MODULES, SOURCE, nodes_of
from refusals import refusals

FILES = (".png", ".x3p", ".csv", ".nc", ".toml")


@cache
def keys():
    """All keys of all kinds of case, as ``"contact.window"``, and those of studies."""
    known = {entry.dotted for kind in PRESETS for entry in entries(case_class(kind))}
    return known | {f"sweep.{key}" for key in known}


@cache
def sections():
    return {key.partition(".")[0] for key in keys() if "." in key}


@cache
def texts(module):
    """Pieces of text that people may see, with the line they stand in; no documentation."""
    nodes = nodes_of(module)
    silent = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}  # docstrings, also of constants
    said = [node for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    return [(node.lineno, node.value) for node in said if id(node) not in silent]


def named(text):
    """Keys with their sections, as messages name them: not paths of files, modules or results."""
    pattern = rf"(?<![\w./])({'|'.join(sections())})\.([a-z]\w*)(?![\w./(])"
    return {match[0] for match in re.finditer(pattern, text)}


def test_messages_name_keys_that_exist():
    said = [(text, f"{module}:{line}") for module in MODULES for line, text in texts(module) if "." in text]
    found = [(key, place) for text, place in said for key in named(text)]
    assert len(found) > 50
    modules = {".".join(m.relative_to(SOURCE).with_suffix("").parts) for m in MODULES}  # for lazy imports
    wrong = {where for where in found if where[0] not in keys() | modules}
    assert {where for where in wrong if not where[0].endswith(FILES)} == set()


def test_keys_in_brackets_exist():
    """``fill = true in [surface]``."""
    for module in MODULES:
        for line, text in texts(module):
            for match in re.finditer(r"(\w+) = [^=\n]*? in \[(\w+)\]", text) if " in [" in text else ():
                if match[2] in sections():
                    assert f"{match[2]}.{match[1]}" in keys(), f"{module}:{line}: {match[0]}"


# --- limits of what is plausible


def plausible(entry):
    """Least and largest value in SI, and the unit; those of the kind, where it has both."""
    kind = entry.key.one
    unit = kind.dimension if isinstance(kind, Quantity) else ""
    if entry.key.within:
        low, high, reason = limits_in(entry.key.within)
        assert len(reason) > 10
        return *(quantity(each, unit) for each in (low, high)), unit
    return kind.above if kind.at_least is None else kind.at_least, kind.at_most, unit


@pytest.mark.parametrize("kind", PRESETS)
def test_every_number_has_limits_and_beyond_them_is_told_why(kind):
    base = {"surface": {"smooth": True} if kind == "wheel-on-rail" else {"rms": "0.3 um"}}
    if kind in ("ball-bearing", "roller-bearing"):
        base = {"bearing": {"name": "6205" if kind == "ball-bearing" else "NU205"}}
    for entry in entries(case_class(kind)):
        if not isinstance(entry.key.one, Quantity | Number):
            continue
        low, high, unit = plausible(entry)
        assert -math.inf < low < high < math.inf, entry.dotted
        for value in (1.01 * high, low / 1.01 if low > 0 else 1.01 * low):
            if value == 0.0 or not entry.key.within:
                continue
            given = f"{value!r} {unit}" if unit else value
            keys = {entry.name: [given] if isinstance(entry.key.kind, ListOf) else given}
            inside = {entry.section: base.get(entry.section, {}) | keys} if entry.section else keys
            with pytest.raises(CaseError) as caught:
                as_case({"kind": kind} | base | inside)
            message = str(caught.value)
            stricter = "; allowed: a" in message  # its kind is, as a length greater than 0
            assert entry.dotted in message
            assert stricter or limits_in(entry.key.within)[2][1:] in message, entry.dotted


# --- keys that nothing reads


DECLARES = ("key", "optional", "section", "parameter", "of_line", "of_file")


def asked_for(module):
    """Names that are taken of an object, or named as text, but for those of declarations and defaults."""
    declared = {
        id(inside)
        for call in nodes_of(module)
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in DECLARES
        for inside in ast.walk(call)
    }
    for node in nodes_of(module):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
            yield node.attr
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in declared:
            yield node.value


def test_every_key_is_asked_for():
    """One that nothing reads would be shown and ignored."""
    asked = {name for path in MODULES for name in asked_for(path)}
    asked |= {f"{layer}_{what}" for layer in LAYERS for what in ("stiffness", "damping", "loss_factor")}
    known = {entry.dotted: entry.name for kind in PRESETS for entry in entries(case_class(kind))}
    assert len(known) > 150
    assert {key for key, name in known.items() if not {key, name} & asked} == set()


test_a_text_is_a_word_that_files_can_hold = refusals(
    ("", "a text in quotes"),
    (" ", "a text in quotes"),
    ("a\0b", "a text in quotes"),
    ("a\udc00", "a text in quotes"),
    (3, "a text in quotes"),
    of=lambda word: Text()(word),
)
