"""Uploads go to disk in pieces, lead nowhere else, and stay only where somebody can read them."""

import asyncio

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.serving import uploads
from asperity.serving.kept_runs import (
    file_of_run,
    folder_of,
    keep_run,
    kept_in,
    told_of,
    write_outcome,
)
from asperity.serving.uploads import (
    TooLarge,
    examined,
    identifier_of,
    receive,
    safe_name,
    surface_named,
    uploaded,
)


async def pieces(*parts):
    for part in parts:
        yield part


def received(root, name, *parts, announced=None, largest=100):
    return asyncio.run(receive(root, name, announced, pieces(*parts), largest))


def test_a_file_is_kept_under_a_name_that_nobody_guesses(tmp_path):
    file = received(tmp_path, "beam.npy", b"one ", b"two")
    assert file.read_bytes() == b"one two"
    assert file.name == "beam.npy"
    assert uploaded(tmp_path) == [{"id": file.parent.name, "name": "beam.npy"}]
    assert surface_named(tmp_path, file.parent.name) == file
    assert identifier_of(tmp_path, str(file)) == file.parent.name
    assert identifier_of(tmp_path, "/etc/passwd") is None


@pytest.mark.parametrize("announced", [101, 2**30])
def test_what_is_announced_too_large_is_not_begun(tmp_path, announced):
    async def never():
        raise AssertionError("a piece was asked for")
        yield b""

    with pytest.raises(TooLarge, match="allowed: at most"):
        asyncio.run(receive(tmp_path, "x", announced, never(), 100))
    assert list(tmp_path.iterdir()) == []


def test_what_turns_out_too_large_is_left_off_there(tmp_path):
    taken = []

    async def endless():
        while True:
            taken.append(1)
            yield b"x" * 30

    with pytest.raises(TooLarge):
        asyncio.run(receive(tmp_path, "x", 5, endless(), 100))
    assert len(taken) == 4
    assert list(tmp_path.iterdir()) == []


def test_all_surfaces_together_have_a_limit(tmp_path, monkeypatch):
    monkeypatch.setattr(uploads, "LARGEST_TOTAL", 100)
    received(tmp_path, "a.npy", b"x" * 60)
    for announced in (50, None):
        with pytest.raises(TooLarge, match=r"allowed: 100 bytes of them\. Delete those that no run uses"):
            received(tmp_path, "b.npy", b"x" * 30, b"x" * 20, announced=announced)
    assert len(uploaded(tmp_path)) == 1


@pytest.mark.parametrize("apart", [60.0, 0.005], ids=["stalled", "slow"])
def test_an_upload_that_stalls_is_not_waited_for(tmp_path, monkeypatch, apart):
    """Neither one that sends nothing more, nor one that sends next to nothing for ever."""
    monkeypatch.setattr(uploads, "STALLED", 0.05)

    async def slowly():
        while True:
            yield b"x"
            await asyncio.sleep(apart)

    with pytest.raises(InputError, match=r"nothing more for 0 s, or less than 20 KiB in a second"):
        asyncio.run(receive(tmp_path, "x", None, slowly(), 100_000))
    assert list(tmp_path.iterdir()) == []


def test_an_empty_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="an empty file"):
        received(tmp_path, "beam.npy")
    assert list(tmp_path.iterdir()) == []


def test_a_connection_that_breaks_leaves_nothing(tmp_path):
    async def broken():
        yield b"half"
        raise ConnectionError

    with pytest.raises(ConnectionError):
        asyncio.run(receive(tmp_path, "x", None, broken(), 100))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "safe"),
    [
        ("../../etc/passwd", "passwd"),
        ("C:\\data\\beam.x3p", "beam.x3p"),
        ("..", "surface"),
        ("", "surface"),
        (".hidden.csv", "hidden.csv"),
        ("a\0b\n‮.csv", "a_b__.csv"),
        ("x" * 300 + ".csv", "x" * 96 + ".csv"),
        ("<img src=x>.txt", "_img_src_x_.txt"),
        ("CON.csv", "_CON.csv"),
        ("lpt1.x3p", "_lpt1.x3p"),
        ("nul", "_nul"),
        ("a.csv. .", "a.csv._"),
        ("console.csv", "console.csv"),
    ],
)
def test_names_lead_nowhere_else(name, safe):
    assert safe_name(name) == safe


def test_a_map_is_described_and_what_it_lacks_is_asked_for(tmp_path):
    heights = np.random.default_rng(1).normal(size=(40, 30))
    np.save(tmp_path / "bare.npy", heights)
    needs = examined(str(tmp_path / "bare.npy"))["needs"]
    assert 'height_unit = "um" in [surface]' in needs
    assert str(tmp_path) not in needs
    rows = "\n".join(" ".join(f"{z:.4f}" for z in row) for row in heights)
    (tmp_path / "told.txt").write_text(f"# pixel: 2 um\n# z (um)\n{rows}\n")
    told = examined(str(tmp_path / "told.txt"))
    assert told["words"].startswith("map of 40 × 30 points, 2 um apart"), told


@pytest.mark.parametrize("contents", [b"\x89HDF\r\n\x1a\nbroken", b"PK\x03\x04broken", b"no numbers at all"])
@pytest.mark.parametrize("ending", ["nc", "npz", "x3p", "txt"])
def test_what_nobody_can_read_is_refused(tmp_path, contents, ending):
    file = tmp_path / f"broken.{ending}"
    file.write_bytes(contents)
    with pytest.raises(InputError):
        examined(str(file))


@pytest.mark.parametrize(
    "identifier", ["", "..", "../runs", "0" * 15, "0" * 17, "G" * 16, "0" * 15 + "/", "0" * 15 + "\n"]
)
def test_what_is_no_identifier_names_no_folder(tmp_path, identifier):
    (tmp_path / ("0" * 16)).mkdir()
    assert folder_of(tmp_path, identifier) is None
    assert folder_of(tmp_path, "0" * 16) is not None


def test_links_are_not_followed(tmp_path):
    (tmp_path / ("0" * 16)).symlink_to("/etc")
    assert folder_of(tmp_path, "0" * 16) is None
    assert list(kept_in(tmp_path)) == []


def test_a_run_tells_what_became_of_it(tmp_path):
    folder = tmp_path / keep_run(tmp_path, "kind = 'x'", kind="x", name="  my \x1b run ", changed="a 1")
    assert told_of(folder)["state"] == "interrupted"  # nobody knows
    assert told_of(folder)["name"] == "my \\x1b run"
    write_outcome(folder, "failed", "why")
    assert (told_of(folder)["state"], told_of(folder)["message"]) == ("failed", "why")
    (folder / "run.nc").write_bytes(b"x")
    assert told_of(folder)["state"] == "done"
    (folder / "run.json").write_text("[1, 2")
    assert told_of(folder)["name"] == folder.name


@pytest.mark.parametrize(
    "name",
    [
        "../run.nc",
        "run.json",
        "outcome.json",
        "sounds/../run.nc",
        "/etc/passwd",
        "sounds",
        ".hidden.nc",
        "a/b.csv",
        "run.nc\n",
    ],
)
def test_only_results_of_a_run_are_handed_out(tmp_path, name):
    for file in ("run.json", "outcome.json", "run.nc"):
        (tmp_path / file).write_text("x")
    assert file_of_run(tmp_path, name) is None
    assert file_of_run(tmp_path, "run.nc") == tmp_path / "run.nc"
