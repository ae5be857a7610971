"""What the page shows of runs, against the results they come from and against closed forms."""

import json
import re

import numpy as np
import pytest

from asperity.results import save
from asperity.scenes.report import Result
from asperity.serving.run_view import STRETCH, _about_long_waves, compared_runs, viewed_run
from asperity.serving.worker import answered
from small_cases import BALL


@pytest.fixture(scope="module")
def tree(real_runs):
    return real_runs["ball-on-beam"]


@pytest.fixture(scope="module")
def path(tree, tmp_path_factory):
    return save(tree, tmp_path_factory.mktemp("run") / "run.nc")


def test_the_force_is_watched_sample_by_sample_over_the_texture_that_is_kept(tree, path):
    view = viewed_run(str(path))
    force, rolling = view["force"], tree["rolling"]
    length = float(tree["surface/path_x"][-1])
    count = len(force["distance"])
    assert force["distance"][-1] <= length
    position = rolling["position"].values
    assert count == len(position) or position[count] - position[0] > length
    for law in BALL["laws"]:
        whole = rolling["contact_force"].sel(law=law, contact=1).values
        np.testing.assert_array_equal(force["pieces"][law], whole[:count])
        assert force["range"][law] == [whole[:count].min(), whole[:count].max()]
    assert view["patch"]["load"] == tree["contact"].attrs["working_load"]
    assert [law["name"] for law in view["laws"]] == BALL["laws"]
    assert view["verdict"] == tree.attrs["verdict"]
    assert len(view["warnings"]) == len(json.loads(tree.attrs["warnings"])) > 0
    assert list(json.loads(view["charts"])["charts"]) == ["force_bands", "force_envelope"]
    assert view["blocks"].count('class="plot"') == 2
    assert ".csv" not in view["blocks"]  # no file lies beside this page


def test_long_waves_hide_no_short_ones():
    """A mean over n rows leaves of a wave of k rows 1 − sin(πn/k)/(n sin(π/k))."""
    ny, rows = 21, np.arange(3000)
    n = STRETCH * ny | 1
    for period in (2000, 400, 40):
        wave = np.repeat(np.sin(2 * np.pi * rows / period)[:, None], ny, axis=1)
        left = _about_long_waves(wave)[500:2500]
        kept = 1 - np.sin(np.pi * n / period) / (n * np.sin(np.pi / period))
        assert np.abs(left).max() == pytest.approx(kept, rel=0.05)
    across = np.repeat(np.sin(2 * np.pi * np.arange(ny) / ny)[None], 3000, axis=0)
    np.testing.assert_allclose(_about_long_waves(across), across, atol=1e-12)


def louder(tree, factor, **parameters):
    """The same run with its levels changed by a factor, and some keys of its case."""
    other = Result.of(tree.copy(deep=True))
    other["spectra/force_level"] = other["spectra/force_level"] + 20 * np.log10(factor)
    keys = json.loads(other["scenario"].attrs["parameters"])
    for each in keys:
        each["value"] = parameters.get(each["key"].replace(".", "_"), each["value"])
    other["scenario"].attrs["parameters"] = json.dumps(keys)
    return other


def test_runs_beside_each_other_differ_by_what_they_differ(tree, path, tmp_path):
    second = save(louder(tree, 2.0, speed="3 m/s"), tmp_path / "run.nc")
    found = compared_runs([str(path), str(second)], ["a", "a"])
    assert {"a (1)", "a (2)"} <= set(re.findall(r"a \(\d\)", found["summary"] + found["blocks"]))
    told = re.sub(r"\s*<[^>]+>\s*", " ", found["blocks"])
    assert re.search(r"speed +1 m/s +3 m/s", told)
    assert re.search(r"dB\(A\) +\+6\.0 ", told)
    assert "force_level" in json.loads(found["charts"])["charts"]
    assert "+6.0 dB" in found["summary"]


def test_a_damaged_run_is_refused_in_words(path, tmp_path):
    damaged = tmp_path / "run.nc"
    contents = bytearray(path.read_bytes())
    contents[len(contents) // 2] ^= 255
    damaged.write_bytes(contents)
    told = answered(json.dumps({"question": "view", "path": str(damaged)}))
    assert "a damaged file" in told["refused"][0]


def test_the_report_is_written_beside_its_result(path, monkeypatch):
    written = []
    monkeypatch.setattr(
        "asperity.serving.run_view.report", lambda tree, folder: written.append((tree, folder))
    )
    assert answered(json.dumps({"question": "report", "path": str(path)})) == {}
    ((tree, folder),) = written
    assert folder == path.parent
    assert "rolling" in tree.children
