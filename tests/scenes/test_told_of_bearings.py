"""What the first screen of a bearing says: at which sensor it is heard, and which part makes most of it."""

import json

import numpy as np
import pytest

import asperity
from asperity.cli.running import law_summaries
from asperity.scenes.bearing import _most_of
from asperity.scenes.figures.bearing import bands_table, bearing_answers
from asperity.scenes.report import page_of
from small_cases import BEARING

SENSORS = {"sensors": ["90 deg", "0 deg", "45 deg"], "duration": "50 ms"}
PARTS = ["perfect surfaces", "the inner raceway", "the balls"]


@pytest.fixture(scope="module")
def tree():
    return asperity.run(BEARING | SENSORS)


def test_one_of_several_accelerometers_is_named_and_the_loudest_beside_it(tree):
    """The pit lies below the load, at zero degrees, where it is struck."""
    velocity = tree["bearing/band_velocity"].values[0]
    assert velocity[1, 2] > 1.5 * velocity[0, 2]
    told = bearing_answers(tree)
    assert told.lead.startswith("Radial velocity at 90° by hertz: ")
    for number, of_sensors in zip(told.numbers, velocity.T, strict=False):
        assert number.value == f"{1e6 * of_sensors[0]:.3g} µm/s"
        note = "rms radial velocity, outer ring, at 90°"
        if loudest := int(of_sensors.argmax()):
            note += f"; at most {1e6 * of_sensors[loudest]:.3g} µm/s at {(90, 0, 45)[loudest]}°"
        assert number.note == note
    assert law_summaries(tree)[0]["band_velocity"] == velocity[0].tolist()
    assert "at most" in page_of(tree, summary=True)


def test_velocities_of_parts_alone_have_their_scatter(tree):
    """Of the fault alone it is that of the whole, as nothing else is rough."""
    whole = tree["bearing/band_velocity_deviation"].values[0, 0]
    np.testing.assert_allclose(tree["bearing/alone_velocity_deviation"].values[1], whole, rtol=1e-9)
    shown = dict(zip(bands_table(tree).head, zip(*bands_table(tree).rows, strict=True), strict=True))
    cells = [cell.text for cell in shown["± by chance, 1800 to 10000 Hz"]]
    assert cells[0] == cells[-1] != "–"


@pytest.mark.parametrize(
    ("squares", "by_chance", "told"),
    [
        ([1.0, 51.0, 48.0], 0.03, "51 % from the inner raceway and 48 % from the balls, equal within chance"),
        ([1.0, 48.0, 51.0], 0.03, "51 % from the balls and 48 % from the inner raceway, equal within chance"),
        ([1.0, 71.0, 31.0], 0.02, "69 % from the inner raceway"),
        ([1.0, 71.0, 31.0], 0.5, "69 % from the inner raceway and 30 % from the balls, equal within chance"),
        ([5.0, 4.0, 5.0], 0.0, "100 % from perfect surfaces"),
    ],
)
def test_parts_nearer_than_the_scatter_of_the_record_are_equal_within_chance(squares, by_chance, told):
    squares = np.array(squares)
    assert _most_of(PARTS, squares, by_chance * squares) == f" ({told})"


def test_nothing_is_most_of_nothing():
    assert _most_of(PARTS, np.zeros(3), np.zeros(3)) == ""


def test_one_accelerometer_needs_no_name():
    alone = asperity.run(BEARING | {"duration": "50 ms"}, brief=True)
    assert bearing_answers(alone).lead.startswith("Radial velocity by hertz: ")
    assert {each.note for each in bearing_answers(alone).numbers[:3]} == {"rms radial velocity, outer ring"}
    assert json.loads(alone["contact"].attrs["validity"])
