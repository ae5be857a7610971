"""Uploads go to disk in pieces, lead nowhere else, and stay only where somebody can read them; so do runs."""

import asyncio
import io
import json
import sys

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.serving import stored_runs, worker
from asperity.serving.stored_runs import TooLarge, keep_run, receive, told_of, uploaded
from command_line import SMALL


async def pieces(*parts):
    for part in parts:
        if isinstance(part, Exception):
            raise part
        yield part


def received(root, *parts, name="beam.npy", announced=None):
    return asyncio.run(receive(root, name, announced, pieces(*parts), 100))


def test_a_file_is_kept_under_a_name_that_nobody_guesses(tmp_path):
    file = received(tmp_path, b"one ", b"two")
    assert file.read_bytes() == b"one two"
    assert file.name == "beam.npy"
    assert uploaded(tmp_path) == [{"id": file.parent.name, "name": "beam.npy"}]
    assert stored_runs.surface_named(tmp_path, file.parent.name) == file
    assert stored_runs.identifier_of(tmp_path, str(file)) == file.parent.name
    assert stored_runs.identifier_of(tmp_path, "/etc/passwd") is None


@pytest.mark.parametrize(
    ("parts", "announced", "error", "message"),
    [
        # nothing is asked for of what is announced too large, and nothing more of what turns out so
        ([AssertionError("asked for")], 101, TooLarge, "allowed: at most 256 MiB"),
        ([AssertionError("asked for")], 2**30, TooLarge, "received 1 GiB or more"),
        ([*[b"x" * 30] * 4, AssertionError("asked for")], 5, TooLarge, "allowed: at most"),
        ([], None, InputError, "an empty file"),
        ([b"half", ConnectionError("broken")], None, ConnectionError, "broken"),
    ],
)
def test_what_is_not_taken_leaves_nothing(tmp_path, parts, announced, error, message):
    with pytest.raises(error, match=message):
        received(tmp_path, *parts, announced=announced)
    assert list(tmp_path.iterdir()) == []


def test_all_surfaces_together_have_a_limit(tmp_path, monkeypatch):
    monkeypatch.setattr(stored_runs, "LARGEST_TOTAL", 100)
    received(tmp_path, b"x" * 60)
    for announced in (50, None):
        with pytest.raises(TooLarge, match=r"allowed: 100 bytes of them\. Delete those that no run uses"):
            received(tmp_path, b"x" * 30, b"x" * 20, announced=announced)
    assert len(uploaded(tmp_path)) == 1


@pytest.mark.parametrize("apart", [60.0, 0.005, 0.0], ids=["stalled", "slow", "fast"])
def test_an_upload_is_waited_for_while_it_comes(tmp_path, monkeypatch, apart):
    """Neither one that sends nothing more, nor one that sends next to nothing for ever."""
    monkeypatch.setattr(stored_runs, "STALLED", 0.05)

    async def slowly():
        for _ in range(40):
            yield b"x" * (1 if apart else 2000)
            await asyncio.sleep(apart or 0.005)

    def upload():
        return asyncio.run(receive(tmp_path, "x", None, slowly(), 100_000))

    if not apart:  # longer than it may stall, at more than the slowest rate
        assert upload().stat().st_size == 80_000
        return
    with pytest.raises(InputError, match=r"nothing more for 0 s, or less than 20 KiB in a second"):
        upload()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("name", "safe"), [
    ("../../etc/passwd", "passwd"), ("C:\\data\\beam.x3p", "beam.x3p"), ("..", "surface"), ("", "surface"),
    (".hidden.csv", "hidden.csv"), ("a\0b\n\u202e.csv", "a_b__.csv"), ("x" * 300 + ".csv", "x" * 96 + ".csv"),
    ("<img src=x>.txt", "_img_src_x_.txt"), ("CON.csv", "_CON.csv"), ("nul", "_nul"),
    ("a.csv. .", "a.csv._"), ("console.csv", "console.csv"),
])  # fmt: skip
def test_names_lead_nowhere_else(name, safe):
    assert stored_runs.safe_name(name) == safe


def test_a_map_is_described_and_what_it_lacks_is_asked_for(tmp_path):
    heights = np.random.default_rng(1).normal(size=(40, 30))
    np.save(tmp_path / "bare.npy", heights)
    needs = worker.examined(str(tmp_path / "bare.npy"))["needs"]
    assert 'height_unit = "um" in [surface]' in needs
    assert str(tmp_path) not in needs
    rows = "\n".join(" ".join(f"{z:.4f}" for z in row) for row in heights)
    (tmp_path / "told.txt").write_text(f"# pixel: 2 um\n# z (um)\n{rows}\n")
    assert worker.examined(str(tmp_path / "told.txt"))["words"].startswith(
        "map of 40 × 30 points, 2 um apart"
    )


@pytest.mark.parametrize("contents", [b"\x89HDF\r\n\x1a\nbroken", b"PK\x03\x04broken", b"no numbers at all"])
@pytest.mark.parametrize("ending", ["nc", "npz", "x3p", "txt"])
def test_what_nobody_can_read_is_refused(tmp_path, contents, ending):
    file = tmp_path / f"broken.{ending}"
    file.write_bytes(contents)
    with pytest.raises(InputError):
        worker.examined(str(file))


def test_what_is_no_identifier_names_no_folder(tmp_path):
    """Nor does a link."""
    (tmp_path / ("0" * 16)).mkdir()
    (tmp_path / ("1" * 16)).symlink_to("/etc")
    zeros = 15 * "0"
    for wrong in ("", "..", "../runs", zeros, zeros + "00", "G" * 16, zeros + "/", zeros + "\n", "1" * 16):
        assert stored_runs.folder_of(tmp_path, wrong) is None
    assert stored_runs.kept_in(tmp_path) == [stored_runs.folder_of(tmp_path, "0" * 16)]


def test_a_run_tells_what_became_of_it(tmp_path):
    folder = tmp_path / keep_run(tmp_path, "kind = 'x'", kind="x", name="  my \x1b run ", changed="a 1")
    assert told_of(folder)["state"] == "interrupted"  # nobody knows
    assert told_of(folder)["name"] == "my \\x1b run"
    stored_runs.write_outcome(folder, "failed", "why")
    assert (told_of(folder)["state"], told_of(folder)["message"]) == ("failed", "why")
    (folder / "run.nc").write_bytes(b"x")
    assert told_of(folder)["state"] == "done"
    (folder / "run.json").write_text("[1, 2")
    assert told_of(folder)["name"] == folder.name


def test_links_in_a_run_lead_nowhere(tmp_path):
    """Whether a file or the folder of the sounds is one, and whatever is asked of the run."""
    elsewhere, folder = tmp_path / "elsewhere", tmp_path / ("0" * 16)
    elsewhere.mkdir()
    folder.mkdir()
    for name in ("own.wav", "run.nc", "case.toml", "run.json"):
        (elsewhere / name).write_text('{"name": "secret"}')
        (folder / name).symlink_to(elsewhere / name)
    (folder / "sounds").symlink_to(elsewhere)
    assert stored_runs.file_of_run(folder, "sounds/own.wav") is None
    assert stored_runs.sounds_of_run(folder) == []
    assert told_of(folder)["state"] == "interrupted"
    assert told_of(folder)["name"] == folder.name
    with pytest.raises(InputError, match="received a link to another file"):
        stored_runs.case_of_run(folder)
    assert stored_runs.surface_named(tmp_path, folder.name) is None
    (folder / "sounds").unlink()
    (folder / "sounds").mkdir()
    (folder / "sounds" / "own.wav").write_bytes(b"")
    assert stored_runs.sounds_of_run(folder) == ["own.wav"]


def test_a_run_writes_its_sounds_where_no_link_leads(tmp_path, monkeypatch):
    """It begins anew in a folder of its own, whatever stands in its place."""
    elsewhere, folder, told = tmp_path / "elsewhere", tmp_path / ("0" * 16), io.StringIO()
    elsewhere.mkdir()
    folder.mkdir()
    (folder / "sounds").symlink_to(elsewhere)
    (folder / "case.toml").write_text(SMALL)
    monkeypatch.setattr(sys, "argv", ["", str(folder)])
    monkeypatch.setattr(worker, "_own_output", lambda: told)
    for of_its_process in ("end_with_parent", "os.nice"):
        monkeypatch.setattr(f"asperity.serving.worker.{of_its_process}", lambda *_: None)
    worker.roll_run()
    assert json.loads(told.getvalue().splitlines()[-1]) == {"state": "done"}
    assert stored_runs.is_own(folder, "run.nc")
    assert stored_runs.sounds_of_run(folder)
    assert not list(elsewhere.iterdir())


@pytest.mark.parametrize(
    "name",
    ["../run.nc", "run.json", "outcome.json", "sounds/../run.nc", "/etc/passwd", "sounds", ".hidden.nc",
     "a/b.csv", "run.nc\n", "link.nc"],
)  # fmt: skip
def test_only_results_of_a_run_are_handed_out(tmp_path, name):
    for file in ("run.json", "outcome.json", "run.nc"):
        (tmp_path / file).write_text("x")
    (tmp_path / "link.nc").symlink_to("run.nc")
    assert stored_runs.file_of_run(tmp_path, name) is None
    assert stored_runs.file_of_run(tmp_path, "run.nc") == tmp_path / "run.nc"
