"""No code outside a kind's own folder names a kind, or tests for one."""

import ast
import re
from pathlib import Path

import asperity
from asperity.kinds import KINDS

SOURCE = Path(asperity.__file__).parent
FOLDERS = [SOURCE.joinpath(*kind.folder.split(".")[1:]) for kind in KINDS.values()]
FOLDERS.append(SOURCE / "scenes" / "figures")  # which draw what a case says
OUTSIDE = [path for path in sorted(SOURCE.rglob("*.py")) if not any(f in path.parents for f in FOLDERS)]
CASES = [kind.case for kind in KINDS.values()]
SHARED = set.intersection(*(set(case.model_fields) for case in CASES))
SECTIONS = sorted(
    set().union(*(case.model_fields for case in CASES)) - SHARED - {"noise"}
)  # beam, wheel, …; whatever rolls over a track sounds
FILES = {"beam.x3p"}  # of examples: no key


def lines_that(wrong):
    """Lines outside the folders that are wrong, as FILE:LINE: TEXT."""
    found = []
    for path in OUTSIDE:
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            if wrong(path, line):
                found.append(f"{path.relative_to(SOURCE)}:{number}: {line.strip()}")
    return found


def test_the_folders_are_where_the_registry_says():
    assert all((folder / "case.py").is_file() for folder in FOLDERS[:-1])
    assert {"ball", "beam", "wheel", "track"} <= set(SECTIONS)
    assert "contact" not in SECTIONS


def test_no_kind_is_named():
    """Neither as in case files, nor by class or folder; but one line each in the registry and in the door.

    Of a kind whose name is a common word, the name in quotes alone, its folder, and its class as imported.
    """
    own = [name for name in KINDS if "-" in name]
    spelled = {name.replace("-", mark) for name in own for mark in "- _"}
    spelled |= {KINDS[name].case.__name__ for name in own}
    for name in KINDS.keys() - set(own):
        folder = re.escape(KINDS[name].folder)
        spelled |= {
            f"""kind ?[=!]= ?["']{name}["']""",
            f"{folder}(?!\\w)",
            f"import {KINDS[name].case.__name__}",
        }
    words = re.compile("|".join(spelled), re.I)
    lines = {f'    "{name}": Kind("{kind.folder}"),' for name, kind in KINDS.items()}
    for case in CASES:  # public names, each with the room it lives in
        name, room = case.__name__, case.__module__.removeprefix("asperity.")
        lines |= {f'    "{name}": "{room}",', f'    "{name}",'}
    assert not lines_that(lambda path, line: words.search(line) and line not in lines)


def test_no_section_or_key_of_one_kind_is_looked_at():
    """Neither ``case.beam`` nor ``getattr(case, "beam")`` nor ``"beam.length"``."""
    any_of = "|".join(SECTIONS)
    looks = re.compile(
        rf"\bcase\.({any_of})\b|[gs]etattr\([^)]*[\"']({any_of})[\"']|[\"'`]({any_of})\.[a-z_]\w+"
    )

    def wrong(path, line):
        found = looks.search(line)
        return found and not any(name in line for name in FILES)

    assert not lines_that(wrong)


def test_no_code_asks_whether_a_case_is_of_a_kind():
    classes = {case.__name__ for case in CASES} | {"Kind"}
    for path in OUTSIDE:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("isinstance", "issubclass"):
                asked = {getattr(name, "id", "") for name in ast.walk(node.args[1])}
                kinds = asked & classes - ({"Kind"} if path.name == "keys.py" else set())  # a kind of value
                assert not kinds, f"{path}:{node.lineno}"
            if isinstance(node, ast.Compare):
                texts = {c.value for c in ast.walk(node) if isinstance(c, ast.Constant)}
                assert not texts & set(KINDS), f"{path}:{node.lineno}"
