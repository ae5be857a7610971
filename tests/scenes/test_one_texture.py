"""One texture for one seed: what is drawn depends on the spectrum and the seed, on nothing else of a case."""

import numpy as np
import pytest

import asperity
from asperity.reporting.comparison_page import compared_blocks, summary
from asperity.running import prepare_case
from asperity.scenes.report import comparison_of
from small_cases import changed

KEPT = {"surface": {"rms": "0.1 um", "longest": "0.4 mm", "shortest": "60 um"}}
SPECTRUM = np.array([[10.0 ** (-n / 10.0), -25.0 - n + 27] for n in range(27, 38)])
"""Bands of 2 mm to 0.2 mm."""


def case(kind="ball-on-beam", **keys):
    return changed(kind, **({"laws": ["linear"], "contact": {"samples": 1, "window": None}} | keys))


@pytest.mark.parametrize(
    ("kind", "sizes", "keys"),
    [
        ("ball-on-beam", ("0.2 um", "0.4 um"), {"ball": {"load": "1 N"}, "contact": {"spacing": "8 um"}}),
        (
            "wheel-on-rail",
            ("40 um", "80 um"),
            {
                "wheel": {"roughness": None},
                "contact": {"spacing": "1 mm"},
                "duration": "20 ms",
                "settling": "40 ms",
            },
        ),
    ],
)
def test_twice_the_rms_is_six_decibels_more_by_the_linear_law(kind, sizes, keys):
    """20 lg 2 = 6.02 dB in every band, but for what is left of the start, though another window is chosen."""
    keys["contact"] |= {"window": None, "samples": 1, "sample_length": None}
    soft, loud = (case(kind, surface={"rms": rms}, **keys) for rms in sizes)
    assert soft.contact.window < loud.contact.window
    found = comparison_of([asperity.run(soft, brief=True), asperity.run(loud, brief=True)])
    level = found.table["force_level_difference"][1, 0].values
    np.testing.assert_allclose(level[np.isfinite(level)], 20.0 * np.log10(2.0), atol=0.02)
    assert "another texture" not in summary(found)


def line_from_start(of, **keys):
    """Heights of the line from where the record starts on, and their distance."""
    textures = prepare_case(case(**keys) if of is None else of.with_(**keys)).textures
    return textures.line[textures.recorded], textures


@pytest.mark.parametrize(
    "surface",
    [
        KEPT["surface"],
        {"spectrum": SPECTRUM},
        {"spectrum": SPECTRUM, "lateral": 1.0},
        {"smooth": True},
    ],
    ids=["self-affine", "line", "strip", "corrugation"],
)
def test_window_load_duration_settling_laws_and_samples_change_no_height(surface):
    if "smooth" in surface:
        surface = {"corrugation": "1 um", "corrugation_wavelength": "1 mm", "corrugation_bandwidth": 0.3}
    base = case(surface=surface, contact={"window": "0.66 mm"})
    expected, _ = line_from_start(base)
    size = np.std(expected)
    assert size > 0.0
    for changes in (
        {"contact.window": "0.7 mm"},
        {"ball.load": "10 N"},
        {"duration": "30 ms"},
        {"settling": "20 ms"},
        {"laws": ["hertz"]},
        {"contact.samples": 3},
        {"speed": "2 m/s", "duration": "10 ms"},
    ):
        found, _ = line_from_start(base, **changes)
        rows = min(len(found), len(expected))
        assert rows >= len(expected) - 1
        np.testing.assert_allclose(found[:rows], expected[:rows], rtol=0, atol=1e-11 * size, err_msg=changes)


@pytest.mark.parametrize("surface", [KEPT["surface"], {"spectrum": SPECTRUM, "lateral": 1.0}])
def test_a_wider_window_and_a_finer_grid_hold_the_path_and_the_samples(surface):
    base = case(surface=surface, contact={"window": "0.5 mm", "spacing": "20 um", "sample_length": "2 mm"})
    narrow, wide = (line_from_start(base, **{"contact.window": each})[1] for each in ("0.5 mm", "0.9 mm"))
    (few, many), middle = (each.path.shape[1] for each in (narrow, wide)), wide.path.shape[1] // 2
    rows = len(narrow.line) - narrow.before
    inner = wide.path.rows(wide.before, wide.before + rows)[:, middle - few // 2 : middle + few // 2 + 1]
    assert few < many
    np.testing.assert_allclose(
        narrow.path.rows(narrow.before, narrow.before + rows), inner, rtol=0, atol=1e-11 * np.std(inner)
    )
    coarse, fine = line_from_start(base)[0], line_from_start(base, **{"contact.spacing": "10 um"})[0]
    kept = fine[::2][: len(coarse)]
    assert np.std(kept - coarse) < 1e-9 * np.std(coarse)


@pytest.mark.parametrize("changes", [{"ball.load": "10 N"}, {"ball.load": "2.5 N"}, {"ball.radius": "50 mm"}])
def test_with_lengths_that_are_chosen_load_and_radius_add_short_waves_at_most(changes):
    base = case(surface={"rms": "0.1 um"}, ball={"load": "5 N"}, contact={"window": None, "spacing": None})
    (expected, one), (found, other) = line_from_start(base), line_from_start(base, **changes)
    assert one.drawn == other.drawn
    places = [
        base.with_(**each).contact.spacing * np.arange(len(line))
        for each, line in (({}, expected), (changes, found))
    ]
    there = places[1] < places[0][-1]
    assert np.corrcoef(np.interp(places[1][there], places[0], expected), found[there])[0, 1] > 0.999


def test_around_a_wheel_the_circumference_is_all_that_counts():
    turns, spectrum = [], SPECTRUM * [50.0, 1.0]
    for spacing, window in (("1 mm", "16 mm"), ("0.5 mm", "20 mm")):
        keys = {"contact": {"spacing": spacing, "window": window}, "wheel": {"roughness": spectrum}}
        base = case("wheel-on-rail", surface={"smooth": True}, duration="20 ms", **keys)
        textures = prepare_case(base).textures
        turns.append(textures.parts["wheel"][textures.recorded])
    coarse, fine = turns
    rows = min(len(coarse), len(fine[::2]))
    # whole cells share the circumference out: places differ by a part in 10,000
    assert np.std(fine[::2][:rows] - coarse[:rows]) < 0.05 * np.std(coarse)


@pytest.fixture(scope="module")
def runs():
    keys = {"contact": {"window": "0.66 mm", "samples": 1}}
    made = {"one": case(**KEPT, **keys), "other seed": case(**KEPT, **keys, seed=2)}
    made["louder"] = case(surface=KEPT["surface"] | {"rms": "0.15 um"}, **keys)
    made["longer waves"] = case(surface=KEPT["surface"] | {"longest": "0.6 mm"}, **keys)
    made["smooth"] = case(surface={"smooth": True}, **keys)
    return {name: asperity.run(each) for name, each in made.items()}


@pytest.mark.parametrize(
    ("name", "another"),
    [("other seed", True), ("longer waves", False), ("louder", False), ("smooth", False), ("one", False)],
)
def test_comparison_says_where_another_texture_was_drawn(runs, name, another):
    found = comparison_of([runs["one"], runs[name]], ["first", name])
    told = "another texture was drawn" in summary(found)
    assert told == another
    tables = {block.name: block for block in compared_blocks(found) if hasattr(block, "rows")}
    changes = [
        cell.text
        for row in tables["force_level_difference"].rows
        for cell in row[1:]
        if cell.text not in ("–", "")
    ]
    assert changes
    bracketed = [text.startswith("(") and text.endswith(")") for text in changes]
    assert all(bracketed) == another or not another
    if another:
        assert all(bracketed)
        assert tables["working_point"].rows[1][4].text.startswith("(")
        assert "another texture" in tables["force_level_difference"].note
    else:
        assert not bracketed[-1]  # the total is not in brackets
