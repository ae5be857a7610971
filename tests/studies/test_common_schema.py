"""Labelled sets in the common schema of bearing-datasets: by its rules, by the package, nothing twice."""

import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from executors import Here

import asperity
from asperity.case.cases import as_case
from asperity.errors import ShortRecordWarning
from asperity.studies.common_schema import OWN, recording_of
from asperity.studies.definition import load_study
from asperity.studies.recorded import read_record
from asperity.studies.signals import SignalSet
from refusals import refusals
from small_cases import BEARING

RULES = json.loads((Path(__file__).parent / "data" / "bearing_datasets_schema.json").read_text())
"""Columns and words of version 0.3.0 of the package, which is under the MIT licence."""
HEALTHY = {**BEARING, "fault": {}, "sensors": ["0 deg", "90 deg"], "duration": "50 ms"}
SIZE = {"fault.length": "0.3 mm", "fault.depth": "0.1 mm"}
PARTS = {"outer": "outer", "inner": "inner", "ball": "rolling_element"}
SWEEP = {"variant": {part: SIZE | {"fault.on": part} for part in PARTS}}


@pytest.fixture(autouse=True)
def kept_members(tmp_path_factory, monkeypatch):
    """Members are rolled once for all tests."""
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path_factory.getbasetemp() / "common"))


def rows_of(**keys):
    case = as_case(HEALTHY | {"duration": "0.3 s"} | keys)
    signal = np.arange(8.0).reshape(2, 4)
    return recording_of(Path("set/signals/part-abc.parquet"), case, signal)


FAULTS = [{}, *({"on": part, "length": "1 mm", "depth": "0.1 mm"} for part in PARTS)]
BOTH = [
    {"on": part, "length": f"{n} mm", "depth": "0.1 mm"}
    for n, part in enumerate(("ball", "outer", "outer"), 1)
]


@pytest.mark.parametrize("fault", [*FAULTS, BOTH])
def test_rows_keep_the_rules_of_the_schema(fault):
    rows, channels = rows_of(fault=fault)
    assert [len(each) for each in channels] == [row["n_samples"] for row in rows] == [4, 4]
    for row in rows:
        filled = row | {"dataset": "set", "native_label": "x", "noise": "none", "path": "none"}
        assert set(RULES["required"]) <= set(filled)
        assert set(filled) - set(RULES["required"]) - set(RULES["optional"]) <= set(OWN)
        assert not any(value is None or value != value for value in filled.values())
        for name, words in RULES["vocabularies"].items():
            values = row[name].split("+") if name in RULES["joined"] else [row[name]]
            assert set(values) <= set(words), name
        assert row["unit"] in RULES["units"][row["quantity"]]
        parts = row["fault_type"].split("+")
        places = row["fault_location"].split("+")
        assert (parts == ["normal"]) == (places == ["none"])
        assert len(parts) == len(places)
        assert row["sensor_at_fault"] == (parts != ["normal"])
    assert len({row["signal_id"] for row in rows}) == len(rows)


def test_a_fault_on_a_ball_has_a_class_and_several_faults_are_joined():
    ((ball, *_), _), ((several, *_), _) = rows_of(fault=FAULTS[3]), rows_of(fault=BOTH)
    assert (ball["fault_type"], ball["fault_size_mm"]) == ("rolling_element", 1.0)
    assert (several["fault_type"], several["fault_location"]) == (
        "rolling_element+outer",
        "test_bearing+test_bearing",
    )
    assert several["fault_size_mm"] == 3.0


def test_a_fault_on_a_roller_is_one_on_a_rolling_element():
    sizes = {"rollers": 12, "roller_diameter": "7.5 mm", "roller_length": "9 mm", "pitch_diameter": "39 mm"}
    keys = {
        "kind": "roller-bearing",
        "bearing": sizes,
        "fault": {"on": "roller", "length": "1 mm", "depth": "0.1 mm"},
    }
    case = as_case({name: value for name, value in HEALTHY.items() if name != "laws"} | keys)
    ((row, *_), _) = recording_of(Path("part-a.parquet"), case, np.ones((2, 4)))
    told = [
        row[name]
        for name in ("fault_type", "bearing_model", "bearing_elements", "bearing_element_diameter_mm")
    ]
    assert told == ["rolling_element", "12 rollers of 7.5 mm on 39 mm", 12, pytest.approx(7.5)]


def test_orders_are_those_of_the_geometry_with_the_spin_of_the_ball_once():
    ((row, *_), _) = rows_of(fault=FAULTS[1])
    ratio = 7.94 / 39.04
    expected = 4.5 * (1 - ratio), 4.5 * (1 + ratio), 0.5 * (1 - ratio**2) / ratio, 0.5 * (1 - ratio)
    assert [row[name] for name in ("bpfo", "bpfi", "bsf", "ftf")] == pytest.approx(expected, rel=1e-9)
    told = [row[name] for name in ("speed_rpm", "speed_profile", "load", "load_unit", "bearing_model", "fs")]
    assert told == [pytest.approx(1800.0), "constant", 100.0, "N", "6205", 51_200.0]


@pytest.mark.parametrize(
    ("speed", "profile", "mean"),
    [
        ("1200..1800 1/min in 1 s", "increasing", 1500.0),
        ("1800..1200 1/min in 1 s", "decreasing", 1500.0),
        ("1200 1/min at 0 s, 1800 1/min at 0.5 s, 1200 1/min at 1 s", "varying", 1500.0),
    ],
)
def test_a_speed_that_changes_has_its_mean_and_a_tacho(speed, profile, mean):
    rows, channels = rows_of(speed=speed, duration="1 s", fault=FAULTS[1])
    assert (rows[0]["speed_profile"], rows[0]["speed_rpm"]) == (profile, pytest.approx(mean))
    tacho = rows[-1]
    told = [tacho[name] for name in ("channel", "quantity", "unit", "sensor_location", "sensor_at_fault")]
    assert told == ["tacho", "speed", "Hz", "rig_shaft", False]
    assert channels[-1][0] * 60.0 == pytest.approx(float(speed.partition(" ")[0].partition("..")[0]))


def written(folder, sweep=SWEEP, case=HEALTHY, format="parquet", **how):
    signals = SignalSet(folder, format, **how)
    asperity.study(case, sweep, executor=Here(), signals=signals)
    with open(f"{folder}/labels.csv", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.usefixtures("opened_apart")
def test_the_package_opens_a_set_and_finds_nothing_wrong():
    datasets = pytest.importorskip("bearing_datasets")
    from bearing_datasets.schema import validate

    labels = written("set", path="1..6 kHz, 2 resonances", noise="0..20 dB")
    opened = datasets.open("set", root=".")
    found = opened.metadata()
    validate(found, opened.manifest["columns"])
    assert sorted(set(found["fault_type"])) == ["inner", "normal", "outer", "rolling_element"]
    assert list(found.groupby("recording_id").size()) == [2] * 4
    assert found["native_label"].tolist()[::2] == [row["variant"] for row in labels]
    plain = written("plain", format="npy", path="1..6 kHz, 2 resonances", noise="0..20 dB")
    for row, other in zip(labels, plain, strict=True):
        recording = opened.recording(Path(row["file"]).stem.removeprefix("part-"), unit="m/s^2")
        np.testing.assert_array_equal(
            np.transpose(list(recording.values())), np.load(f"plain/{other['file']}")
        )
    name = f"{Path(row['file']).stem.removeprefix('part-')}/sensor_90_deg"
    read = read_record(Path("set") / row["file"], 51_200.0, array=name)
    np.testing.assert_array_equal(read.values, recording["sensor_90_deg"])


def test_the_stored_rules_are_those_of_the_package():
    schema = pytest.importorskip("bearing_datasets.schema")
    assert RULES["schema_version"] == schema.SCHEMA_VERSION
    assert set(RULES["required"]) == set(schema.REQUIRED)
    assert set(RULES["optional"]) == set(schema.OPTIONAL)
    assert {name: set(words) for name, words in RULES["vocabularies"].items()} == schema.VOCABULARIES


def test_a_set_holds_no_signal_twice():
    sweep = {"variant": {"outer": SWEEP["variant"]["outer"]}, "seed": "1..2"}
    with pytest.warns(ShortRecordWarning, match=r"2 signals of 4 are left out of the set"):
        labels = written("set", sweep, format="npy", noise="0..20 dB")
    assert [row["variant"] for row in labels] == ["as it is", "outer"]
    assert {path.name for path in Path("set").glob("*.npy")} == {row["file"] for row in labels}
    slips = written("slips", {"seed": sweep["seed"]}, HEALTHY | {"cage_slip": [0.0, 0.02]}, "npy")
    signals = {np.load(f"slips/{row['file']}").tobytes() for row in slips}
    assert len(signals) == len(slips) == 2


def test_the_ten_lines_of_the_page_are_a_study_of_eighty_different_cases(tmp_path):
    page = Path(__file__).parents[2] / "docs" / "bearings" / "labelled_sets.md"
    (lines,) = re.findall(r"```toml\n(.*?)```", page.read_text(), re.S)
    (tmp_path / "set.toml").write_text(lines)
    study = load_study(tmp_path / "set.toml")
    assert study.shape == (20, 4)
    assert set(study.drawn) == {"speed", "radial", "fault.length", "fault.angle"}
    few = replace(study, axes=(replace(study.axes[0], written=(1,), values=(1,)), study.axes[1]))
    members = few.members()
    assert [member.case.fault.on for member in members] == [None, *PARTS]
    assert len({member.key for member in members}) == 4


def without_pyarrow(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    SignalSet("set", "parquet")


test_what_writes_parquet_has_to_be_installed = refusals(
    (r'received parquet; allowed: it with the package pyarrow. Install it: .*"asperity\[parquet\]"',),
    of=without_pyarrow,
)
