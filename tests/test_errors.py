"""What errors say, and what the command line returns for them."""

import ast
import re

import pytest

from asperity import errors
from asperity.errors import CaseError, ComputationError, InputError, Outcome, PhysicsWarning
from package_source import MODULES, SOURCE, nodes_of, parsed


@pytest.mark.parametrize(("error", "code", "message"), [
    (InputError("radius", "-1 mm", "a length", "Give it."), 2,
     "radius: received -1 mm; allowed: a length. Give it."),
    (InputError("radius", 0, "a length"), 2, "radius: received 0; allowed: a length."),
    (CaseError("case.toml", ["one", "two"]), 2, "case.toml: 2 errors\n  - one\n  - two"),
    (ComputationError("it did not end", "a larger rtol"), 3, "it did not end. Try: a larger rtol."),
])  # fmt: skip
def test_errors_say_what_was_received_what_is_allowed_and_what_to_do(error, code, message):
    assert str(error) == message
    assert error.exit_code == code
    assert isinstance(error, ValueError) == (code == 2)


def test_every_physics_warning_has_a_class_with_a_meaning():
    classes = [kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, Warning)]
    assert len(classes) > 5
    for kind in classes:
        assert issubclass(kind, PhysicsWarning)
        assert kind.__doc__


@pytest.mark.parametrize("outcome", Outcome)
def test_outcomes_that_failed_give_advice(outcome):
    assert outcome.ok is (outcome in (Outcome.CONVERGED, Outcome.NO_CONTACT))
    assert outcome.ok or "; try" in outcome.value


def read_by_people(module):
    """Texts in a module that are no docstrings, no types, and no names that stand alone."""
    silent = set()
    for node in nodes_of(module):
        types = getattr(node, "annotation", None), getattr(node, "returns", None)
        silent |= {id(part) for of in types if of is not None for part in ast.walk(of)}
        if isinstance(node, ast.Expr):
            silent.add(id(node.value))
        words = node.value if isinstance(node, ast.Constant) and id(node) not in silent else None
        if isinstance(words, str) and not words.isidentifier():
            yield node.lineno, words


def test_nothing_that_people_read_has_class_names_or_backticks():
    """Texts of the whole program: messages, warnings, help, keys, reports. Full names of Python may stand."""
    classes = {name for path in MODULES for name in re.findall(r"^class (\w+)", parsed(path)[0], re.M)}
    compound = "|".join(sorted(name for name in classes if re.match("[A-Z][a-z]+[A-Z]", name)))
    named = re.compile(rf"`|(?<![\w.])({compound})\b")
    assert named.search("Take `table`.")
    assert named.search("a MissingSourceWarning")
    found = [
        f"{path.relative_to(SOURCE)}:{line}: {words}"
        for path in MODULES
        for line, words in read_by_people(path)
        if named.search(words)
    ]
    assert found == []
    templates = [path.read_text(encoding="utf-8") for path in SOURCE.rglob("*.jinja")]
    assert not [text for text in templates if re.search(r"\.category\b", text)]
