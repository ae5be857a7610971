"""Files that are written completely or not at all, sealed, and swept."""

import errno
import subprocess
import sys
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest

from asperity import files
from asperity.errors import ComputationError, InputError
from asperity.files import (
    alone_in,
    atomic_write,
    discard,
    is_sealed,
    left_overs,
    remove_left_overs,
    write_bytes,
)
from asperity.store import Store, content_key

if sys.platform != "win32":
    import fcntl

posix = pytest.mark.skipif(sys.platform == "win32", reason="open files cannot be removed there")


def flipped(contents, place, bit=0):
    damaged = bytearray(contents)
    damaged[place] ^= 1 << bit
    return bytes(damaged)


def test_a_seal_shows_every_flipped_byte_and_every_length(tmp_path):
    path = write_bytes(tmp_path / "a", b"contents that matter", sealed=True)
    with open(path, "rb") as file:
        assert is_sealed(file) is True
        assert file.tell() == 0
    whole = path.read_bytes()
    for place in range(len(whole)):
        path.write_bytes(flipped(whole, place, place % 8))
        with open(path, "rb") as file:
            assert not is_sealed(file)
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        with open(path, "rb") as file:
            assert not is_sealed(file)


def test_archives_and_hdf5_files_are_read_behind_their_seal(tmp_path):
    """Their readers pass over what follows their end."""
    archive = atomic_write(tmp_path / "a.npz", lambda file: np.savez(file, x=np.arange(3)), sealed=True)
    with zipfile.ZipFile(archive) as opened:
        assert opened.testzip() is None
    np.testing.assert_array_equal(np.load(archive)["x"], np.arange(3))

    def write(file):
        with h5py.File(file, "w") as opened:
            opened["x"] = np.arange(3)

    with h5py.File(atomic_write(tmp_path / "a.h5", write, sealed=True)) as opened:
        np.testing.assert_array_equal(opened["x"], np.arange(3))


@pytest.mark.parametrize("damage", ["each byte", "empty", "truncated", "zeroed", "exchanged"])
def test_a_damaged_block_counts_as_missing_and_is_replaced(tmp_path, damage):
    store, key, other = Store(tmp_path), content_key("scan", 1), content_key("scan", 2)
    store.put(key, {"forces": np.arange(6.0), "counts": np.arange(4)})
    store.put(other, {"forces": np.zeros(6), "counts": np.arange(4)})
    path, whole = store.path(key), store.path(key).read_bytes()
    versions = {
        "each byte": [flipped(whole, place, place % 8) for place in range(len(whole))],
        "empty": [b""],
        "truncated": [whole[:length] for length in range(0, len(whole), 97)],
        "zeroed": [bytes(len(whole))],
        "exchanged": [store.path(other).read_bytes()],
    }[damage]
    for contents in versions:
        path.write_bytes(contents)
        assert store.get(key) is None
    store.put(key, {"forces": np.arange(6.0)})
    np.testing.assert_array_equal(store.get(key)["forces"], np.arange(6.0))


def test_left_overs_are_swept_at_the_first_write_into_a_folder(tmp_path):
    (tmp_path / ".run.nc.0123abcd.part").write_bytes(b"killed")
    (tmp_path / ".run.nc.part").write_bytes(b"not ours")
    write_bytes(tmp_path / "run.nc", b"new")
    assert sorted(path.name for path in tmp_path.iterdir()) == [".run.nc.part", "run.nc"]


@posix
def test_a_part_that_is_being_written_is_no_left_over(tmp_path):
    found = []

    def write(file):
        found.append(left_overs(tmp_path))
        assert remove_left_overs(tmp_path) == 0
        file.write(b"whole")

    path = atomic_write(tmp_path / "run.nc", write)
    assert found == [[]]
    assert path.read_bytes() == b"whole"


@posix
@pytest.mark.parametrize("remove", [remove_left_overs, lambda folder: sum(map(discard, left_overs(folder)))])
def test_a_left_over_goes_while_it_is_locked(tmp_path, monkeypatch, remove):
    """Else a writer that has made it, and is about to lock it, would write into a file without a name."""
    unlink = Path.unlink

    def locked_unlink(path, **options):
        with open(path, "rb") as file, pytest.raises(BlockingIOError):
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        unlink(path, **options)

    (tmp_path / ".run.nc.0123abcd.part").write_bytes(b"killed")
    monkeypatch.setattr(Path, "unlink", locked_unlink)
    assert remove(tmp_path) == 1
    assert not list(tmp_path.iterdir())


@posix
def test_a_part_of_another_process_is_left_alone(tmp_path):
    code = (
        "import sys\n"
        "from asperity.files import atomic_write\n"
        "def write(file):\n"
        "    print('writing', flush=True)\n"
        "    sys.stdin.readline()\n"
        "    file.write(b'whole')\n"
        f"atomic_write({str(tmp_path / 'run.nc')!r}, write)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        assert other.stdout.readline() == "writing\n"
        assert Store(tmp_path).clear() == 0
        assert len(list(tmp_path.iterdir())) == 1
        other.stdin.write("\n")
        other.stdin.close()
        assert other.wait() == 0
    assert (tmp_path / "run.nc").read_bytes() == b"whole"


@posix
def test_a_run_is_alone_in_its_folder(tmp_path):
    folder = tmp_path / "runs" / "case"
    with alone_in(folder):
        with pytest.raises(InputError, match="another run is writing"), alone_in(folder):
            pytest.fail("two runs in one folder")
        write_bytes(folder / "run.nc", b"done")
    with alone_in(folder):
        assert [path.name for path in folder.iterdir()] == ["run.nc"]


def test_a_run_that_fails_leaves_no_folder(tmp_path):
    with pytest.raises(ZeroDivisionError), alone_in(tmp_path / "new"):
        raise ZeroDivisionError
    assert not (tmp_path / "new").exists()


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ComputationError, match="could not be written"), alone_in(tmp_path / "file" / "new"):
        pytest.fail("it is a file")


def test_what_the_disk_cannot_hold_is_refused_before_it_is_written(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "free_space", lambda path: 3 * 2**20)
    with pytest.raises(ComputationError) as caught:
        write_bytes(tmp_path / "run.nc", bytes(4 * 2**20))
    assert "the disk is full (4 MiB are needed, 3 MiB are free)" in str(caught.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("code", "message"),
    [
        (errno.ENOSPC, r"the disk is full \(.* are free\)"),
        (errno.EFBIG, "files may not grow as large here"),
        (errno.EIO, r"\(Input/output error\)"),
    ],
)
def test_a_disk_that_is_full_half_way(tmp_path, code, message):
    (tmp_path / "run.nc").write_bytes(b"old")

    def write(file):
        file.write(b"half")
        raise OSError(code, "Input/output error")

    with pytest.raises(ComputationError, match=message) as caught:
        atomic_write(tmp_path / "run.nc", write)
    assert caught.value.exit_code == 3
    assert (tmp_path / "run.nc").read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]


def test_results_that_no_disk_takes_are_held_in_memory(tmp_path):
    (tmp_path / "file").write_text("")
    store, key = Store(tmp_path / "file" / "cache"), content_key("scan", 1)
    with pytest.warns(RuntimeWarning, match="finished work is not kept.*ASPERITY_CACHE"):
        store.put(key, {"forces": np.arange(3.0)})
    store.put(content_key("scan", 2), {"forces": np.arange(3.0)})  # warnings are errors here: no second one
    np.testing.assert_array_equal(store.get(key)["forces"], np.arange(3.0))


def test_memory_holds_only_so_much(tmp_path, monkeypatch):
    monkeypatch.setattr("asperity.store.MOST_HELD", 100)
    (tmp_path / "file").write_text("")
    store = Store(tmp_path / "file")
    with pytest.raises(ComputationError, match="memory already holds 100 bytes that are kept nowhere"):
        store.put("scan-1", {"forces": np.zeros(100)})


def test_results_are_on_the_disk_at_once_and_no_cache_waits_for_it(tmp_path, monkeypatch):
    synced = []
    monkeypatch.setattr("asperity.files.os.fsync", synced.append)
    write_bytes(tmp_path / "run.nc", b"numbers", sealed=True)
    assert len(synced) == 1
    store = Store(tmp_path / "cache")
    key = content_key("scan", np.zeros(3))
    store.put(key, {"forces": np.zeros(3)})
    assert store.get(key) is not None
    assert len(synced) == 1
