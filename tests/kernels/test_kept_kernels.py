"""Kept kernels: verified before use, dropped with their version; no failure where they cannot be kept."""

import gc
import importlib.util
import operator
import os
import re
import shutil
import subprocess
import sys
import warnings
from collections import defaultdict
from pathlib import Path

import numba
import pytest
from numba.core import event
from numba.core.types.functions import BaseFunction

from asperity import store
from asperity.kernels import options

MODULE = """
from numba.extending import overload
from asperity.kernels.options import CALLED, INNER, LOOP, ONCE, compiled

def of_numba(x):
    return x + 1.0

@overload(of_numba)
def as_numba_has_it(x):
    return lambda x: x + 1.0

@compiled(**ONCE)
def in_one_place(x):
    return x + 0.5

@compiled(**INNER)
def inlined(x):
    return of_numba(x)

@compiled(**CALLED)
def called(x):
    return 2.0 * inlined(x)

@compiled(**LOOP)
def calling(x):
    return in_one_place(called(x)) + 0.5

@compiled(**LOOP)
def thrice(x):
    return 3.0 * x

@compiled(**LOOP)
def six_times(x):
    return 2.0 * thrice(x)
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Where kernels are kept for this test; other folders lie beside it."""
    monkeypatch.setenv(store.KERNELS, str(tmp_path / "kernels"))
    monkeypatch.setattr(store.tempfile, "gettempdir", lambda: str(tmp_path / "temporary"))
    return tmp_path / "kernels"


@pytest.fixture
def module(tmp_path):
    path = tmp_path / "kept_kernel.py"
    path.write_text(MODULE)
    return path


def fresh(path):
    """Kernels of a module that is imported anew, called once; how often one was found and compiled."""
    spec = importlib.util.spec_from_file_location("kept_kernel", path)
    imported = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(imported)
    assert imported.calling(1.0) == 5.0
    assert imported.thrice(2.0) == 6.0
    stats = imported.calling.stats
    return imported, sum(stats.cache_hits.values()), sum(stats.cache_misses.values())


def files(folder):
    return sorted(path for path in folder.rglob("*") if path.is_file())


def test_a_kernel_is_compiled_once_until_a_source_changes(folder, module, monkeypatch):
    for hits, misses in ((0, 1), (1, 0)):
        kernels, *found = fresh(module)
        assert found == [hits, misses]
        assert len(files(folder)) == 2  # entries alone
    assert (kernels.called(1.0), kernels.inlined(1.0)) == (4.0, 2.0)  # those that kernels call, from Python
    assert store.is_private(folder)
    module.write_text(MODULE + "\n")
    assert fresh(module)[1:] == (0, 1)
    monkeypatch.setattr(options, "SOURCES", "another version")
    assert fresh(module)[1:] == (0, 1)


NAMES = """
from importlib import reload
from pathlib import Path
from asperity.kernels import options
print(options.SOURCES, options.__file__)
for part in ("lowering.py", "rim_curves.toml"):
    changed = Path(options.__file__).with_name(part)
    changed.write_text(changed.read_text() + "\\n")
    print(reload(options).SOURCES)
"""


def test_kernels_are_named_by_how_they_are_lowered_and_by_data_beside_them_as_well(tmp_path):
    package = Path(options.__file__).parents[1]
    copy = shutil.copytree(package, tmp_path / package.name, ignore=shutil.ignore_patterns("__pycache__"))
    first, *others = apart(NAMES, copy, **os.environ | {"PYTHONPATH": str(tmp_path)}).splitlines()
    assert first == f"{options.SOURCES} {copy / 'kernels' / 'options.py'}"
    assert len({options.SOURCES, *others}) == 3


DAMAGE = {
    "a bit of the code": lambda *contents: [c[:5000] + bytes([c[5000] ^ 16]) + c[5001:] for c in contents],
    "another program's pickle": lambda *contents: [b"cos\nsystem\n(S'exit 3'\ntR." for _ in contents],
    "exchanged": lambda first, second: (second, first),
}


def test_what_is_compiled_where_it_is_called_is_kept_where_python_calls_it(folder, module):
    for times in (0, 1):
        imported, *_ = fresh(module)
        assert imported.in_one_place(1.0) == 1.5
        assert sum(imported.in_one_place._entered.stats.cache_hits.values()) == times


@pytest.mark.parametrize("damage", DAMAGE)
def test_damaged_kernels_are_compiled_again(folder, module, damage):
    fresh(module)
    kept = files(folder)
    for path, content in zip(kept, DAMAGE[damage](*(path.read_bytes() for path in kept)), strict=True):
        path.write_bytes(content)
    assert fresh(module)[1:] == (0, 1)
    assert fresh(module)[1:] == (1, 0)
    assert files(folder) == kept


@pytest.mark.skipif(sys.platform == "win32", reason="folders have no such modes there")
def test_a_folder_that_others_can_write_to_is_not_trusted(folder, module, tmp_path):
    fresh(module)
    next(folder.iterdir()).chmod(0o777)
    assert fresh(module)[1:] == (0, 1)  # and now it is kept in the next folder
    assert fresh(module)[1:] == (1, 0)
    assert len(files(tmp_path / "temporary")) == 2


def test_where_nothing_can_be_written_kernels_are_compiled_with_one_warning(folder, module, monkeypatch):
    """Else they lie among temporary files."""
    folder.write_text("no folder")
    assert [fresh(module)[1:] for _ in range(2)] == [(0, 1), (1, 0)]

    def nowhere():
        raise FileNotFoundError("No usable temporary directory found")

    monkeypatch.setattr(store.tempfile, "gettempdir", nowhere)
    options._warn_unkept.cache_clear()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert [fresh(module)[1:] for _ in range(2)] == [(0, 1), (0, 1)]
    assert len(caught) == 1
    assert f"cannot be kept in {folder}" in str(caught[0].message)
    assert "Let $ASPERITY_KERNELS name a folder" in str(caught[0].message)


def test_kernels_kept_by_another_are_read_where_nothing_can_be_written(folder, module, monkeypatch):
    """As in a container whose image brings them along."""
    fresh(module)
    monkeypatch.setattr(options, "_written", lambda *_: pytest.fail("nothing is to be written"))
    assert fresh(module)[1:] == (1, 0)


NO_HOME = """
import pwd, sys

def unknown(number):
    raise KeyError(number)

pwd.getpwuid = unknown
sys.path.insert(0, sys.argv[1])
import kept_kernel
from asperity.store import default_root
print(kept_kernel.calling(1.0), default_root())
"""
LOADED = """
import sys
sys.path.insert(0, sys.argv[1])
import kept_kernel
print(kept_kernel.thrice(2.0))
"""
LOADED_WITHIN = LOADED.replace("print(", "print(kept_kernel.six_times(1.0), ")
PLAIN = """
import sys, warnings
sys.path.insert(0, sys.argv[1])
from numba.core.compiler import CompileResult
del CompileResult._rebuild
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    import kept_kernel
assert kept_kernel.inlined(1.0) == 2.0
print(kept_kernel.calling(1.0), *[each.message for each in caught])
"""


def apart(script, module, **environment):
    """What a script prints in a process of its own."""
    command = [sys.executable, "-c", script, str(module.parent)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.skipif(sys.platform == "win32", reason="homes are found in another way there")
def test_without_a_home_and_an_entry_of_the_user(module, tmp_path):
    """As a container with a bare number as user has it."""
    unset = ("HOME", "XDG_CACHE_HOME", "ASPERITY_CACHE", store.KERNELS)
    environment = {k: v for k, v in os.environ.items() if k not in unset}
    private = tmp_path / f"asperity-{os.getuid()}"
    assert apart(NO_HOME, module, **environment | {"TMPDIR": str(tmp_path)}) == f"5.0 {private}"
    assert files(private / "kernels")


def test_a_kernel_that_is_loaded_while_another_is_compiled_serves_python_too(folder, module):
    assert apart(LOADED, module, **os.environ) == "6.0"
    assert apart(LOADED_WITHIN, module, **os.environ) == "6.0 6.0"


def test_without_private_names_of_numba_plain_kernels_serve_and_that_is_told(folder, module):
    told = apart(PLAIN, module, **os.environ)
    assert told.startswith("5.0 numba")
    assert "lacks what asperity needs to keep compiled functions" in told
    assert not files(folder)


LACKING = """
import importlib, sys, warnings
for module, name in {names}:
    owner = importlib.import_module(module)
    *path, last = name.split(".")
    for part in path:
        owner = getattr(owner, part)
    held = vars(owner)[last]
    delattr(owner, last)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        options = importlib.import_module("asperity.kernels.options")
    print(options.PLAIN, *[each.message for each in caught])
    setattr(owner, last, held)
    for each in [each for each in sys.modules if each.startswith("asperity")]:
        del sys.modules[each]
"""
LACKED = [
    ("numba.core.types.functions", "BaseFunction.get_call_type"),
    ("numba.core.lowering", "Lower.lower_getitem"),
    ("numba.core.analysis", "must_use_alloca"),
    ("llvmlite.ir.instructions", "InsertValue"),
]


def test_where_numba_lacks_a_name_that_is_needed_kernels_are_plain(module):
    told = apart(LACKING.format(names=LACKED), module, **os.environ).splitlines()
    assert len(told) == len(LACKED)
    assert all(re.match("True numba.*lacks what asperity needs", each) for each in told)


def test_what_only_kernels_call_is_optimised_and_machine_code_inside_of_them_alone(
    folder, module, monkeypatch
):
    optimised, optimise = [], options.JITCodeLibrary._optimize_final_module
    step = lambda library: (optimised.append(library.name), optimise(library))  # noqa: E731
    monkeypatch.setattr(options.JITCodeLibrary, "_optimize_final_module", step)
    kernels, *_ = fresh(module)
    assert [name for name in optimised if name != "nrt"] == ["calling", "thrice"]
    for part in (kernels.inlined, kernels.called):
        (each,) = part.overloads.values()
        engine = kernels.calling.overloads[each.signature.args].library.codegen._engine
        assert each.library._finalized  # else its parts would be linked at every use
        assert not engine.is_symbol_defined(each.fndesc.mangled_name)
    assert numba.njit(lambda x: x + 1.0)(1.0) == 2.0  # numba is as it was


class Looking(event.Listener):
    """Whether Python looks for garbage at each step of a compilation."""

    def __init__(self):
        self.seen = []

    def on_start(self, event):
        self.seen.append(gc.isenabled())

    def on_end(self, event):
        pass


@pytest.mark.parametrize("looking", [True, False])
def test_python_looks_for_no_garbage_while_it_compiles_and_then_as_before(folder, module, looking):
    (gc.enable if looking else gc.disable)()
    try:
        with event.install_listener("numba:run_pass", Looking()) as listener:
            fresh(module)
        assert listener.seen
        assert not any(listener.seen)
        assert gc.isenabled() == looking
        with pytest.raises(numba.TypingError):
            options.compiled(**options.LOOP)(lambda x: x.nothing)(1.0)
        assert gc.isenabled() == looking
    finally:
        gc.enable()


class Passes(Looking):
    """Which passes run over each function."""

    def __init__(self):
        self.seen = defaultdict(list)

    def on_start(self, event):
        self.seen[event.data["qualname"]].append(event.data["name"])


def test_an_operator_on_numbers_is_typed_once_and_needless_passes_are_left_out(folder, module, monkeypatch):
    """And numba is as it was, for what others compile."""
    before = BaseFunction.get_call_type
    asked, find = [], options.FIND_TYPE
    count = lambda *given: (asked.append((given[0].typing_key, given[2])), find(*given))[1]  # noqa: E731
    monkeypatch.setattr(options, "FIND_TYPE", count)
    monkeypatch.setattr(options, "_typed", {})
    with event.install_listener("numba:run_pass", Passes()) as listener:
        fresh(module)
        with pytest.raises(numba.TypingError):
            options.compiled(**options.LOOP)(lambda x: x.nothing)(1.0)
    on_numbers = [each for each in asked if each[0] in options.OPERATORS]
    assert any(each[0] is operator.add for each in on_numbers)
    assert len(on_numbers) == len(set(on_numbers))
    twice = options.compiled(**options.LOOP)(lambda x, n: (x + x, n + n))
    assert [type(each) for each in twice(1.5, 2)] == [float, int]
    of_numba = listener.seen["as_numba_has_it.<locals>.<lambda>"]
    assert len(of_numba) - len(listener.seen["inlined"]) == len(options.NEEDLESS)
    assert BaseFunction.get_call_type is before
