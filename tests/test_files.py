"""Files that are written completely or not at all, sealed, and swept; columns of text; files opened apart."""

import csv
import errno
import io
import math
import sys
from contextlib import nullcontext
from pathlib import Path

import h5py
import numpy as np
import pytest

from answering import ARRAYS, answered
from asperity import files
from asperity.errors import ComputationError, InputError
from asperity.files import alone_in, atomic_write, is_sealed, left_overs, together, write_bytes
from asperity.reporting.figure import columns_text
from asperity.sandbox import received, sandboxed, send
from asperity.text_files import csv_text, write_csv

if sys.platform != "win32":
    import fcntl

posix = pytest.mark.skipif(sys.platform == "win32", reason="open files cannot be removed there")


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_seal_shows_every_flipped_byte_and_every_length(tmp_path):
    path = write_bytes(tmp_path / "a", b"contents that matter", sealed=True)
    whole = path.read_bytes()
    flipped = (whole[:at] + bytes([whole[at] ^ 1 << at % 8]) + whole[at + 1 :] for at in range(len(whole)))
    for contents in (whole, *flipped, *(whole[:length] for length in range(len(whole)))):
        path.write_bytes(contents)
        with open(path, "rb") as file:
            assert bool(is_sealed(file)) is (contents == whole)
            assert file.tell() == 0


def test_archives_and_hdf5_files_are_read_behind_their_seal(tmp_path):
    """Their readers pass over what follows their end."""
    archive = atomic_write(tmp_path / "a.npz", lambda file: np.savez(file, x=np.arange(3)), sealed=True)
    np.testing.assert_array_equal(np.load(archive)["x"], np.arange(3))

    def write(file):
        with h5py.File(file, "w") as opened:
            opened["x"] = np.arange(3)

    with h5py.File(atomic_write(tmp_path / "a.h5", write, sealed=True)) as opened:
        np.testing.assert_array_equal(opened["x"], np.arange(3))


@posix
def test_left_overs_are_swept_at_the_first_write_and_what_is_being_written_is_none(tmp_path):
    part = tmp_path / ".run.nc.0123abcd.part"
    part.write_bytes(b"killed")
    (tmp_path / ".run.nc.part").write_bytes(b"not ours")

    def write(file):
        assert left_overs(tmp_path) == []
        assert files.remove_left_overs(tmp_path) == 0
        assert not files.discard(Path(file.name))
        file.write(b"whole")

    assert atomic_write(tmp_path / "run.nc", write).read_bytes() == b"whole"
    assert names(tmp_path) == [".run.nc.part", "run.nc"]
    part.write_bytes(b"killed later")
    write_bytes(tmp_path / "run.nc", b"again")
    assert left_overs(tmp_path) == [part]
    with together(tmp_path, last="b") as new:
        assert left_overs(tmp_path) == []
        assert new.is_dir()


@posix
def test_a_left_over_goes_while_it_is_locked(tmp_path, monkeypatch):
    """Else a writer that has made it, and is about to lock it, would write into a file without a name."""
    unlink = Path.unlink

    def locked_unlink(path, **options):
        with open(path, "rb") as file, pytest.raises(BlockingIOError):
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        unlink(path, **options)

    (tmp_path / ".run.nc.0123abcd.part").write_bytes(b"killed")
    monkeypatch.setattr(Path, "unlink", locked_unlink)
    assert files.remove_left_overs(tmp_path) == 1
    assert names(tmp_path) == []


def test_new_files_come_together_or_not_at_all(tmp_path, monkeypatch):
    (tmp_path / "run.nc").write_bytes(b"old")
    with pytest.raises(ComputationError, match="Not a directory"), together(tmp_path, last="b") as new:
        (write_bytes(new / "run.nc", b"new") / "left").mkdir()
    assert (tmp_path / "run.nc").read_bytes() == b"old"
    moved, replace = [], files.os.replace
    with together(tmp_path, last="a page.html") as new:
        for name in ("a page.html", "run.nc", "sounds/a.wav"):
            write_bytes(new / name, b"new")
        monkeypatch.setattr(
            files.os, "replace", lambda one, other: (moved.append(other.name), replace(one, other))
        )
    assert moved[-1] == "a page.html"
    assert sorted(moved) == ["a page.html", "a.wav", "run.nc"]
    assert names(tmp_path) == ["a page.html", "run.nc", "sounds"]
    assert (tmp_path / "run.nc").read_bytes() == b"new"


@posix
def test_a_run_is_alone_in_its_folder(tmp_path):
    folder = tmp_path / "runs" / "case"
    with alone_in(folder):
        with pytest.raises(InputError, match="another run is writing"), alone_in(folder):
            pytest.fail("two runs in one folder")
        write_bytes(folder / "run.nc", b"done")
    with pytest.raises(ZeroDivisionError), alone_in(folder):
        raise ZeroDivisionError
    assert names(folder) == ["run.nc"]
    with pytest.raises(ZeroDivisionError), alone_in(tmp_path / "new"):
        raise ZeroDivisionError
    assert not (tmp_path / "new").exists()
    with pytest.raises(ComputationError, match="could not be written"), alone_in(folder / "run.nc" / "new"):
        pytest.fail("it is a file")


@pytest.mark.parametrize(("place", "why"), [
    ("new/folder", ""),
    ("file/new", r"file is a file\); allowed: a folder that can be written to\. Another"),
    ("link/new", r"link is a link that leads nowhere\)"),
    (300 * "a", r"\(File name too long\)"),
])  # fmt: skip
def test_a_folder_that_cannot_be_written_to_is_refused_before(tmp_path, place, why):
    (tmp_path / "file").write_text("")
    (tmp_path / "link").symlink_to("nowhere")
    with pytest.raises(InputError, match=f"^results: received .*{why}") if why else nullcontext():
        files.refuse_unwritable(tmp_path / place, "results", "Another.")
    assert names(tmp_path) == ["file", "link"]


def test_what_the_disk_cannot_hold_is_refused_before_it_is_written(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "free_space", lambda path: 3 * 2**20)
    with pytest.raises(ComputationError, match=r"the disk is full \(4 MiB are needed, 3 MiB are free\)"):
        write_bytes(tmp_path / "run.nc", bytes(4 * 2**20))
    assert names(tmp_path) == []


@pytest.mark.parametrize(("code", "error", "message"), [
    (errno.ENOSPC, ComputationError, r"the disk is full \(.* are free\)"),
    (errno.EFBIG, ComputationError, "files may not grow as large here.*ulimit -f unlimited"),
    (errno.EIO, ComputationError, r"could not be written \(Input/output error\)"),
    (errno.ENAMETOOLONG, InputError, "a name that is too long"),
])  # fmt: skip
def test_what_fails_half_way_leaves_the_earlier_file(tmp_path, code, error, message):
    (tmp_path / "run.nc").write_bytes(b"old")

    def write(file):
        file.write(b"half")
        raise OSError(code, "Input/output error")

    with pytest.raises(error, match=message):
        atomic_write(tmp_path / "run.nc", write)
    assert (tmp_path / "run.nc").read_bytes() == b"old"
    assert names(tmp_path) == ["run.nc"]


def test_results_are_on_the_disk_at_once_and_no_cache_waits_for_it(tmp_path, monkeypatch):
    synced = []
    monkeypatch.setattr("asperity.files.os.fsync", synced.append)
    atomic_write(tmp_path / "block.npz", lambda file: file.write(b"numbers"), lasting=False)
    assert synced == []
    write_bytes(tmp_path / "run.nc", b"numbers", sealed=True)
    assert len(synced) == 1


# --- comma-separated text: exact numbers, and words that no spreadsheet runs


@pytest.mark.parametrize("word", ["=cmd|' /C calc'!A0", "+1+1", "-2+3", "@SUM(A1)"])
def test_words_that_look_like_formulas_are_escaped(word):
    text = csv_text([word, "b"], [[word, -1.5]])
    heading, row = csv.reader(io.StringIO(text, newline=""))
    assert heading == [f"'{word}", "b"]
    assert row == [f"'{word}", "-1.5"]


def test_numbers_are_exact_and_missing_ones_empty():
    """Of figures as of studies."""
    numbers = [-0.1, 1 / 3, 5e-324, 1e308, -3.0]
    text = csv_text(["n", "m"], [(number, math.nan) for number in numbers])
    assert columns_text({"n": np.array(numbers), "m": np.full(5, np.nan)}) == text
    heading, *rows = csv.reader(io.StringIO(text))
    assert heading == ["n", "m"]
    assert [(float(number), missing) for number, missing in rows] == [(number, "") for number in numbers]


def test_a_word_stays_in_its_field(tmp_path):
    words = ["\t=1", "\r=1", "a\r\nb", "\ud800", 'a,"b"']
    file = write_csv(tmp_path / "a.csv", ["a"], [[word] for word in words])
    with open(file, newline="", encoding="utf-8") as opened:
        shown = [row[0] for row in csv.reader(opened)]
    assert shown == ["a", "\\t=1", "\\r=1", "a\\r\\nb", "\\ud800", 'a,"b"']


# --- what a function returns that was called in a process of its own


def test_what_is_received_was_sent():
    send(answered("é", ""), stream := io.BytesIO())
    stream.seek(0)
    description, arrays = received(stream)
    assert description == {"path": "é", "low": -np.inf, "seed": 3}
    for found, sent in zip(arrays, ARRAYS, strict=True):
        assert found.dtype == (sent.dtype if sent.dtype != object else "<U10")
        np.testing.assert_array_equal(found, sent)
        assert found.flags.aligned
        assert found.flags.writeable
    with pytest.raises(ValueError, match="ends before its numbers do"):
        received(io.BytesIO(stream.getvalue()[:-5]))


@pytest.mark.parametrize(("fault", "message"), [
    ("input", "^a.nc: received nothing; allowed: something. Write it.$"),
    ("any", r"KeyError \('no such\\tthingx+ …\) while it was opened; allowed: an intact text file"),
])  # fmt: skip
def test_what_it_raises_is_told(fault, message, monkeypatch, tmp_path):
    (tmp_path / "a.nc").touch()
    monkeypatch.syspath_prepend(__file__.rpartition("/")[0])
    with pytest.raises(InputError, match=message):
        sandboxed(answered, tmp_path / "a.nc", [fault], source="a.nc", kind="text")
