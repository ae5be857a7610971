"""A bearing with oil: its films in check, result and report; rings are nearer by them, and softer."""

import json
import math

import numpy as np
import pytest

from asperity.case.cases import as_case
from asperity.contact.film import Film, asperity_share
from asperity.contact.hertz import Hertz
from asperity.running import prepare_case
from asperity.scenarios.prepared_bearing import expected, prepare_bearing
from asperity.scenarios.raceway_films import RacewayFilm, rms_within
from asperity.scenes.computed_bearing import compute_bearing
from asperity.scenes.figures.bearing import ball_films, films_table
from asperity.schema import Entry, bearing, declared
from asperity.structures.ball_bearing import BallBearing
from asperity.studies.member import kept
from asperity.surfaces.raceway import Raceway

OF_THREE = {
    "kind": "ball-bearing", "axial": "60 N", "speed": "6000 1/min", "laws": ["hertz"], "duration": "50 ms",
    "settling": "5 ms", "contact_damping": "40 N s/m", "bearing": {
        "balls": 3, "ball_diameter": "7.94 mm", "pitch_diameter": "39.04 mm", "contact_angle": "20 deg"
    },
}  # fmt: skip
OIL = {"lubricant": {"oil": "ISO VG 68"}}
WAVE = 50e-9


@pytest.fixture(scope="module")
def films(runs):
    """A run with oil, of which nothing vibrates."""
    return runs(OF_THREE | OIL)


def test_a_study_keeps_films_and_does_without(films, runs):
    of = kept(films)
    assert of["heaviest_film"].values == pytest.approx(films["bearing/heaviest_film"].values)
    assert {"heaviest_film", "heaviest_film_parameter"} & {*kept(runs(OF_THREE)).variables} == set()


def test_films_are_those_of_the_formula_under_the_loads_of_the_balls(films):
    case = as_case(OF_THREE | OIL)
    found = films["bearing"].to_dataset()
    for ring, film, damping in zip(("inner", "outer"), case.films, case.dampings, strict=True):
        of = found.sel(ring=ring)
        load = float(of["ball_load"].max())
        assert of["film_thickness"].values == pytest.approx(film.central(load), rel=1e-6)
        assert of["least_film"].values == pytest.approx(film.minimum(load), rel=1e-6)
        assert float(of["heaviest_film"]) == pytest.approx(film.central(load))
        assert float(of["film_stiffness"]) == pytest.approx(film.stiffness(load))
        assert (float(of["film_damping"]), float(of["film_heating"])) == (damping, film.reduction)
        assert float(of["asperity_share"]) == float(of["film_roughness"]) == 0.0
        assert np.isnan(of["film_parameter"]).all()
    assert "both surfaces are smooth" in found["film_parameter"].attrs["missing"]
    assert found.attrs["oil_viscosity"] == case.films[0].viscosity
    assert found.attrs["left_out"] == BallBearing.LEFT_OUT_OILED
    of_oil = (each for each in declared(bearing) if each.condition == bearing.OILED)
    units = {each.name: each.units for each in of_oil if isinstance(each, Entry)}
    assert units == {name: found[name].attrs["units"] for name in units}
    assert BallBearing.LEFT_OUT_OILED in films.attrs["verdict"]
    rows = json.loads(films["contact"].attrs["validity"])
    (row,) = (each for each in rows if "on the inner ring" in each["quantity"])
    assert row["value"].startswith("U 1.")
    assert row["grade"] == "note"
    assert "ASTM D341" in str(films.attrs["citations"])


def test_a_page_has_films_and_one_without_oil_has_none(films):
    table = films_table(films)
    assert [cell.text for cell in table.rows[0]][:1] == ["inner ring"]
    assert "17.3 mPa s" in table.note
    panel = ball_films.drawn(films).chart.panels[0]
    inner = films["bearing"]["film_thickness"].values[0].max()
    assert max(panel.marks[0].y) == pytest.approx(1e9 * inner)
    dry = prepare_case(as_case(OF_THREE))
    assert dict(expected(dry)[0])["not in it"] == BallBearing.LEFT_OUT
    assert not [name for name, _ in expected(dry)[0] if "film" in name]


def test_rings_under_a_load_are_nearer_by_the_films_of_both_contacts(films):
    """Balls under an axial load: the inner ring stands back by (h_i + h_o)/sin α of the contact angle."""
    prepared = prepare_bearing(as_case(OF_THREE))
    run = compute_bearing(prepared, lambda *_: None).runs["hertz"]
    oiled = films["rolling"]["ring_motion"].sel(direction="axial").values[0]
    moved = np.mean(run.inner_motion[2] - run.outer_motion[2]) - np.mean(oiled[0] - oiled[1])
    apart = float(films["bearing"]["heaviest_film"].sum())
    assert moved == pytest.approx(apart / math.sin(prepared.case.static.contact_angle), rel=0.02)


def wavy(rows, lines, amplitude, period=16.0):
    """Waves along a raceway, of so many cells each, m."""
    heights = amplitude * np.cos(2.0 * np.pi * np.arange(rows) / period)
    return Raceway(np.repeat(heights[:, None], lines, axis=1), (2e-6, 4e-6))


def test_of_a_wave_four_contacts_long_a_quarter_from_its_mean_is_left():
    left = math.sqrt(0.5 - 4.0 / math.pi**2)
    assert rms_within(wavy(1600, 9, WAVE, 64.0), (16e-6, 8e-6)) == pytest.approx(WAVE * left, rel=0.01)


def test_roughness_of_both_surfaces_counts_within_the_contact():
    """Of waves A/√2 each; asperities carry what they do on a period of it, pressed by the solver."""
    contact = Hertz(115e9, 3e-3, 30e-3)
    load = 8.0
    film = Film(contact, 1.0, 2e-3, 15e-9)
    along, across = contact.semi_axes(contact.approach(load))
    surfaces = wavy(1600, 201, WAVE), wavy(1600, 201, 0.5 * WAVE)
    found = RacewayFilm(film, load, surfaces, 1.0)
    assert rms_within(surfaces[0], (along, across)) == pytest.approx(WAVE / math.sqrt(2.0), rel=0.05)
    assert found.rms == pytest.approx(WAVE * math.sqrt(0.625), rel=0.05)
    assert found.parameter == pytest.approx(film.minimum(load) / found.rms)
    assert found.regime == "boundary"
    period = wavy(16, 5, 1.5 * WAVE).heights
    alone = asperity_share(period, (2e-6, 4e-6), 115e9, film.central(load), load / (math.pi * along * across))
    assert 0.0 < found.share == pytest.approx(alone, rel=0.25)
    assert f"Λ {found.parameter:.2g}"[:4] in found.in_words
    assert "boundary, asperities carry" in found.in_words
    assert [each.split()[0] for each in found.outside] == ["W"]
