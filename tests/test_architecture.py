"""The house rules that a machine can check: layers, lazy imports, sizes, what the text may say."""

import ast
import re
import subprocess
import sys
from functools import cache
from importlib.util import resolve_name
from pathlib import Path

import pytest

import asperity
from asperity import laws
from asperity.case.cases import case_classes
from asperity.scenes.observers import OVER_STRUCTURES
from package_source import MODULES, SOURCE, nodes_of, parsed

ROOT = Path(__file__).parents[1]


def test_imports_point_one_way():
    done = subprocess.run(
        [sys.executable, "-c", "from importlinter.cli import lint_imports; raise SystemExit(lint_imports())"],
        cwd=ROOT, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout


TAKEN = re.compile(r"""\b(?:from|import)\s*\(?\s*["'](\.{1,2}/[^"']+)["']""")
"""What a script takes from another file, at its top or when it is needed."""


@cache
def file_of(name, root):
    """The file of a module by its name with dots, the first of which is that of the root; else None."""
    path = root.parent.joinpath(*name.split("."))
    return next((each for each in (path.with_suffix(".py"), path / "__init__.py") if each.is_file()), None)


def taken_by(path, root):
    """Files that a file imports: at its top, inside functions, or for its annotations alone."""
    if path.suffix == ".js":
        return {(path.parent / each).resolve() for each in TAKEN.findall(path.read_text(encoding="utf-8"))}
    package = ".".join(path.relative_to(root.parent).parent.parts)
    found = set()
    for node in nodes_of(path):
        if isinstance(node, ast.Import):
            found |= {file_of(each.name, root) for each in node.names}
        elif isinstance(node, ast.ImportFrom):
            of = resolve_name("." * node.level + (node.module or ""), package)
            found |= {file_of(f"{of}.{each.name}", root) or file_of(of, root) for each in node.names}
    return found - {None}


def circles_in(root):
    """Sets of files of which each leads to all the others by what it imports; of one that leads to itself."""
    takes = {path: taken_by(path, root) for path in (*root.rglob("*.py"), *root.rglob("*.js"))}
    leads = {}
    for path in takes:
        leads[path], ahead = set(), [path]
        while ahead:
            further = takes.get(ahead.pop(), set()) - leads[path]
            leads[path] |= further
            ahead += further
    inside = (frozenset(each for each in leads[path] if path in leads.get(each, ())) for path in takes)
    return [{each.relative_to(root).as_posix() for each in circle} for circle in {*inside} if circle]


def test_no_files_import_each_other_in_a_circle():
    found = circles_in(SOURCE)
    assert not found, "\n".join(" ".join(sorted(circle)) for circle in found)


@pytest.mark.parametrize(
    ("upper", "lower", "together"),
    [
        ("from house import b", "import house.a", {"a.py", "b.py"}),
        ("from house.b import B", "def f():\n    from house.a import A", {"a.py", "b.py"}),
        (
            "import house.b as b",
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from . import a",
            {"a.py", "b.py"},
        ),
        (
            "class A:\n    def f(self):\n        from .b import B",
            "from .c import C",
            {"a.py", "b.py", "c.py"},
        ),
    ],
)
def test_a_circle_of_files_is_found_wherever_its_imports_stand(tmp_path, upper, lower, together):
    house = tmp_path / "house"
    house.mkdir()
    for name, text in {"__init__": "", "a": upper, "b": lower, "c": "from house.a import A"}.items():
        (house / f"{name}.py").write_text(text, encoding="utf-8")
    (house / "d.js").write_text('import { f } from "./e.js";', encoding="utf-8")
    (house / "e.js").write_text('const late = () => import("./f.js");', encoding="utf-8")
    (house / "f.js").write_text('import "./d.js";', encoding="utf-8")
    assert sorted(circles_in(house), key=sorted) == [together, {"d.js", "e.js", "f.js"}]


LATE = [f"scipy.{name}" for name in ("optimize", "interpolate", "ndimage", "signal", "stats", "sparse")]
WAITING = {
    "from asperity.cli import main; main(['--help'], standalone_mode=False)": [
        "numpy", "numba", "scipy", "xarray", "matplotlib", "pydantic", "rich", "jinja2", "starlette",
        "uvicorn",
    ],
    "import asperity.laws, asperity.case.scene, asperity.case.beam": [
        "numba", "scipy.fft", "scipy.optimize", "xarray", "matplotlib",
    ],
    "import asperity.serving.worker": ["numba", "xarray", "matplotlib"],
    "import asperity.scenarios.preparing": LATE,  # what is written out, is loaded when first named
    "import asperity.scenes.report as r; r.names_of_reports()": ["matplotlib"],  # it draws for papers
    "import asperity.reporting.sound, asperity.running": ["scipy.signal", "scipy.stats"],
}  # fmt: skip
"""What waits for its use after each of these, one after the other in one process."""


def test_packages_wait_until_they_are_used():
    waits = "\nassert not {0!r} & sys.modules.keys(), {0!r} & sys.modules.keys()"
    of_linalg = "import sys, scipy.linalg; print(*sys.modules)"  # that of old releases loads all of sparse
    loaded = subprocess.run([sys.executable, "-c", of_linalg], capture_output=True, text=True).stdout.split()
    waiting = {does: {*names} - {*loaded} if names is LATE else {*names} for does, names in WAITING.items()}
    code = "\n".join(
        ["import sys", *(does + waits.format(names) for does, names in waiting.items() if names)]
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "Roll a body" in done.stdout


def test_public_names_are_listed():
    assert set(asperity.__all__) <= set(dir(asperity))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        asperity.nothing  # noqa: B018


def test_modules_and_functions_stay_readable():
    for module in MODULES:
        assert parsed(module)[0].count("\n") <= 600, module
        for node in nodes_of(module):
            if isinstance(node, ast.FunctionDef):
                doc = ast.get_docstring(node)
                length = node.end_lineno - node.lineno + 1 - (doc.count("\n") + 1 if doc else 0)
                assert length <= 70, f"{module}: {node.name} has {length} lines"


def test_nothing_is_pickled_and_no_text_is_evaluated():
    banned = {"pickle", "cPickle", "dill", "joblib", "shelve", "marshal", "eval", "exec"}
    for module in MODULES:
        assert not re.search(r"allow_pickle\s*=\s*True", parsed(module)[0]), module
        for node in nodes_of(module):
            names = set()
            if isinstance(node, ast.Import):
                names = {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                names = {(node.module or "").split(".")[0]}
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                names = {node.func.id}
            if module.name == "options.py":  # of kernels: numba's own format, read only after its digest
                names.discard("pickle")
            assert not names & banned, f"{module}: {names & banned}"


def test_hdf5_is_opened_at_one_place():
    """Where it is looked for data that lie in other files; elsewhere it is written, into an empty file."""
    (written,) = (node for node in MODULES if node.name == "netcdf.py")
    assert re.findall(r"h5py\.File\((.*?)\)", parsed(written)[0]) == ['file, "w", track_order=True']
    for module in set(MODULES) - {written}:
        for node in nodes_of(module):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            opens = {name.partition(".")[0] for name in names} & {"h5py", "h5netcdf", "netCDF4"}
            assert not opens or module.name == "hdf5.py", module


def test_a_result_names_none_of_its_observers():
    """A further one is its file and its name in one list."""
    homes = {each.observe.__module__ for each in OVER_STRUCTURES}
    for name in ("result.py", "over_frequency.py", "compute.py"):
        for node in nodes_of(SOURCE / "scenes" / name):
            if isinstance(node, ast.ImportFrom):
                named = {f"{node.module}.{each.name}" for each in node.names} | {node.module}
                assert not named & homes, f"{name}: {named & homes}"
    assert len(homes) > 3


KINDS = {
    "Case": ("case/", "observables/levels", "observables/stiffness"),
    "BearingUnderLoad": ("bearing", "studies/signals"),
    **dict.fromkeys(("PreparedCase", "Computed", "Optimised"), ()),
    **dict.fromkeys(("PreparedBearing", "ComputedBearing", "OptimisedBearing"), ()),
}
"""Classes by which kinds of case could be told apart, and words in the paths of the rooms of their kind."""


def test_nothing_beside_a_kind_asks_of_which_kind_a_case_is():
    """What differs stands in the class of the case, or is named there by module and function."""
    rooms = {each.__name__: ("case/",) for each in case_classes().values()} | KINDS
    asked = set()
    for module in MODULES:
        place = module.relative_to(SOURCE).as_posix()
        for node in nodes_of(module):
            called = node.func if isinstance(node, ast.Call) else None
            if isinstance(called, ast.Name) and called.id in ("isinstance", "issubclass"):
                words = {ast.unparse(each).rpartition(".")[2] for each in ast.walk(node.args[1])}
                found = words & set(rooms)
                beside = [name for name in found if not any(word in place for word in rooms[name])]
                assert not beside, f"{place}:{node.lineno}: {ast.unparse(node)}"
                asked |= found
    assert asked == {"Case", "BearingUnderLoad"}


def has_its_own_name(module, name):
    """Whether a name is not one of those that several modules have to share."""
    inside = module.relative_to(SOURCE).parts
    if inside[:2] == ("surfaces", "readers"):
        return name != "read"  # each format is read by the `read` of its module
    # commands are called as what they do
    return inside[0] != "cli" or inside[1] not in ("begin.py", "compute.py", "look.py")


def test_public_names_are_unique():
    """But for figures, which are called as their files."""
    homes = {}
    for module in MODULES:
        for node in parsed(module)[1].body:
            named = isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
            named = named and not any("figure(" in ast.unparse(each) for each in node.decorator_list)
            if named and has_its_own_name(module, node.name):
                homes.setdefault(node.name, []).append(str(module.relative_to(SOURCE)))
    assert {name: where for name, where in homes.items() if len(where) > 1} == {}


NO_LAWS = "linearise", "'secant'", "name == AREAL"
"""Words of a stiffness, which may be that of Hertz, and of a spectrum, which may be areal."""


def constants_of(node, known):
    """Constants that stand in an expression, and in what the names in it were made of in the module."""
    for part in ast.walk(node):
        if isinstance(part, ast.Constant):
            yield part.value
        elif isinstance(part, ast.Name) and part.id in known:
            yield from constants_of(known[part.id], {})


def test_nothing_but_the_laws_decides_by_their_names():
    """What the others of the package need to know of a law stands in its spec.

    Neither a comparison, nor a set that is met with another, nor a list of words that may be chosen from.
    """
    own = set(laws.names())
    for module in (module for module in MODULES if module.parent.name != "laws"):
        known = {
            each.id: node.value
            for node in parsed(module)[1].body if isinstance(node, ast.Assign)
            for each in node.targets if isinstance(each, ast.Name)
        }  # fmt: skip
        for node in nodes_of(module):
            called = isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2]
            decides = isinstance(node, ast.Compare) or called in ("Choice", "one_of")
            decides |= isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitAnd)
            if decides and not any(word in ast.unparse(node) for word in NO_LAWS):
                assert not own & set(constants_of(node, known)), f"{module}:{node.lineno}"
