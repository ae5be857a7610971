"""The house rules that a machine can check: layers, lazy imports, sizes, what the text may say."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import asperity

ROOT = Path(__file__).parents[1]
SOURCE = Path(asperity.__file__).parent
MODULES = sorted(SOURCE.rglob("*.py"))


def test_imports_point_one_way():
    done = subprocess.run(
        [sys.executable, "-c", "from importlinter.cli import lint_imports; raise SystemExit(lint_imports())"],
        cwd=ROOT, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout


HEAVY = [
    "numba",
    "scipy",
    "xarray",
    "matplotlib",
    "pint",
    "pydantic",
    "rich",
    "jinja2",
    "starlette",
    "uvicorn",
]
LATE = [f"scipy.{name}" for name in ("optimize", "interpolate", "ndimage", "signal", "stats", "sparse")]


@pytest.mark.parametrize(
    ("statement", "waiting"),
    [
        ("import asperity", HEAVY),
        ("import asperity.cli", HEAVY),
        ("import asperity.scenarios.preparing", LATE),  # what is written out, is loaded when first named
        ("import asperity.scenes.report as r; r.names_of_reports()", ["matplotlib"]),  # it draws for papers
    ],
)
def test_packages_wait_until_they_are_used(statement, waiting):
    code = f"import sys; {statement}; print([m for m in {waiting!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_public_names_resolve():
    for name in asperity.__all__:
        assert getattr(asperity, name) is not None
    assert set(asperity.__all__) <= set(dir(asperity))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        asperity.nothing  # noqa: B018


def test_modules_and_functions_stay_readable():
    for module in MODULES:
        text = module.read_text(encoding="utf-8")
        assert text.count("\n") <= 600, module
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef):
                doc = ast.get_docstring(node)
                length = node.end_lineno - node.lineno + 1 - (doc.count("\n") + 1 if doc else 0)
                assert length <= 70, f"{module}: {node.name} has {length} lines"


def test_nothing_is_pickled_and_no_text_is_evaluated():
    banned = {"pickle", "cPickle", "dill", "joblib", "shelve", "marshal", "eval", "exec"}
    for module in MODULES:
        text = module.read_text(encoding="utf-8")
        assert not re.search(r"allow_pickle\s*=\s*True", text), module
        for node in ast.walk(ast.parse(text)):
            names = set()
            if isinstance(node, ast.Import):
                names = {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                names = {(node.module or "").split(".")[0]}
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                names = {node.func.id}
            if module.parts[-2:] == (
                "kernels",
                "options.py",
            ):  # numba's own format, read only after its digest
                names.discard("pickle")
            assert not names & banned, f"{module}: {names & banned}"


def has_its_own_name(module, name):
    """Whether a name is not one of those that several modules have to share."""
    inside = module.relative_to(SOURCE).parts
    if inside[:2] == ("surfaces", "readers"):
        return name != "read"  # each format is read by the `read` of its module
    return inside != ("cli", "__init__.py")  # commands are called as what they do


def test_public_names_are_unique():
    homes = {}
    for module in MODULES:
        for node in ast.parse(module.read_text(encoding="utf-8")).body:
            named = isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
            if named and has_its_own_name(module, node.name):
                homes.setdefault(node.name, []).append(str(module.relative_to(SOURCE)))
    assert {name: where for name, where in homes.items() if len(where) > 1} == {}
