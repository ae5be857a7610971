"""What is made of a finished run: reports, figures, sounds, comparisons, citations; and what is kept."""

import json
import shutil
from pathlib import Path

import numpy as np

import asperity
from asperity.results import read_result
from asperity.store import Store
from command_line import call, words_of


def test_what_to_cite_for_a_run_is_said(ran):
    told = call("cite", ran.path).stdout.splitlines()
    assert told[0].startswith(f"asperity {asperity.__version__}: ")
    assert told[1:] == json.loads(read_result(ran.folder).attrs["citations"])
    assert any("Lundberg" in line for line in told)


def test_a_run_is_written_as_sounds(ran):
    told = call("listen", f"{ran.path}/run.nc", "-o", "heard").stdout
    assert f"{len(list(Path('heard').glob('*.wav')))} files, all on one scale" in words_of(told)


def test_signals_of_a_run_are_written_for_programs_of_measurement(ran):
    told = call("signals", f"{ran.path}/run.nc").stdout
    assert "1 file; signals.csv says what they are" in words_of(told)
    assert (ran.folder / "signals" / "signals.uff").exists()
    call("signals", ran.path, "--format", "wav", "--what", "contact_force", "-o", "w")
    assert len(list(Path("w").glob("contact_force-*.wav"))) == len(list(Path("w").glob("*.wav"))) > 0


def test_figures_of_a_run_are_drawn_when_asked(ran, monkeypatch):
    told = call("figures", f"{ran.path}/run.nc", "scene", "contact force levels", "--format", "pdf").stdout
    files = [ran.folder / "figures" / f"{name}.pdf" for name in ("scene", "force_bands")]
    assert [file.read_bytes()[:4] for file in files] == [b"%PDF"] * 2
    assert "scene.pdf, force_bands.pdf" in words_of(told)
    monkeypatch.setattr("asperity.reporting.paper.save_figure", lambda figure, file, format: file.write(b"x"))
    call("figures", ran.path, "-o", "all")  # each is drawn; how it is saved is seen above
    numbers = {path.stem for path in ran.folder.glob("*.csv")}
    assert {path.name for path in Path("all").iterdir()} == {f"{name}.svg" for name in numbers}


def test_a_report_is_written_again_from_its_run_and_as_a_summary(ran):
    again = call("report", f"{ran.path}/run.nc", "-o", "page").stdout
    assert str(Path("page/report.html").absolute()) in again
    assert Path("page/report.html").read_bytes() == (ran.folder / "report.html").read_bytes()
    tables = [{path.name for path in folder.glob("*.csv")} for folder in (Path("page"), ran.folder)]
    assert tables[0] == tables[1]
    call("report", ran.path, "--summary", "-o", "sheet")
    assert [path.name for path in Path("sheet").iterdir()] == ["summary.html"]


def test_runs_are_compared(ran):
    """A page and a table, and what they say in short; with itself a run has no differences."""
    told = call("compare", ran.path, f"{ran.path}/run.nc", "-o", "both").stdout
    assert "The cases are the same. " in told
    assert "0.0 dB(A)" in told
    assert Path("both/comparison.html").stat().st_size > 50_000
    assert str(Path("both/comparison.csv").resolve()) in told
    call("compare", ran.path, ran.path, "-o", "page.html")
    assert Path("page.html").exists()
    assert Path("page.csv").exists()


def test_pictures_of_a_surface_have_the_format_of_their_name():
    np.save("line.npy", np.random.default_rng(0).normal(size=300))
    for name, begin in (("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.pdf", b"%PDF")):
        call("surface", "line.npy", "--height-unit", "um", "--pixel", "2 um", "-o", name)
        assert Path(name).read_bytes().startswith(begin)


def test_what_is_kept_is_shown_and_cleared(own_folder, monkeypatch):
    """Of the program's own files alone."""
    monkeypatch.setenv("ASPERITY_KERNELS", str(own_folder / "kernels"))
    monkeypatch.setattr("tempfile.tempdir", str(own_folder))
    cache, version = own_folder / "cache", own_folder / "kernels" / "0123456789abcdef"
    Store().put("scan-1", {"force": np.zeros(2**17)})
    version.mkdir(parents=True, mode=0o700)
    (version / f"asperity.kernels.box-{24 * '0'}").write_bytes(bytes(2**20))
    for left in (cache / ".scan-2.npz.01234567.part", version / ".kernel-1.01234567.part"):
        left.write_bytes(bytes(2**10))
    (cache / "notes.txt").write_text("of the user")
    for own in (cache / "map.npz", version / "map.npz"):
        np.savez(own, heights=np.eye(3))
    (cache / ".map.npz.01234567.part").mkdir()
    (cache / f"scan-{64 * '0'}.npz").symlink_to(cache / "map.npz")
    shutil.copy(cache / "scan-1.npz", cache / "my copy.npz")
    elsewhere = own_folder / "elsewhere"
    elsewhere.mkdir(mode=0o700)
    (elsewhere / f"asperity.kernels.box-{24 * '0'}").write_bytes(b"mine")
    (version.parent / "fedcba9876543210").symlink_to(elsewhere)
    mine = {path.name for path in cache.iterdir()} - {"scan-1.npz", ".scan-2.npz.01234567.part"}
    told = [
        f"{cache}: 1 result{{}}, 1 MiB",
        f"{own_folder / 'kernels'}: 1 compiled function{{}}, 1 MiB",
        f"{cache}: 1 file left by interrupted runs{{}}, 1 KiB",
        f"{own_folder / 'kernels'}: 1 file left by interrupted runs{{}}, 1 KiB",
    ]
    assert call("cache").stdout.splitlines() == [line.format("") for line in told]
    assert call("cache", "--clear").stdout.splitlines() == [line.format(" deleted") for line in told]
    assert {path.name for path in cache.iterdir()} == mine
    assert [path.name for path in version.iterdir()] == ["map.npz"]
    assert len(list(elsewhere.iterdir())) == 1
