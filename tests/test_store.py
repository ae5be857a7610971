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
from hypothesis.extra import numpy as hnp

from asperity.errors import ComputationError, InputError
from asperity.files import write_bytes
from asperity.store import Store, content_key, default_root, made


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "cache")


def test_a_result_comes_back_as_it_was_and_what_was_never_stored_is_missing(store):
    key = content_key("scan", np.arange(3.0), {"spacing": 1e-6})
    assert store.get(key) is None
    assert store.files() == Store(300 * "a").files() == []
    random = np.random.default_rng(0)
    arrays = {"force": random.normal(size=(30, 4)), "count": np.array(7), "law": np.array(["areal"])}
    store.put(key, arrays)
    found = store.get(key)
    assert found.keys() == arrays.keys()
    for name, value in arrays.items():
        np.testing.assert_array_equal(found[name], value, strict=True)
    assert store.size() == store.files()[0].stat().st_size > 960
    with pytest.raises(InputError, match="key of a stored result"):
        store.get("../elsewhere")


ARRAYS = hnp.arrays(np.float64, hnp.array_shapes(max_dims=2, max_side=4))


@given(ARRAYS, ARRAYS)
def test_keys_name_contents(first, second):
    same = first.shape == second.shape and first.tobytes() == second.tobytes()
    assert (content_key("a", first) == content_key("a", second)) is same


@pytest.mark.parametrize(("first", "second"), [
    (("a", 1, 2), ("a", [1, 2])),
    (("a", "1"), ("a", 1)),
    (("a", "b", "c"), ("a", "bc")),
    (("a", None), ("a",)),
    (("a", np.zeros(4)), ("a", np.zeros((2, 2)))),
    (("a", np.zeros(4)), ("a", np.zeros(8, dtype=np.float32))),
    (("a", {"b": 1}), ("a", ["b", 1])),
    (("a", 1), ("b", 1)),
])  # fmt: skip
def test_keys_tell_apart_what_differs(first, second):
    assert content_key(*first) != content_key(*second)


def test_keys_depend_on_no_layout_type_or_order():
    heights = np.arange(12.0).reshape(3, 4)
    assert content_key("a", heights) == content_key("a", np.asfortranarray(heights))
    assert content_key("a", np.float64(0.5)) == content_key("a", 0.5)
    assert content_key("a", {"b": 1, "c": True}) == content_key("a", {"c": True, "b": 1})


def test_objects_have_no_content_and_are_not_stored(store):
    for part in (np.array([object()]), object()):
        with pytest.raises(TypeError, match="object"):
            content_key("a", part)
    with pytest.raises(TypeError, match="objects"):
        store.put("a", {"bad": np.array([{}], dtype=object)})
    assert store.files() == []


class Payload:
    """Runs when it is unpickled."""

    def __reduce__(self):
        return (Path("pickled").mkdir, ())


def archive(**members):
    """An archive of files by name."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as opened:
        for name, contents in members.items():
            opened.writestr(f"{name}.npy", contents)
    return stream.getvalue()


def npy(values):
    np.save(stream := io.BytesIO(), values, allow_pickle=True)
    return stream.getvalue()


def bomb():
    """An archive whose entry claims to unpack to 4 GiB."""
    content = bytearray(archive(force=bytes(10**6)))
    at = content.index(b"PK\x01\x02") + 24
    content[at : at + 4] = struct.pack("<I", 0xFFFFFFF0)
    return bytes(content)


CLAIM = repr({"descr": "<f8", "fortran_order": False, "shape": (10**12,)}) + "\n"
HOSTILE = {  # what may lie where a result is expected, under a right seal
    "empty": b"",
    "text": b"not an archive",
    "10^12 points claimed": archive(
        force=b"\x93NUMPY\x01\x00" + struct.pack("<H", len(CLAIM)) + CLAIM.encode()
    ),
    "pickle inside": archive(force=npy(np.array([Payload()], dtype=object))),
    "bare pickle": pickle.dumps(Payload()),
    "another result": archive(__key__=npy(np.array("another key")), force=npy(np.zeros(1))),
    "bare array": npy(np.zeros(3)),
    "bomb": bomb(),
}


@pytest.mark.parametrize("contents", HOSTILE.values(), ids=HOSTILE)
def test_a_file_that_cannot_be_trusted_counts_as_missing(store, contents, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_bytes(store.path("k"), contents, sealed=True)
    assert store.get("k") is None
    assert not Path("pickled").exists()


def test_a_damaged_file_counts_as_missing_and_is_replaced(store):
    """Each of its bytes and lengths is a matter of the seal."""
    store.put("k", {"force": np.arange(6.0)})
    store.put("other", {"force": np.zeros(6)})
    whole = store.path("k").read_bytes()
    for contents in (whole[:100] + b"?" + whole[101:], whole[:-1], b"", store.path("other").read_bytes()):
        store.path("k").write_bytes(contents)
        assert store.get("k") is None
    store.put("k", {"force": np.arange(6.0)})
    np.testing.assert_array_equal(store.get("k")["force"], np.arange(6.0))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no such pipes")
def test_a_pipe_in_place_of_a_result_counts_as_missing(store):
    """To open it would wait for whoever writes into it."""
    store.root.mkdir()
    os.mkfifo(store.path("k"))
    assert store.get("k") is None


def test_results_that_no_disk_takes_are_held_in_memory_up_to_a_limit(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    store = Store(tmp_path / "file" / "cache")
    with pytest.warns(RuntimeWarning, match="finished work is not kept.*ASPERITY_CACHE"):
        store.put("scan-1", {"force": np.arange(3.0)})
    store.put("scan-2", {"force": np.arange(3.0)})  # warnings are errors here: no second one
    np.testing.assert_array_equal(store.get("scan-1")["force"], np.arange(3.0))
    monkeypatch.setattr("asperity.store.MOST_HELD", 100)
    with pytest.raises(ComputationError, match="memory already holds 100 bytes that are kept nowhere"):
        store.put("scan-3", {"force": np.zeros(100)})


@pytest.mark.parametrize(("platform", "variables", "expected"), [
    ("linux", {"ASPERITY_CACHE": "chosen"}, "chosen"),
    ("linux", {"XDG_CACHE_HOME": "xdg"}, "xdg/asperity"),
    ("linux", {"HOME": "home"}, "home/.cache/asperity"),
    ("darwin", {"HOME": "home"}, "home/Library/Caches/asperity"),
    ("win32", {"LOCALAPPDATA": "local"}, "local/asperity/cache"),
])  # fmt: skip
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
    seen = [store.get("k")]
    while any(writer.poll() is None for writer in writers):
        seen.append(store.get("k"))
    assert [writer.wait() for writer in writers] == [0, 0]
    assert {found["force"].sum() for found in [*seen, store.get("k")] if found is not None} == {499500.0}


def test_a_claim_is_held_by_one_ends_with_its_process_and_leaves_nothing(store):
    with store.claim("scan-1") as first, store.claim("scan-1") as second, store.claim("scan-2") as other:
        assert (first, second, other) == (True, False, True)
    code = "import os, sys; from asperity.store import Store; s = Store(sys.argv[1])\n"
    code += "with s.claim('scan-1') as free: print(free, flush=True); os._exit(1)"
    done = subprocess.run([sys.executable, "-c", code, store.root], capture_output=True, text=True)
    assert done.stdout.strip() == "True"
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
    assert made(store, "scan-2", lambda: {"force": np.zeros(1)})["force"] == 0.0
    np.testing.assert_array_equal(store.get("scan-2")["force"], np.zeros(1))
