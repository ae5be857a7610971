import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.reference import cnossos

TRANSCRIPTION = Path(__file__).parents[3] / "shared" / "reference" / "railway_tables.json"
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
ISO_3095 = [  # ISO 3095:2013, upper limit of the rail roughness: cm, dB re 1 um
    *((40.0, 17.1), (31.5, 15.0), (25.0, 13.0), (20.0, 11.0), (16.0, 9.0), (12.5, 7.0), (10.0, 4.9)),
    *((8.0, 2.9), (6.3, 0.9), (5.0, -1.1), (4.0, -3.2), (3.15, -5.0), (2.5, -5.6), (2.0, -6.2)),
    *((1.6, -6.8), (1.25, -7.4), (1.0, -8.0), (0.8, -8.6), (0.63, -9.2), (0.5, -9.8), (0.4, -10.4)),
    (0.315, -11.0),
]


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


def test_rail_roughness_is_the_limit_of_the_standard_where_that_is_given():
    wavelength, level = np.array(ISO_3095).T * [[1e-2], [1.0]]
    table_wavelength, table_level = cnossos.rail_roughness("iso3095")
    assert_allclose(table_wavelength[7:29], wavelength)
    assert_array_equal(table_level[7:29], level)
    assert_array_equal(table_level[:7], 17.1)


@pytest.mark.skipif(not TRANSCRIPTION.exists(), reason="no second transcription of the tables at hand")
def test_tables_agree_with_a_second_transcription():
    other = json.loads(TRANSCRIPTION.read_text())
    assert_allclose(other["wavelength_mm"], 1e3 * cnossos.wavelengths())
    for name, values in other["contact_filter_A3_dB"].items():
        load, diameter = (int("".join(c for c in part if c.isdigit())) for part in name.split("_"))
        assert_array_equal(cnossos.contact_filter(f"{load} kN, {diameter} mm")[1], values)
    rail = other["rail_roughness_dB"]
    assert_array_equal(rail["E_EN_ISO_3095_2013"], cnossos.rail_roughness("iso3095")[1])
    assert_array_equal(rail["M_average_network"], cnossos.rail_roughness("cnossos-average")[1])


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
