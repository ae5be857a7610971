"""What messages tell people to do: the keys they name exist, and what they advise helps."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

import asperity
from asperity.case import PRESETS
from asperity.case.cases import as_case, case_class
from asperity.case.describing import entries
from asperity.errors import CaseError
from asperity.units import quantity

SOURCE = Path(asperity.__file__).parent
MODULES = sorted(SOURCE.rglob("*.py"))
FILES = (".png", ".x3p", ".csv", ".nc", ".toml")


@cache
def keys():
    """All keys of all kinds of case, as ``"contact.window"``, and those of studies."""
    known = {entry.dotted for kind in PRESETS for entry in entries(case_class(kind))}
    return known | {f"sweep.{key}" for key in known}


@cache
def sections():
    return {key.partition(".")[0] for key in keys() if "." in key}


def texts(module):
    """Pieces of text that people may see, with the line they stand in; no documentation."""
    tree = ast.parse(module.read_text(encoding="utf-8"))
    silent = {
        id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)
    }  # docstrings, also of constants
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in silent:
            yield node.lineno, node.value


def named(text):
    """Keys with their sections, as messages name them: not paths of files, modules or results."""
    pattern = rf"(?<![\w./])({'|'.join(sections())})\.([a-z]\w*)(?![\w./(])"
    return {match[0] for match in re.finditer(pattern, text)}


def test_keys_are_found_in_a_text():
    assert named("Raise contact.samples, or give track.name; see wheel.csv") >= {
        "contact.samples",
        "track.name",
    }
    assert not named("/spectra/surface.nc, contact/force, surface.")


def test_messages_name_keys_that_exist():
    found = [
        (key, f"{module}:{line}") for module in MODULES for line, text in texts(module) for key in named(text)
    ]
    assert len(found) > 50
    modules = {".".join(m.relative_to(SOURCE).with_suffix("").parts) for m in MODULES}  # for lazy imports
    wrong = {where for where in found if where[0] not in keys() | modules}
    assert {where for where in wrong if not where[0].endswith(FILES)} == set()


def test_keys_in_brackets_exist():
    """``fill = true in [surface]``."""
    for module in MODULES:
        for line, text in texts(module):
            for match in re.finditer(r"(\w+) = [^=\n]*? in \[(\w+)\]", text):
                if match[2] in sections():
                    assert f"{match[2]}.{match[1]}" in keys(), f"{module}:{line}: {match[0]}"


BALL = {"kind": "ball-on-beam", "surface": {"rms": "0.5 um"}}


@pytest.mark.parametrize(
    ("section", "key", "value", "shown"),
    [
        ("contact", "window", "1e-7 mm", "0.1 nm"),
        ("ball", "radius", "1e-7 mm", "0.1 nm"),
        ("ball", "radius", "300 km", "300 km"),
        ("beam", "length", "0.02 um", "20 nm"),
    ],
)
def test_numbers_in_messages_read_well_and_are_what_was_given(section, key, value, shown):
    """No "1e-07 mm": a number is shown with a unit that suits it."""
    with pytest.raises(CaseError, match=rf"{section}\.{key}: received") as caught:
        as_case({**BALL, section: {key: value}})
    received = re.search(rf"{section}\.{key}: received ([^;,]*)[;,]", str(caught.value))[1]
    assert received == shown
    assert quantity(received, "m") == pytest.approx(quantity(value, "m"))
