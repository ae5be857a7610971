"""The cache: names by content, atomic writing, and files that cannot be trusted."""

import io
import os
import pickle
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from asperity.errors import ComputationError, InputError
from asperity.files import atomic_write
from asperity.store import Store, content_key, default_root, made


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "cache")


def test_a_result_comes_back_as_it_was(store):
    key = content_key("scan", np.arange(3.0), {"spacing": 1e-6})
    arrays = {
        "force": np.random.default_rng(0).normal(size=(3, 4)),
        "count": np.array(7),
        "law": np.array(["areal"]),
    }
    store.put(key, arrays)
    found = store.get(key)
    assert found is not None
    assert found.keys() == arrays.keys()
    for name, value in arrays.items():
        np.testing.assert_array_equal(found[name], value)
        assert found[name].dtype == value.dtype


def test_what_was_never_stored_is_missing(store):
    assert store.get(content_key("scan", 1)) is None
    assert store.files() == []
    assert store.size() == 0
    assert store.clear() == 0


def test_size_and_clear(store):
    for part in range(3):
        store.put(content_key("scan", part), {"force": np.zeros(100)})
    (store.root / ".scan-1.npz.0a0b0c0d.part").write_bytes(b"interrupted")
    (store.root / "notes.txt").write_text("not ours")
    assert store.size() == sum(path.stat().st_size for path in store.files()) > 3 * 800
    assert store.clear() == 3
    assert [path.name for path in store.root.iterdir()] == ["notes.txt"]


@given(
    hnp.arrays(np.float64, hnp.array_shapes(max_dims=2, max_side=4)),
    hnp.arrays(np.float64, hnp.array_shapes(max_dims=2, max_side=4)),
)
def test_keys_name_contents(first, second):
    same = first.shape == second.shape and first.tobytes() == second.tobytes()
    assert (content_key("a", first) == content_key("a", second)) is same


@given(st.dictionaries(st.text(max_size=3), st.floats(allow_nan=False) | st.text(max_size=3) | st.booleans()))
def test_the_order_of_a_dictionary_does_not_matter(parts):
    assert content_key("a", parts) == content_key("a", dict(reversed(parts.items())))


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (("a", 1, 2), ("a", [1, 2])),
        (("a", "1"), ("a", 1)),
        (("a", "b", "c"), ("a", "bc")),
        (("a", None), ("a",)),
        (("a", np.zeros(4)), ("a", np.zeros((2, 2)))),
        (("a", np.zeros(4)), ("a", np.zeros(8, dtype=np.float32))),
        (("a", {"b": 1}), ("a", ["b", 1])),
        (("a", 1), ("b", 1)),
    ],
)
def test_keys_tell_apart_what_differs(first, second):
    assert content_key(*first) != content_key(*second)


def test_a_key_does_not_depend_on_memory_layout():
    heights = np.arange(12.0).reshape(3, 4)
    assert content_key("a", heights) == content_key("a", np.asfortranarray(heights))
    assert content_key("a", np.float64(0.5)) == content_key("a", 0.5)


def test_objects_have_no_content():
    with pytest.raises(TypeError, match="objects"):
        content_key("a", np.array([object()]))
    with pytest.raises(TypeError):
        content_key("a", object())


def test_arrays_of_objects_are_not_stored(store):
    with pytest.raises(TypeError, match="objects"):
        store.put("a", {"bad": np.array([{}], dtype=object)})
    assert store.files() == []


class Payload:
    """Runs when it is unpickled."""

    def __reduce__(self):
        return (Path("pickled").mkdir, ())


def hostile_files(key):
    """Files that may lie where a result is expected."""
    whole = io.BytesIO()
    np.savez(whole, __key__=np.array(key), force=np.arange(1000.0))
    content = whole.getvalue()
    flipped = bytearray(content)
    flipped[len(content) // 2] ^= 0xFF
    claimed = io.BytesIO()
    with zipfile.ZipFile(claimed, "w") as archive:
        header = repr({"descr": "<f8", "fortran_order": False, "shape": (10**12,)}) + "\n"
        archive.writestr("force.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode())
    pickled = io.BytesIO()
    with zipfile.ZipFile(pickled, "w") as archive:
        inner = io.BytesIO()
        np.save(inner, np.array([Payload()], dtype=object), allow_pickle=True)
        archive.writestr("force.npy", inner.getvalue())
    other = io.BytesIO()
    np.savez(other, __key__=np.array("another key"), force=np.zeros(1))
    plain = io.BytesIO()
    np.save(plain, np.zeros(3))
    return {
        "empty": b"",
        "text": b"not an archive",
        "truncated": content[: len(content) // 2],
        "flipped bit": bytes(flipped),
        "10^12 points claimed": claimed.getvalue(),
        "pickle inside": pickled.getvalue(),
        "bare pickle": pickle.dumps(Payload()),
        "another result": other.getvalue(),
        "bare array": plain.getvalue(),
    }


@pytest.mark.parametrize("kind", hostile_files("k"))
def test_a_file_that_cannot_be_trusted_counts_as_missing(store, kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    store.put("k", {"force": np.zeros(1)})
    store.path("k").write_bytes(hostile_files("k")[kind])
    assert store.get("k") is None
    assert not Path("pickled").exists()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no such pipes")
def test_a_pipe_in_place_of_a_result_counts_as_missing(store):
    """To open it would wait for whoever writes into it."""
    store.root.mkdir()
    os.mkfifo(store.path("k"))
    assert store.get("k") is None


def test_a_zip_bomb_counts_as_missing(store):
    store.root.mkdir()
    with zipfile.ZipFile(store.path("k"), "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("force.npy", bytes(10**6))
    content = bytearray(store.path("k").read_bytes())
    directory = content.index(b"PK\x01\x02")
    content[directory + 24 : directory + 28] = struct.pack(
        "<I", 0xFFFFFFF0
    )  # size the entry claims to unpack to
    store.path("k").write_bytes(content)
    assert store.get("k") is None


def test_a_key_cannot_leave_the_folder(store):
    with pytest.raises(InputError, match="key of a stored result"):
        store.get("../elsewhere")


def test_writing_is_all_or_nothing(tmp_path):
    target = tmp_path / "deep" / "file.txt"
    assert atomic_write(target, lambda file: file.write(b"first")) == target

    def fails(file):
        file.write(b"half")
        raise RuntimeError("stopped")

    with pytest.raises(RuntimeError, match="stopped"):
        atomic_write(target, fails)
    assert target.read_bytes() == b"first"
    assert [path.name for path in target.parent.iterdir()] == ["file.txt"]


def test_a_folder_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(ComputationError, match="could not be written"):
        atomic_write(tmp_path / "file" / "run.nc", lambda file: None)


@pytest.mark.parametrize(
    ("platform", "variables", "expected"),
    [
        ("linux", {"ASPERITY_CACHE": "chosen"}, "chosen"),
        ("linux", {"XDG_CACHE_HOME": "xdg"}, "xdg/asperity"),
        ("linux", {"HOME": "home"}, "home/.cache/asperity"),
        ("darwin", {"HOME": "home"}, "home/Library/Caches/asperity"),
        ("win32", {"LOCALAPPDATA": "local"}, "local/asperity/cache"),
    ],
)
def test_the_cache_lies_where_the_system_keeps_caches(monkeypatch, platform, variables, expected):
    for name in ("ASPERITY_CACHE", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "platform", platform)
    assert default_root().as_posix() == expected


def test_many_processes_may_write_the_same_result(store):
    script = (
        "import sys, numpy as np; from asperity.store import Store\n"
        "for _ in range(20): Store(sys.argv[1]).put('k', {'force': np.arange(1000.0)})"
    )
    writers = [subprocess.Popen([sys.executable, "-c", script, str(store.root)]) for _ in range(2)]
    seen = [store.get("k") for _ in range(200)]
    assert all(writer.wait(60) == 0 for writer in writers)
    seen.append(store.get("k"))
    for found in seen:
        assert found is None or found["force"].sum() == 499500.0
    assert seen[-1] is not None


def test_a_claim_is_held_by_one_and_leaves_nothing(store, tmp_path):
    with store.claim("scan-1") as first, store.claim("scan-1") as second, store.claim("scan-2") as other:
        assert (first, second, other) == (True, False, True)
    with store.claim("scan-1") as again:
        assert again
    assert list(store.root.iterdir()) == []


def test_what_another_makes_is_waited_for(store):
    waited = []

    def meanwhile():
        waited.append(True)
        store.put("scan-1", {"force": np.ones(2)})

    with store.claim("scan-1"):
        found = made(store, "scan-1", lambda: pytest.fail("it is being made"), meanwhile)
    np.testing.assert_array_equal(found["force"], np.ones(2))
    assert waited == [True]


def test_a_claim_ends_with_its_process(store):
    code = "import os, sys; from asperity.store import Store; s = Store(sys.argv[1])\n"
    code += "with s.claim('scan-1') as free: print(free, flush=True); os._exit(1)"
    done = subprocess.run([sys.executable, "-c", code, store.root], capture_output=True, text=True)
    assert done.stdout.strip() == "True"
    with store.claim("scan-1") as free:
        assert free
    found = made(store, "scan-1", lambda: {"force": np.ones(2)})
    np.testing.assert_array_equal(found["force"], np.ones(2))
