"""``asperity fit``: the case found, its table and its page; what stands there already stays."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from asperity.case.cases import read_case
from asperity.scenes.measured import HammerTest
from asperity.structures.track import Track
from command_line import call, words_of

CASE = """\
kind = "wheel-on-rail"
surface.spectrum = "iso3095"
[track]
name = "uic60"
pad_stiffness = "300 MN/m"
pad_loss_factor = 0.2
"""
TRUE = {"pad_stiffness": 420e6, "pad_loss_factor": 0.15}
FIT = ("fit", "track.toml", "--to", "rates.csv", "--free", "track.pad_stiffness", "--free",
       "track.pad_loss_factor = 0.05..0.5", "--starts", "1")  # fmt: skip


@pytest.fixture
def rates():
    """A case, and decay rates of a track with other pads."""
    Path("track.toml").write_text(CASE)
    band = 10.0 ** (0.1 * np.arange(21, 35, 2))
    found = HammerTest.of_track(Track.named("uic60", **TRUE), band).decay_rate
    lines = [f"{at:.0f}, {rate!r}" for at, rate in zip(band, found.tolist(), strict=True)]
    Path("rates.csv").write_text("\n".join(["frequency (Hz), decay rate (dB/m)", *lines]))


def test_it_writes_the_case_a_table_and_a_page(rates):
    told = json.loads(call(*FIT, "--json").stdout)
    values = {each["key"]: each["value"] for each in told["fitted"]}
    assert values == {f"track.{key}": pytest.approx(value, rel=1e-3) for key, value in TRUE.items()}
    assert [each["interval_stops"] for each in told["fitted"]] == [{"least": None, "largest": None}] * 2
    assert set(told["files"]) == {"case", "table", "page"}
    case = read_case("fitted.toml")
    assert case.track.pad_stiffness == values["track.pad_stiffness"]
    text = Path("fitted.toml").read_text()
    assert "# Fitted by asperity" in text
    assert "#   vertical decay rate in rates.csv: 7 values" in text
    assert "# track.pad_stiffness = 420 MN/m (420 MN/m to 420 MN/m), 95 %" in text
    heading, *rows = csv.reader(Path("fitted.csv").read_text().splitlines())
    assert [row[heading.index("quantity")] for row in rows] == ["vertical decay rate"] * 7
    np.testing.assert_allclose([float(row[-1]) for row in rows], 0.0, atol=1e-3)
    page = Path("fitted.html").read_text()
    assert "2 keys fitted to 7 values" in page
    assert "Correlations" in page


def test_repeats_that_differ_in_a_column_are_told(rates):
    lines = [line.split(", ") for line in Path("rates.csv").read_text().splitlines()[1:]]
    wide = ["section," + ",".join(f"{at} Hz" for at, _ in lines)]
    wide += [f"{name}," + ",".join(rate for _, rate in lines) for name in ("B1", "B2")]
    Path("wide.csv").write_text("\n".join(wide))
    asked = [each.replace("rates.csv", "wide.csv") for each in FIT]
    told = json.loads(call(*asked, "--as", "vertical decay rate", "--json").stdout)
    (repeats,) = told["repeats"]
    expected = {"quantity": "vertical decay rate", "source": "wide.csv", "measurements": 2}
    assert repeats == expected | {"differ": {"section": ["B1", "B2"]}}
    sentence = "taken as repeats of one, though they differ in section (B1, B2): choose some of them"
    assert sentence in told["summary"]
    assert sentence in words_of(Path("fitted.html").read_text())
    one = json.loads(
        call(*asked, "--as", "vertical decay rate", "--where", "section=B1", "--overwrite", "--json").stdout
    )
    assert one["repeats"] == []
    assert "repeats" not in one["summary"]


def test_what_is_doubtful_of_the_case_is_said_before_it_is_fitted(rates):
    Path("track.toml").write_text(f"{CASE}[noise]\nreceiver_height = '1.2 mm'\n")
    doubt = "noise.receiver_height = 0.0012 m: receivers stand at 0.1 m to 30 m. Is the unit right?"
    said = call(*FIT, "--json")
    assert f"Warning: {doubt}" in said.stderr
    assert {"grade": "warning", "message": doubt} in json.loads(said.stdout)["warnings"]


def test_a_case_that_no_run_takes_is_fitted_to_what_its_track_alone_decides(rates):
    Path("track.toml").write_text(f"{CASE}[contact]\nwindow = '8 mm'\n")
    assert "contact.window: received 8" in words_of(call("check", "track.toml", code=2).stderr)
    assert json.loads(call(*FIT, "--json").stdout)["warnings"] == []


def test_the_same_fit_replaces_its_own_files_and_no_others(rates):
    call(*FIT, "-o", "out")
    said = call(*FIT, "-o", "out", "-q")
    assert "Left: " in said.stdout
    other = (
        "fit",
        "track.toml",
        "--to",
        "rates.csv",
        "--free",
        "track.pad_stiffness",
        "--starts",
        "1",
        "-o",
        "out",
    )
    refused = call(*other, code=2).stderr
    assert (
        f"{Path('out', 'fitted.toml')}: received one of another fit, or of somebody; allowed: a folder "
        "without fitted.toml, or with that of the same fit. Choose another folder with -o, or replace "
        "fitted.toml with --overwrite."
    ) in refused
    call(*other, "--overwrite")
    Path("fitted.html").write_text("mine")
    assert "fitted.html: received one of another fit" in call(*FIT, code=2).stderr
    assert Path("fitted.html").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("fit", "track.toml"), "what was measured: received nothing; allowed: files, or keys of the case"),
        (("fit", "track.toml", "rates.csv"), "Files of what was measured follow --to."),
        (("fit", "track.toml", "--to", "none.csv"), "none.csv: received no such file"),
        (
            (
                "fit",
                "track.toml",
                "--to",
                "rates.csv",
                "--free",
                "track.pad_stiffness",
                "track.pad_loss_factor",
            ),
            "--to: received 'track.pad_loss_factor', a key of the case; allowed: files of what was measured. "
            "Write --free before each key.",
        ),
        (
            (*FIT, "--as", "colour"),
            "measured quantity: received 'colour'; allowed: one of vertical decay rate",
        ),
        ((*FIT, "--where", "section"), "where: received 'section'; allowed: a column and what it holds"),
    ],
)
def test_it_says_what_is_wrong(rates, arguments, message):
    assert message in call(*arguments, code=2).stderr
    assert not Path("fitted.toml").exists()
