"""The examples are run, and hold what they assert, where the gallery is built; here, that they stay short."""

import ast
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.py"))


def lines_of_code(text):
    """Lines that are neither blank, nor a comment, nor the first docstring."""
    body = ast.parse(text).body
    after = body[0].end_lineno if ast.get_docstring(ast.parse(text)) else 0
    stripped = (line.strip() for line in text.splitlines()[after:])
    return sum(bool(line) and not line.startswith("#") for line in stripped)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_it_is_short_and_asserts_what_it_says(example):
    text = example.read_text(encoding="utf-8")
    assert lines_of_code(text) <= 60
    assert sum(isinstance(node, ast.Assert) for node in ast.parse(text).body) >= 2
