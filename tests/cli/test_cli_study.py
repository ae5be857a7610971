"""The command line of studies: of a file, and of a case with --vary."""

import csv
import errno
import json
import re
import shutil
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from asperity.cli import main
from asperity.running import run
from asperity.spectra import a_weighting
from asperity.studies.definition import load_study

BALL = 'kind = "ball-on-beam"\n[surface]\nrms = "0.5 um"\n'
RAIL = 'kind = "wheel-on-rail"\n[surface]\nspectrum = "iso3095"\n'
SMALL = """
kind = "ball-on-beam"
laws = ["hertz", "linear", "hertz-filtered", "linear-filtered"]
start = "0.45 m"
duration = "20 ms"
settling = "0 s"
[surface]
spectrum = "iso3095"
level = "-20 dB"
[contact]
spacing = "10 um"
window = "0.4 mm"
"""
STUDY = """
case = "small.toml"
[sweep]
seed = [1, 2, 3, 4, 5, 6, 7, 8]
"ball.load" = ["5 N", "1 MN"]
"""
"""The heavy ball is refused: its contact is wider than the beam is high."""


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    Path("ball.toml").write_text(BALL)
    Path("rail.toml").write_text(RAIL)


def call(*arguments, code=0):
    outcome = CliRunner().invoke(main, list(arguments))
    assert outcome.exit_code == code, outcome.output
    return outcome


@pytest.fixture(scope="module")
def computed(tmp_path_factory):
    """Folder of a study of sixteen members of which eight fail, and what was said."""
    folder = tmp_path_factory.mktemp("study")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("ASPERITY_CACHE", str(folder / "cache"))
        Path("small.toml").write_text(SMALL)
        Path("study.toml").write_text(STUDY)
        outcome = call("study", "study.toml", "-o", "out", "--workers", "1")
    return folder, outcome


@pytest.fixture
def out(computed, monkeypatch):
    """The study and its results, in the working folder."""
    for name in ("small.toml", "study.toml"):
        shutil.copy(computed[0] / name, name)
    shutil.copytree(computed[0] / "out", "out")
    monkeypatch.setenv("ASPERITY_CACHE", str(computed[0] / "cache"))
    return Path("out")


def test_mean_and_band_over_the_seeds_are_written(computed):
    folder, outcome = computed
    with open(folder / "out" / "ensemble.csv", encoding="utf-8", newline="") as file:
        heading, *rows = csv.reader(file)
    assert heading[:4] == ["ball.load [N]", "law", "band [Hz]", "force_level [dB re 1 N]"]
    assert heading[4:6] == ["force_level_low [dB re 1 N]", "force_level_high [dB re 1 N]"]
    levels = xr.open_dataset(folder / "out" / "study.nc", engine="h5netcdf")["force_level"]
    assert len(rows) == levels[0].size
    mean, low, high = map(float, rows[0][3:6])
    assert mean == pytest.approx(float(levels[:, 0, 0, 0].mean()))
    assert low < mean < high
    page = (folder / "out" / "study.html").read_text(encoding="utf-8")
    assert '<figure id="ensemble" class="chart">' in page
    assert 'href="ensemble.csv"' in page
    assert "prediction interval; it holds the value of one more seed with a" in " ".join(
        outcome.stdout.split()
    )


def test_a_study_is_tabulated_and_written(computed):
    folder, outcome = computed
    assert "Study of 8 seed × 2 ball.load" in outcome.stderr
    for text in ("8 values of seed", "ball.load [N]", "contact loss", "hertz-filtered", " ± ", "–"):
        assert text in outcome.stdout
    assert "dB(A) over" in outcome.stdout
    assert "100 Hz" not in outcome.stdout
    assert str((folder / "out" / "study.nc").resolve()) in outcome.stdout
    with (folder / "out" / "study.csv").open(newline="", encoding="utf-8") as file:
        heading, *rows = csv.reader(file)
    assert heading[:3] == ["seed [1]", "ball.load [N]", "law"]
    assert len(rows) == 8 * 2 * 4
    with xr.open_dataset(folder / "out" / "study.nc", engine="h5netcdf") as found:
        share = found["contact_loss_share"]
        assert share.dims == ("seed", "ball.load", "law")
        assert found["completed"].values.tolist() == [[1, 0]] * 8
        column = heading.index("contact_loss_share [1]")
        for row in rows:
            value = float(share.sel({"seed": int(row[0]), "ball.load": float(row[1]), "law": row[2]}))
            assert (row[column] == "") == np.isnan(value)
            assert row[column] == "" or float(row[column]) == value


def test_a_member_is_what_a_run_of_its_case_is(out):
    keys = SMALL.replace('kind = "ball-on-beam"', 'kind = "ball-on-beam"\nseed = 3')
    Path("one.toml").write_text(keys.replace("[surface]", '[ball]\nload = "5 N"\n[surface]'))
    one = run("one.toml")["rolling"]
    with xr.open_dataset(out / "study.nc", engine="h5netcdf") as found:
        member = found.sel({"seed": 3, "ball.load": 5.0})
        np.testing.assert_array_equal(member["contact_loss_share"], one["contact_loss_share"][:, 0])
        np.testing.assert_array_equal(member["rms_force"], one["contact_force"][:, 0].std("time"))


def columns(path):
    """Columns of a CSV file by their titles."""
    with open(path, encoding="utf-8", newline="") as file:
        heading, *rows = csv.reader(file)
    return {name: [row[k] for row in rows] for k, name in enumerate(heading)}


def test_levels_in_decibels_a_and_largest_forces_are_columns(computed):
    """The totals are sums over the bands of the same row, with the weighting of IEC 61672."""
    found = columns(computed[0] / "out" / "study.csv")
    bands = {name: float(name.split()[1]) for name in found if name.startswith("force_level ")}
    done = [k for k, whether in enumerate(found["completed [1]"]) if whether == "1"]
    totals = {}
    for k in done:
        levels = {f: float(found[name][k]) for name, f in bands.items() if found[name][k]}
        total = 10 * np.log10(sum(10 ** ((level + a_weighting(f)) / 10) for f, level in levels.items()))
        assert float(found["force_level_a [dB(A) re 1 N]"][k]) == pytest.approx(
            float(total),
            abs=1e-4,  # frequencies in titles have six digits
        )
        totals[found["seed [1]"][k], found["law"][k]] = float(total)
    for k in done:
        change = float(found["force_level_a_difference_to_linear_filtered [dB]"][k])
        own, practice = (totals[found["seed [1]"][k], law] for law in (found["law"][k], "linear-filtered"))
        assert change == pytest.approx(own - practice, abs=2e-4)
        assert float(found["peak_force [N]"][k]) > float(found["mean_force [N]"][k])


def test_means_and_deviations_over_the_seeds_are_written(computed):
    """By load and law, as numpy has them; the row of the load that failed is empty."""
    every, mean = (columns(computed[0] / "out" / name) for name in ("study.csv", "study_mean.csv"))
    name = "peak_force [N]"
    for k, (load, law) in enumerate(zip(mean["ball.load [N]"], mean["law"], strict=True)):
        forces = [
            float(force)
            for force, *own in zip(every[name], every["ball.load [N]"], every["law"], strict=True)
            if own == [load, law] and force
        ]
        if load == "1000000.0":
            assert (mean[name][k], mean[f"± {name}"][k]) == ("", "")
            continue
        assert len(forces) == 8
        assert float(mean[name][k]) == pytest.approx(np.mean(forces))
        assert float(mean[f"± {name}"][k]) == pytest.approx(np.std(forces, ddof=1))


def test_swept_keys_stand_in_the_units_that_were_typed_and_have_a_figure_each():
    Path("small.toml").write_text(SMALL)
    vary = ["--vary", "speed = 3.6 km/h, 7.2 km/h", "--vary", "ball.load=5 N,0.006 kN", "--vary", "seed=1"]
    said = call("study", "small.toml", *vary, "-o", "out", "--workers", "1").stdout
    found = columns("out/study.csv")
    assert sorted(set(found["speed [km/h]"])) == ["3.6", "7.2"]
    assert sorted(set(found["ball.load [N]"])) == ["5.0", "6.0"]  # the unit of the first value
    assert "speed [km/h]" in said
    with xr.open_dataset("out/study.nc", engine="h5netcdf") as table:
        assert table["speed"].values.tolist() == pytest.approx([1.0, 2.0])
        assert table["speed"].attrs["units"] == "m/s"
    page = Path("out/study.html").read_text(encoding="utf-8")
    figures = re.findall('<figure id="(.*?)" class="chart">', page)
    assert figures == ["key-speed", "key-ball.load"]  # of one seed there is nothing to draw
    assert '<td class="number">3.6</td>' in page  # without a script its numbers are read
    assert not Path("out/study_mean.csv").exists()


def test_what_members_met_is_said_once(computed):
    said = computed[1].stderr
    (warned,) = [line for line in said.splitlines() if "after rest" in line]
    assert warned.startswith("Warning (8 of 16 members): the record starts 0 ms after rest")
    (failed,) = [line for line in said.splitlines() if line.startswith("Failed")]
    assert failed.startswith("Failed (8 of 16 members): ")
    assert "  - seed = 6, ball.load = 1 MN\n  - and 2 more\n" in said


def test_names_in_a_table_are_no_formulas_and_no_markup():
    heights = 0.02 * np.random.default_rng(0).normal(size=(40, 40))
    for name in ("=cmd|x.npy", "[red]a [um].npy"):
        with open(name, "wb") as file:
            np.save(file, heights)
    Path("study.toml").write_text(
        '[case]\nkind = "ball-on-beam"\nlaws = ["linear"]\nstart = "0.45 m"\nduration = "5 ms"\n'
        'settling = "0 s"\n[case.surface]\nheight_unit = "um"\npixel = "20 um"\n'
        '[case.contact]\nspacing = "20 um"\nsamples = 1\n'
        '[sweep]\n"surface.file" = ["=cmd|x.npy", "[red]a [um].npy"]\n'
    )
    outcome = call("study", "study.toml", "-o", "out", "--workers", "1")
    assert "[red]a [um].npy" in outcome.stdout
    with open("out/study.csv", newline="", encoding="utf-8") as file:
        heading, *rows = csv.reader(file)
    assert [row[0] for row in rows] == ["'=cmd|x.npy", "[red]a [um].npy"]
    assert rows[0][heading.index("completed [1]")] == "1"  # numbers stay as they are


def test_columns_and_figures_are_those_that_are_asked_for(out):
    """With the words of --show, bands too; a wrong name is refused before anything is computed."""
    asked = ["--show", "rms_force, force_level", "--show", "transit exposure levels"]
    message = call("study", "study.toml", "-o", "out", *asked, code=2).stderr
    assert "--show: received 'transit_exposure_levels'; allowed: names of what a study keeps: " in message
    outcome = call("study", "study.toml", "-o", "out", "--workers", "1", *asked[:2], "--json")
    document = json.loads(outcome.stdout)
    assert {title.split()[0] for title in document["columns"]} == {
        "seed", "ball.load", "law", "rms_force", "force_level",
    }  # fmt: skip
    said = call("study", "study.toml", "-o", "out", "--workers", "1", "--show", "mean_force").stdout
    assert "mean force [N]" in said
    assert "peak" not in said


def test_a_case_may_be_varied_without_a_file():
    Path("small.toml").write_text(SMALL)
    vary = ["--vary", "speed=1 m/s, 7.2 km/h", "--vary", "ball.load = 5 N,6 N"]
    call("study", "small.toml", *vary, "--workers", "1")
    with xr.open_dataset("runs/small/study.nc", engine="h5netcdf") as found:
        assert found["speed"].values.tolist() == [1.0, 2.0]
        assert found["ball.load"].values.tolist() == [5.0, 6.0]
        assert found["completed"].values.all()
        assert np.ptp(found["rms_force"].values[..., 0]) > 0.0


def test_an_earlier_study_stays_whole_until_all_is_there_that_replaces_it(out, monkeypatch):
    before = {file.name: file.read_bytes() for file in out.iterdir()}
    full = Mock(side_effect=OSError(errno.ENOSPC, "No space left"))
    monkeypatch.setattr("asperity.cli.studying._page", full)
    told = call("study", "study.toml", "-o", "out", "--workers", "1", code=3).stderr
    assert "out could not be written: the disk is full" in told
    assert {file.name: file.read_bytes() for file in out.iterdir()} == before


def test_another_study_is_never_overwritten_unasked(out):
    again = ["study", "study.toml", "-o", "out", "--workers", "1"]
    before = (out / "study.nc").stat().st_mtime_ns
    call(*again)
    assert (out / "study.nc").stat().st_mtime_ns > before
    Path("study.toml").write_text(STUDY.replace("[1, 2, 3, 4, 5, 6, 7, 8]", "[1, 2]"))
    assert "out: received the study.nc of another study" in call(*again, code=2).stderr
    Path("out/study.nc").write_text("precious")
    assert "out: received the study.nc of another study" in call(*again, code=2).stderr
    assert Path("out/study.nc").read_text() == "precious"
    call(*again, "--overwrite")
    with xr.open_dataset("out/study.nc", engine="h5netcdf") as found:
        assert found.sizes["seed"] == 2
    assert "rail.toml is a file)" in call("study", "study.toml", "-o", "rail.toml", code=2).stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["study", "rail.toml", "--vary", "speed"],
            "--vary: received 'speed'; allowed: a key of the case, =,",
        ),
        (["study", "rail.toml", *["--vary", "seed=1"] * 2], "--vary: received seed more than once"),
        (["study", "rail.toml", "--vary", "seed=1, 2.5"], "sweep.seed[2]: received 2.5"),
        (["study", "rail.toml", "--vary", "speed=20"], "sweep.speed[1]: received 20; allowed: a speed"),
        (["study", "rail.toml", "--vary", "speed=20 m/s,"], "sweep.speed[2]: received ''"),
        (["study", "rail.toml", "--vary", "speed=-1 m/s"], "sweep.speed[1]: received '-1 m/s'"),
        (["study", "rail.toml", "--vary", "wheel.load=inf"], "sweep.wheel.load[1]: received 'inf'"),
        (
            ["study", "rail.toml", "--vary", "wheel.load=5 kN,5000 N"],
            "wheel.load: received '5000 N' more than once",
        ),
        (["study", "absent.toml"], "absent.toml: received no such file; allowed: the path of a study file"),
        (["study", "rail.toml"], "case: received nothing"),
        (
            ["study", "rail.toml", "--vary", "wheel.load=5 kN", "--workers", "2", "--scheduler", "x"],
            "--workers: received",
        ),
    ],
)
def test_wrong_input_is_explained(arguments, message):
    assert message in call(*arguments, code=2).stderr
    assert not list(Path().glob("runs/*/study.nc"))


def test_a_new_study_is_valid():
    Path("study.toml").write_text(call("new", "study").stdout)
    Path("case.toml").write_text(RAIL)
    assert load_study("study.toml").shape == (2, 3)
