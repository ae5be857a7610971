"""Kept kernels: verified before use, dropped with their version; no failure where they cannot be kept."""

import importlib.util
import os
import subprocess
import sys
import warnings

import pytest

from asperity import store
from asperity.kernels import options

MODULE = """
from asperity.kernels.options import LOOP, compiled

@compiled(**LOOP)
def twice(x):
    return 2.0 * x

@compiled(**LOOP)
def thrice(x):
    return 3.0 * x
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Where kernels are kept for this test."""
    monkeypatch.setenv(store.KERNELS, str(tmp_path / "kernels"))
    return tmp_path / "kernels"


@pytest.fixture
def module(tmp_path):
    path = tmp_path / "kept_kernel.py"
    path.write_text(MODULE)
    return path


def fresh(path):
    """Kernels of a module that is imported anew, called once; how often the first was found and compiled."""
    spec = importlib.util.spec_from_file_location("kept_kernel", path)
    imported = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(imported)
    assert imported.twice(2.0) == 4.0
    assert imported.thrice(2.0) == 6.0
    stats = imported.twice.stats
    return sum(stats.cache_hits.values()), sum(stats.cache_misses.values())


def files(folder):
    return sorted(path for path in folder.rglob("*") if path.is_file())


def test_a_kernel_is_compiled_once(folder, module):
    assert fresh(module) == (0, 1)
    assert fresh(module) == (1, 0)
    assert len(files(folder)) == 2
    assert store.is_private(folder)


CALLING = """
from asperity.kernels.options import CALLED, INNER, LOOP, compiled

@compiled(**INNER)
def inlined(x):
    return x + 1.0

@compiled(**CALLED)
def called(x):
    return 2.0 * inlined(x)

@compiled(**LOOP)
def calling(x):
    return called(x) + 1.0
"""


@pytest.fixture
def again(folder, tmp_path, monkeypatch):
    """Imports the kernels above as a new process does: nothing is compiled or loaded yet."""
    path = tmp_path / "calling_kernel.py"
    path.write_text(CALLING)

    def import_again():
        spec = importlib.util.spec_from_file_location("calling_kernel", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    return import_again


def test_a_kernel_that_kernels_call_can_be_called_from_python(folder, again):
    module = again()
    assert module.inlined(1.0) == 2.0
    assert module.calling(1.0) == 5.0
    assert (module.called(1.0), module.inlined(1.0)) == (4.0, 2.0)
    module = again()
    assert (module.called(2.0), module.inlined(2.0), module.calling(2.0)) == (6.0, 3.0, 7.0)
    assert len(files(folder)) == 3  # entries alone


def test_a_kept_kernel_is_dropped_when_a_source_changes(folder, module, monkeypatch):
    fresh(module)
    module.write_text(MODULE + "\n")
    assert fresh(module) == (0, 1)
    monkeypatch.setattr(options, "SOURCES", "another version")
    assert fresh(module) == (0, 1)


DAMAGE = {
    "empty": lambda content: b"",
    "shorter than a digest": lambda content: content[:20],
    "truncated": lambda content: content[: len(content) // 2],
    "without its last byte": lambda content: content[:-1],
    "zeroed": lambda content: bytes(len(content)),
    "zeroed behind the digest": lambda content: content[:32] + bytes(len(content) - 32),
    "longer": lambda content: content + b"\0",
    "a bit of the digest": lambda content: bytes([content[0] ^ 1]) + content[1:],
    "a bit of the code": lambda content: content[:5000] + bytes([content[5000] ^ 16]) + content[5001:],
    "the last bit": lambda content: content[:-1] + bytes([content[-1] ^ 128]),
    "another program's pickle": lambda content: b"cos\nsystem\n(S'exit 3'\ntR.",
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_damaged_kernels_are_compiled_again(folder, module, damage):
    fresh(module)
    whole = [path.read_bytes() for path in files(folder)]
    for path, content in zip(files(folder), whole, strict=True):
        path.write_bytes(DAMAGE[damage](content))
    assert fresh(module) == (0, 1)
    assert fresh(module) == (1, 0)
    assert len(files(folder)) == 2


def test_exchanged_kernels_are_compiled_again(folder, module):
    fresh(module)
    one, other = files(folder)
    keep = one.read_bytes()
    one.write_bytes(other.read_bytes())
    other.write_bytes(keep)
    assert fresh(module) == (0, 1)
    assert fresh(module) == (1, 0)


@pytest.mark.skipif(sys.platform == "win32", reason="folders have no such modes there")
def test_a_folder_that_others_can_write_to_is_not_trusted(folder, module, tmp_path, monkeypatch):
    monkeypatch.setattr(store.tempfile, "gettempdir", lambda: str(tmp_path / "temporary"))
    fresh(module)
    (inner,) = folder.iterdir()
    inner.chmod(0o777)
    assert fresh(module) == (0, 1)  # and now it is kept in the next folder
    assert fresh(module) == (1, 0)
    assert len(files(tmp_path / "temporary")) == 2


def test_where_the_cache_cannot_be_written_kernels_lie_in_a_temporary_folder(module, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv(store.KERNELS, str(tmp_path / "file" / "kernels"))
    monkeypatch.setattr(store.tempfile, "gettempdir", lambda: str(tmp_path / "temporary"))
    assert fresh(module) == (0, 1)
    assert fresh(module) == (1, 0)
    assert len(files(tmp_path / "temporary")) == 2


def test_where_nothing_can_be_written_kernels_are_compiled_with_one_warning(module, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv(store.KERNELS, str(tmp_path / "file" / "kernels"))

    def nowhere():
        raise FileNotFoundError("No usable temporary directory found")

    monkeypatch.setattr(store.tempfile, "gettempdir", nowhere)
    options._warn_unkept.cache_clear()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert fresh(module) == (0, 1)
        assert fresh(module) == (0, 1)
    assert len(caught) == 1
    message = str(caught[0].message)
    assert f"cannot be kept in {tmp_path / 'file' / 'kernels'}" in message
    assert "Let $ASPERITY_KERNELS name a folder" in message


def test_kernels_kept_by_another_are_read_where_nothing_can_be_written(folder, module, tmp_path, monkeypatch):
    """As in a container whose image brings them along."""
    fresh(module)
    monkeypatch.setattr(options, "_written", lambda *_: pytest.fail("nothing is to be written"))
    assert fresh(module) == (1, 0)


@pytest.mark.skipif(sys.platform == "win32", reason="homes are found in another way there")
def test_without_a_home_and_an_entry_of_the_user(tmp_path):
    """As a container with a bare number as user has it."""
    code = (
        "import pwd\n"
        "def unknown(number):\n"
        "    raise KeyError(number)\n"
        "pwd.getpwuid = unknown\n"
        "import numpy as np\n"
        "from asperity.kernels.overlap import foundation_approach\n"
        "from asperity.store import default_root\n"
        "print(foundation_approach(np.zeros((2, 2)), 1.0, 1.0, 1.0, 9.0) > 0.0, default_root())"
    )
    environment = {k: v for k, v in os.environ.items() if k not in ("HOME", "ASPERITY_CACHE", store.KERNELS)}
    command = [sys.executable, "-c", code]
    done = subprocess.run(
        command, env=environment | {"TMPDIR": str(tmp_path)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    private = tmp_path / f"asperity-{os.getuid()}"
    assert done.stdout.strip() == f"True {private}"
    assert files(private / "kernels")


WITHOUT = """
import sys, warnings
sys.path.insert(0, sys.argv[1])
from numba.core.compiler import CompileResult
del CompileResult._rebuild
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    import calling_kernel
assert (calling_kernel.calling(1.0), calling_kernel.inlined(1.0)) == (5.0, 2.0)
print(*[each.message for each in caught])
"""


def test_without_private_names_of_numba_plain_kernels_serve_and_that_is_told(folder, again, tmp_path):
    command = [sys.executable, "-c", WITHOUT, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "lacks what asperity needs to keep compiled functions" in done.stdout
    assert not files(folder)
