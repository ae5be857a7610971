"""A bearing whose speed changes: what its result says over angle, over speed, and of what stays."""

import numpy as np
import pytest

import asperity
from asperity.case.cases import as_case
from asperity.diagnostics.orders import RunUp
from asperity.scenes.computed_bearing import cage_slip
from asperity.scenes.report import CHAPTERS, figures_of
from asperity.scenes.run_up import laid_on_speeds
from asperity.schema import bearing
from small_cases import BEARING

RUN_UP = BEARING | {"speed": "3000..4500 1/min in 0.14 s"}
RUN_UP = {name: each for name, each in RUN_UP.items() if name != "duration"}
FIRST, LAST, WHOLE = 50.0, 75.0, 0.14
ORDER = 4.5 * (1.0 - 7.94 / 39.04)
"""Balls that pass the pit in a turn."""


@pytest.fixture(scope="module")
def tree():
    return asperity.run(RUN_UP, brief=True)


def group(tree, name="bearing"):
    return tree[name].to_dataset()


def test_a_tacho_stands_beside_the_signals_and_angles_are_its_integral(tree):
    rolling = group(tree, "rolling")
    time, tacho = rolling["time"].values, rolling["tacho_speed"].values
    assert time[-1] == pytest.approx(WHOLE)
    assert tacho == pytest.approx(FIRST + (LAST - FIRST) * time / WHOLE)
    turned = np.ptp(rolling["ball_azimuth"].values[0]) / (2.0 * np.pi)
    assert turned == pytest.approx(0.5 * (1.0 - 7.94 / 39.04) * 0.5 * (FIRST + LAST) * WHOLE, rel=1e-9)


def test_the_pit_is_found_over_angle_at_its_order(tree):
    """Of nine turns lines are 1/9 of an order wide; over time those at 3.6 in a turn are smeared by 1.2."""
    found = group(tree)
    assert found["lines_found"].values[0].tolist() == [1.0, 0.0, 0.0]
    assert found.attrs["envelope_speed"] == pytest.approx(LAST)
    lines = found["line_frequency"].values[0, 0] / LAST
    assert lines == pytest.approx(ORDER * np.arange(1, 6), abs=0.5 / 8.75)
    assert f"({lines[0] * LAST:.4g} Hz, at the fastest, 4500 1/min)" in tree.attrs["verdict"]
    order, amplitude = found["order"].values, found["order_amplitude"].values[0]
    near = np.abs(order / ORDER - np.round(order / ORDER)) * ORDER
    low = (order > 0.6 * ORDER) & (order < 4.4 * ORDER)
    assert amplitude[low & (near < 0.1)].max() > 5.0 * np.median(amplitude[low & (near > 0.5)])


def test_slip_of_the_cage_is_drawn_at_its_turns_at_any_speed():
    """Over turns of the cage it is that of a constant speed."""
    slips = {"cage_slip": [0.0, 0.1], "settling": "0 s", "duration": "0.5 s"}
    steady, changing = (
        cage_slip(as_case(BEARING | slips | {"speed": each}))
        for each in ("4500 1/min", "3000..4500 1/min in 0.5 s")
    )
    time = np.linspace(0.0, 0.5, 50)
    turns = 50.0 * time + 25.0 * time**2
    assert changing(time) == pytest.approx(steady(turns / 75.0))
    assert np.ptp(changing(time)) > 0.02


def test_pieces_of_one_range_of_speeds_are_their_mean_square_and_lines_of_one_range_the_highest():
    frequency = np.arange(1025.0)
    amplitude = np.array([3.0, 4.0, 1.0])[:, None] * np.where(frequency % 2.0 > 0.0, 1.0, 0.1)
    found = laid_on_speeds(RunUp(np.array([10.0, 10.5, 40.0]), frequency, amplitude), 1023.0)
    assert found[bearing.RUN_UP_SPEED] == pytest.approx([15.0, 25.0, 35.0])
    assert found[bearing.RUN_UP_FREQUENCY][:2] == pytest.approx([0.5, 2.5])
    levels = found[bearing.RUN_UP_AMPLITUDE]
    assert levels[0] == pytest.approx(np.sqrt(12.5))
    assert np.isnan(levels[1]).all()
    assert levels[2] == pytest.approx(1.0)


def test_the_run_up_is_laid_on_speeds_and_drawn(tree):
    found = group(tree)
    speeds = found["run_up_speed"].values
    assert (speeds > FIRST).all()
    assert (speeds < LAST).all()
    assert np.isfinite(found["run_up_amplitude"].values).any(axis=1).sum() > 20
    changing = [each for each in vars(bearing).values() if "speed changes" in getattr(each, "condition", "")]
    assert {each.name for each in changing} <= {*found, *found.coords, *found.attrs}
    chapter = next(each for each in CHAPTERS if each.name == "run_up")
    drawn = {each.name: each for each in figures_of(tree)}
    assert {each.name for each in chapter.figures} <= set(drawn)
    assert "at the fastest, 4500 1/min" in drawn["envelope_spectrum"].caption
    assert "over angle, where lines are narrow" in drawn["envelope_spectrum"].caption
    assert next(iter(drawn["run_up_map"].columns)).startswith("run_up_frequency")


@pytest.mark.parametrize("element", ["ball", "roller"])
def test_orders_have_the_name_of_what_rolls(tree, element):
    told = tree.copy()
    told["bearing"].attrs[bearing.ELEMENT.name] = element
    drawn = {each.name: each for each in figures_of(told)}
    for name in ("order_spectrum", "run_up_map"):
        labels = [mark.label for panel in drawn[name].chart.panels for mark in panel.marks]
        parts = {label.partition(each)[0] for label in labels for each in (":", ",") if each in label}
        assert {"outer raceway", "inner raceway", f"{element}s"} <= parts
