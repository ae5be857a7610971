"""The command line of studies: of a file, and of a case with --vary."""

import csv
import errno
import json
import re
import shutil
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
import xarray as xr

import asperity
from asperity.cli.studying import defined
from asperity.studies.definition import load_study, study_of
from command_line import RAIL, SMALL, call, made_again, words_of, working_in
from small_cases import changed

pytestmark = pytest.mark.usefixtures("members_in_this_process")

FILTERED = SMALL.replace('["hertz", "linear"]', '["hertz", "linear", "hertz-filtered", "linear-filtered"]')
FILTERED += 'level = "-20 dB"\n[contact]\nspacing = "10 um"\nwindow = "0.4 mm"\n'
STUDY = """
case = "filtered.toml"
[sweep]
seed = [1, 2, 3, 4, 5, 6, 7, 8]
"ball.load" = ["5 N", "1 MN"]
"""
"""The heavy ball is refused: its contact is wider than the beam is high."""
AGAIN = ("study", "study.toml", "-o", "out", "--workers", "1")
PEAK = "peak_force [N]"


@pytest.fixture(scope="module")
def computed(tmp_path_factory):
    """Folder of a study of sixteen members of which eight fail, and what was said."""
    with working_in(tmp_path_factory.mktemp("study")) as folder:
        Path("filtered.toml").write_text(FILTERED)
        Path("study.toml").write_text(STUDY)
        outcome = call(*AGAIN)
        with xr.open_dataset("out/study.nc", engine="h5netcdf") as found:
            table = found.load()
    return SimpleNamespace(folder=folder, out=folder / "out", said=outcome, table=table)


@pytest.fixture
def out(computed, monkeypatch):
    """The study and its results, in the working folder."""
    for name in ("filtered.toml", "study.toml"):
        shutil.copy(computed.folder / name, name)
    shutil.copytree(computed.out, "out")
    monkeypatch.setenv("ASPERITY_CACHE", str(computed.folder / "cache"))
    return Path("out")


def columns(path):
    """Columns of a CSV file by their titles."""
    with open(path, encoding="utf-8", newline="") as file:
        heading, *rows = csv.reader(file)
    return {name: [row[k] for row in rows] for k, name in enumerate(heading)}


def numbers(column):
    return np.array([float(value or "nan") for value in column])


def test_what_was_computed_is_printed(computed):
    """What members met, each once."""
    told, warned = words_of(computed.said.stdout), computed.said.stderr
    assert "Study of 8 seed × 2 ball.load" in warned
    for text in (
        "mean ± standard deviation over 8 values of seed",
        "ball.load [N]",
        "contact loss",
        "hertz-filtered",
        " ± ",
        "–",
        "over linear",
    ):
        assert text in told
    assert "100 Hz" not in told
    assert str((computed.out / "study.nc").resolve()) in told
    (rest,) = [line for line in warned.splitlines() if "after rest" in line]
    assert rest.startswith("Warning (8 of 16 members): the record starts 0 ms after rest")
    (failed,) = [line for line in warned.splitlines() if line.startswith("Failed")]
    assert failed.startswith("Failed (8 of 16 members): ")
    assert "  - seed = 6, ball.load = 1 MN\n  - and 2 more\n" in warned


def test_the_table_is_written_as_numbers_and_text(computed):
    """Losses and largest forces, too; levels by band and in total."""
    found, table = columns(computed.out / "study.csv"), computed.table
    assert list(found)[:3] == ["seed [1]", "ball.load [N]", "law"]
    assert table["contact_loss_share"].dims == ("seed", "ball.load", "law")
    assert table["completed"].values.tolist() == [[1, 0]] * 8
    for name, title in (("contact_loss_share", "contact_loss_share [1]"), ("peak_force", PEAK)):
        np.testing.assert_array_equal(numbers(found[title]), table[name].values.ravel())
    assert "force_level_a [dB(A) re 1 N]" in found
    assert "force_level_a_difference_to_linear_filtered [dB]" in found
    assert (table["peak_force"] > table["mean_force"])[:, 0].all()


def test_means_deviations_and_band_over_the_seeds_are_written(computed):
    """By load and law, as numpy has them; the row of the load that failed is empty."""
    mean, peak = columns(computed.out / "study_mean.csv"), computed.table["peak_force"].values
    done = [load != "1000000.0" for load in mean["ball.load [N]"]]
    assert done == [True] * 4 + [False] * 4
    np.testing.assert_allclose(numbers(mean[PEAK]), peak.mean(0).ravel())
    np.testing.assert_allclose(numbers(mean[f"± {PEAK}"]), peak.std(0, ddof=1).ravel())
    band = columns(computed.out / "ensemble.csv")
    low, high = (f"force_level_{end} [dB re 1 N]" for end in ("low", "high"))
    assert list(band)[:6] == ["ball.load [N]", "law", "band [Hz]", "force_level [dB re 1 N]", low, high]
    levels = computed.table["force_level"]
    assert len(band["law"]) == levels[0].size
    assert float(band["force_level [dB re 1 N]"][0]) == pytest.approx(float(levels[:, 0, 0, 0].mean()))
    assert float(band[low][0]) < float(levels[:, 0, 0, 0].mean()) < float(band[high][0])
    page = (computed.out / "study.html").read_text(encoding="utf-8")
    assert '<figure id="ensemble" class="chart">' in page
    assert 'href="ensemble.csv"' in page


def test_a_case_is_varied_in_the_units_that_were_typed_with_a_figure_for_each_key():
    vary = ["--vary", "speed = 3.6 km/h, 7.2 km/h", "--vary", "ball.load=5 N,0.006 kN", "--vary", "seed=1"]
    said = call("study", "small.toml", *vary, "--workers", "1").stdout
    out = Path("runs/small")
    found = columns(out / "study.csv")
    assert sorted(set(found["speed [km/h]"])) == ["3.6", "7.2"]
    assert sorted(set(found["ball.load [N]"])) == ["5.0", "6.0"]  # the unit of the first value
    assert "speed [km/h]" in said
    with xr.open_dataset(out / "study.nc", engine="h5netcdf") as table:
        assert table["speed"].values.tolist() == pytest.approx([1.0, 2.0])
        assert table["speed"].attrs["units"] == "m/s"
        assert table["completed"].values.all()
        assert np.ptp(table["rms_force"].values[..., 0]) > 0.0
    page = (out / "study.html").read_text(encoding="utf-8")
    figures = re.findall('<figure id="(.*?)" class="chart">', page)
    assert figures == [
        "key-speed",
        "bands-speed",
        "key-ball.load",
        "bands-ball.load",
    ]  # of one seed there is nothing to draw
    assert '<td class="number">3.6</td>' in page  # without a script its numbers are read
    assert not (out / "study_mean.csv").exists()
    call("study", "small.toml", "--vary", "ball.load = 5 N", "-o", "one", "--workers", "1")
    alone = Path("one/study.html").read_text(encoding="utf-8")
    assert "1 value of ball.load" in alone
    assert 'id="numbers"' in alone  # where there is nothing to draw there are numbers


def test_columns_and_figures_are_those_that_are_asked_for(out):
    """With the words of --show, bands too."""
    said = call(*AGAIN, "--show", "rms_force, force_level", "--json").stdout
    titles = {title.split()[0] for title in json.loads(said)["columns"]}
    assert titles == {"seed", "ball.load", "law", "rms_force", "force_level"}
    said = call(*AGAIN, "--show", "mean_force").stdout
    assert "mean force [N]" in said
    assert "peak" not in said


def test_an_earlier_study_stays_whole_until_all_is_there_that_replaces_it(out, monkeypatch):
    before = {file.name: file.read_bytes() for file in out.iterdir()}
    full = Mock(side_effect=OSError(errno.ENOSPC, "No space left"))
    monkeypatch.setattr("asperity.cli.studying._summary", full)
    assert "out could not be written: the disk is full" in call(*AGAIN, code=3).stderr
    assert {file.name: file.read_bytes() for file in out.iterdir()} == before


def test_another_study_is_never_overwritten_unasked(out):
    before = (out / "study.nc").stat().st_mtime_ns
    call(*AGAIN)
    assert (out / "study.nc").stat().st_mtime_ns > before
    Path("study.toml").write_text(STUDY.replace("[1, 2, 3, 4, 5, 6, 7, 8]", "[1, 2]"))
    assert "out: received the study.nc of another study" in call(*AGAIN, code=2).stderr
    Path("out/study.nc").write_text("precious")
    assert "out: received the study.nc of another study" in call(*AGAIN, code=2).stderr
    assert Path("out/study.nc").read_text() == "precious"
    call(*AGAIN, "--overwrite")
    with xr.open_dataset("out/study.nc", engine="h5netcdf") as found:
        assert found.sizes["seed"] == 2


def test_a_study_of_which_all_members_fail_has_failed():
    Path("study.toml").write_text('case = "case.toml"\n[sweep]\n"beam.height" = ["1 um", "2 um"]\n')
    told = call(*AGAIN, code=3).stderr
    assert told.splitlines()[-1].startswith("Error: all 2 members failed, the first one so: ")
    assert told.strip().endswith("Try: one of them with 'asperity run'.")
    assert "Traceback" not in told


VARIANTS = """
case = "small.toml"
[sweep]
"ball.load" = ["5 N", "10 N"]
[sweep.variant."twice as fast"]
speed = "times 2"
[sweep.variant."calm"]
surface.level = "minus 30 dB"
[sweep.variant."=so already"]
speed = "times 1"
"""


def test_variants_are_told_by_what_they_do():
    """A table for each place on the other keys, in words, in a file and for programs."""
    Path("study.toml").write_text(VARIANTS)
    outcome = call(*AGAIN)
    told = words_of(outcome.stdout)
    assert "What each change does, the quietest first, ball.load = 5 N" in told
    assert "=so already – Left out: nothing changes: the case is so already." in told
    assert "Failed" not in outcome.stderr
    found = columns("out/effects.csv")
    assert found["variant"][::2] == ["calm", "twice as fast", "'=so already"]
    assert found["ball.load [N]"] == ["5.0", "10.0"] * 3
    assert (numbers(found["effect [dB]"])[:2] < -10.0).all()
    page = Path("out/study.html").read_text(encoding="utf-8")
    assert re.findall('<figure id="(.*?)" class="chart">', page) == ["key-ball.load", "bands-ball.load"]
    assert 'id="effects-2"' in page
    again = json.loads(call(*AGAIN, "--json").stdout)
    words = again["in_words"]["ball.load = 5 N"]
    assert [each.split(" dB ")[-1] for each in words.values()][:2] == ["down.", "up."]
    assert again["sweep"]["variant"]["calm"] == {"surface.level": "minus 30 dB"}
    Path("study.toml").write_text(VARIANTS.replace("30 dB", "10 dB"))
    assert "the study.nc of another study" in call(*AGAIN, code=2).stderr


@pytest.mark.parametrize(
    "asked",
    [
        ("case.toml", "--vary", "seed = 1, 2", "--draw", "speed = 0.8..1.2 m/s"),
        ("study.toml",),
    ],
)
def test_a_page_tells_how_its_study_is_made_again(asked):
    """The command that stands there computes the same, in a folder that holds the files that stand there."""
    Path("case.toml").write_text(SMALL)
    variants = 'case = "case.toml"\n[sweep.variant.slow]\nspeed = "times 0.8"\n"ball.load" = "6 N"\n'
    Path("study.toml").write_text(variants)
    call("study", *asked, "-o", "out", "--workers", "1")
    made_again(Path("out/study.html"), Path("again"), "-o", "out", "--workers", "1")
    for first in Path("out").glob("*.csv"):
        assert first.read_bytes() == (Path("again/out") / first.name).read_bytes()


def test_variants_of_a_case_that_fails_are_compared_with_nothing():
    Path("study.toml").write_text(VARIANTS.replace('["5 N", "10 N"]', '["1 MN"]') + "ball.load = '5 N'")
    outcome = call(*AGAIN)
    assert "Failed (3 of 4 members)" in outcome.stderr
    assert "What each change does" not in outcome.stdout
    assert "rms force" in words_of(outcome.stdout)


def test_the_ready_list_is_a_study():
    Path("rail.toml").write_text(RAIL)
    said = call("new", "what-helps").stdout
    Path("helps.toml").write_text(said.replace("case.toml", "rail.toml"))
    listed = load_study("helps.toml").sweep
    assert defined(Path("rail.toml"), ["seed = 1, 2, 3"], (), helps=True).sweep == listed


@pytest.mark.long
def test_a_run_says_what_helps_and_finds_it_again(monkeypatch):
    case = changed("wheel-on-rail", laws=["linear"], numerics={"highest_frequency": "2 kHz"})
    Path("rail.toml").write_text(case.to_toml())
    plan = study_of(case, {"variant": {"a fifth slower": {"speed": "times 0.8"}}})
    monkeypatch.setattr("asperity.studies.effects.what_helps", lambda case: plan)
    call("run", "rail.toml", "-o", "out")
    assert "What helps?" not in Path("out/report.html").read_text(encoding="utf-8")
    told = words_of(call("run", "rail.toml", "-o", "out", "--what-helps").stdout)
    assert re.search(
        r"What each change does, the quietest first .* a fifth slower −\d\.\d.* in dB\(A\) re 1 pW; below,",
        told,
    )
    assert "What helps?" in Path("out/report.html").read_text(encoding="utf-8")
    found = asperity.open_result("out")["effects"]
    assert float(found["effect"].sel(radiator="total", variant="a fifth slower")) < 0.0
    again = call("run", "rail.toml", "-o", "out", "--what-helps")
    assert "Nothing to do" in again.stderr
    assert words_of(again.stdout) == told
