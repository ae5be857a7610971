"""Maps of the force of a contact: closed form, the law of a case, and files by a reader of its own."""

import numpy as np
import pytest
import xarray

from asperity.case.cases import as_case
from asperity.laws import HertzLaw
from asperity.laws.layout import force
from asperity.scenarios.force_map import force_map, law_of, write_force_map
from refusals import refusals
from small_cases import BALL

HERTZ = HertzLaw(2e9, None)
APPROACHES = np.array([-1e-6, 0.0, 0.5e-6, 2e-6, 3e-6])
SMOOTH = {"kind": "ball-bearing", "radial": "100 N", "laws": ["hertz"], "bearing": {"name": "6205"}}
POSITIONS = np.array([0.0, 1e-3, 4e-3])


def read_csv(path, approach, position):
    """What docs/method/read_force_map.m does: F^(2/3) is bilinear between the points."""
    heading, *lines = path.read_text().splitlines()
    assert "," not in heading
    numbers = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    assert numbers[0, 0] == 0.0
    positions, approaches = numbers[0, 1:], numbers[1:, 0]
    straight = np.abs(numbers[1:, 1:]) ** (2 / 3)
    across = [np.interp(position, positions, row) for row in straight]
    return np.interp(approach, approaches, across) ** 1.5


def test_a_map_of_a_smooth_contact_is_the_closed_form_in_both_files(tmp_path):
    found = force_map(HERTZ, POSITIONS, APPROACHES)
    assert (found.dims, found.shape, found.attrs["units"]) == (("approach", "position"), (5, 3), "N")
    closed = 2e9 * np.maximum(APPROACHES, 0.0) ** 1.5
    np.testing.assert_allclose(found.values, np.repeat(closed[:, None], 3, axis=1), rtol=1e-9, atol=1e-12)
    csv, nc = (write_force_map(found, tmp_path / f"map.{ending}") for ending in ("csv", "nc"))
    assert read_csv(csv, 1.1e-6, 2e-3) == pytest.approx(2e9 * 1.1e-6**1.5)
    with xarray.open_dataset(nc, engine="h5netcdf") as data:
        np.testing.assert_array_equal(data["force"].values, found.values)
        assert data["approach"].attrs["long_name"] == "approach of the mean surfaces, positive closing"
        assert (data["position"].attrs["units"], data["force"].attrs["units"]) == ("m", "N")


def test_a_rough_law_has_its_force_at_each_position_and_approach(tmp_path):
    """Rows are approaches and columns positions, as they are written."""
    case = as_case(BALL)
    law = law_of(case, "areal")
    at = case.start + np.array([0.0, 0.3e-3, 0.8e-3])
    found = force_map(case, at, APPROACHES, law="areal")
    assert found.attrs["law"] == "areal"
    assert np.ptp(found.values[-1]) > 0.01  # it is rough
    for n, approach in enumerate(APPROACHES):
        np.testing.assert_allclose(found.values[n], force(law, at, approach), rtol=1e-12)
    path = write_force_map(found, tmp_path / "map.csv")
    assert read_csv(path, APPROACHES[3], at[1]) == pytest.approx(found.values[3, 1], rel=1e-9)


def test_of_a_bearing_it_is_the_ball_on_a_raceway():
    case = as_case(SMOOTH)
    (inner, _), (outer, _) = case.contacts
    for ring, contact in (("inner", inner), ("outer", outer)):
        found = force_map(SMOOTH, [0.0, 1e-2], [0.0, 2e-6, 5e-6], ring=ring)
        smooth = contact.stiffness_constant * np.array([0.0, 2e-6, 5e-6]) ** 1.5
        assert found.attrs["law"] == "hertz"
        np.testing.assert_allclose(found.values[:, 1], smooth, rtol=1e-9)


test_what_is_no_map_is_refused = refusals(
    (lambda: force_map(HERTZ, [0.0, 0.0], [0.0]), "positions (m): received values that do not rise"),
    (lambda: force_map(HERTZ, [0.0], [1.0, 0.0]), "approaches (m): received values that do not rise"),
    (lambda: force_map(HERTZ, np.arange(4e3), np.arange(4e3)), "16000000 forces; allowed: at most 10000000"),
    (lambda: force_map(BALL, [0.5], [0.0], law="ariel"), 'Did you mean "areal"?'),
    (
        lambda: force_map(SMOOTH, [0.0], [0.0], ring="middle"),
        "ring: received 'middle'; allowed: one of",
    ),
    (lambda: write_force_map(force_map(HERTZ, [0.0], [0.0]), "map.txt"), "a name that ends in .nc or .csv"),
)
