"""The source of the package as tests look at it: each module is read, and walked through, once."""

import ast
from functools import cache
from pathlib import Path

import asperity

SOURCE = Path(asperity.__file__).parent
MODULES = sorted(SOURCE.rglob("*.py"))


@cache
def parsed(module):
    """Text of a module, and its tree."""
    text = module.read_text(encoding="utf-8")
    return text, ast.parse(text)


@cache
def nodes_of(module):
    """All nodes of the tree of a module, the outer ones first."""
    return list(ast.walk(parsed(module)[1]))
