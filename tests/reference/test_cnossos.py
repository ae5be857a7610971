"""Tables of CNOSSOS-EU: their bands, and what is nearest to a case. Their values stand in the ledger."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.reference import cnossos

TABLES = {
    cnossos.rail_roughness: ("iso3095", "cnossos-average"),
    cnossos.wheel_roughness: ("cast-iron", "composite", "disc"),
    cnossos.contact_filter: (
        *("50 kN, 360 mm", "50 kN, 680 mm", "50 kN, 920 mm", "25 kN, 920 mm", "100 kN, 920 mm"),
    ),
    cnossos.track_transfer: ("soft", "medium", "hard"),
    cnossos.wheel_transfer: ("920 mm", "840 mm", "680 mm", "1200 mm"),
}
ENDS = {
    cnossos.rail_roughness: (2.0, 0.8e-3, 35),
    cnossos.wheel_roughness: (1.0, 0.8e-3, 32),
    cnossos.contact_filter: (2.0, 0.8e-3, 35),
    cnossos.track_transfer: (50.0, 10e3, 24),
    cnossos.wheel_transfer: (50.0, 10e3, 24),
}


@pytest.mark.parametrize("table", TABLES)
def test_tables_stand_on_distinct_one_third_octaves(table):
    first, last, count = ENDS[table]
    for name in TABLES[table]:
        coordinate, level = table(name)
        assert coordinate.shape == level.shape == (count,)
        assert_allclose(coordinate[[0, -1]], [first, last])
        exponents = 10 * np.log10(coordinate)
        assert_allclose(exponents, np.rint(exponents), atol=0.11)  # nominal values, at most 2.4 % off
        assert_array_equal(np.abs(np.diff(np.rint(exponents))), 1)


def test_contact_filters_never_amplify_and_fall_with_shorter_waves():
    for name in TABLES[cnossos.contact_filter]:
        values = cnossos.contact_filter(name)[1]
        assert values[0] == 0.0
        assert np.all(np.diff(values) <= 0.0)


@pytest.mark.parametrize(
    ("load", "diameter", "name"),
    [
        (65e3, 0.92, "50 kN, 920 mm"),
        (75e3, 0.92, "100 kN, 920 mm"),  # nearer in the logarithm
        (30e3, 0.84, "25 kN, 920 mm"),
        (50e3, 0.70, "50 kN, 680 mm"),
        (40e3, 0.33, "50 kN, 360 mm"),
    ],
)
def test_nearest_contact_filter(load, diameter, name):
    assert cnossos.nearest_contact_filter(load, diameter) == name
