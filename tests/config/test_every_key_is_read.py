"""A key that nothing reads would be shown and ignored: each one is asked for by name somewhere."""

import ast
from pathlib import Path

import asperity
from asperity.case import PRESETS
from asperity.case.cases import case_class

SOURCE = Path(asperity.__file__).parent
DECLARES = ("key", "optional", "section", "parameter", "goes_with")


def asked_for(text):
    """Names that are taken of an object, or named as text, but for those of declarations and defaults."""
    tree = ast.parse(text)
    declared = {
        id(inside)
        for call in ast.walk(tree)
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in DECLARES
        for inside in ast.walk(call)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
            yield node.attr
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in declared:
            yield node.value


def test_every_key_is_asked_for():
    asked = {name for path in SOURCE.rglob("*.py") for name in asked_for(path.read_text(encoding="utf-8"))}
    known = {
        f"{title}.{name}"
        for model in map(case_class, PRESETS)
        for title, section in {"": model, **{t: each.model for t, each in model.sections().items()}}.items()
        for name in section.keys
    }
    assert len(known) > 100
    assert {key for key in known if key.rpartition(".")[2] not in asked} == set()


def test_a_key_that_is_only_declared_is_not_asked_for():
    text = 'class Mine:\n    share: float = key(Number(), 1.0, "a share", goes_with="other")\n'
    assert not {"share", "other"} & set(asked_for(text))
    assert "share" in set(asked_for(text + "    def of(self):\n        return self.share\n"))
