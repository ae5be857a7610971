"""Recipes: what is done to a surface on the command line is done to it in a case."""

import re

import numpy as np
import pytest
from click.testing import CliRunner

from asperity.case.cases import parse_case
from asperity.case.surface import Recipe, read_recipe
from asperity.cli import main
from asperity.errors import CaseError, InputError
from asperity.scenarios.records import read_maps
from asperity.surfaces import heightmap, levelling, rotation
from refusals import refusals

BEGUN = """height_unit = "um"
pixel = "2 um"
transpose = true
spikes = true
fill = true
longest = "0.2 mm"
"""
OPTIONS = [
    *("--crop", "10 um, 20 um, 180 um, 160 um", "--form", "quadratic"),
    *("--longest", "0.1 mm", "--shortest", "8 um", "--direction", "30 deg"),
]


@pytest.fixture
def measured(tmp_path, monkeypatch):
    """A map of µm with a bow, a spike and a hole, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    x, y = np.meshgrid(np.arange(110.0), np.arange(120.0), indexing="ij")
    heights = np.random.default_rng(5).normal(size=x.shape) + 1e-3 * (x - y / 2) ** 2
    heights[50, 40], heights[30, 31] = 500.0, np.nan
    np.save("map.npy", heights)
    return heights


def case(surface):
    return f'kind = "ball-on-beam"\n[surface]\nfile = "map.npy"\n{surface}\n'


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_a_stored_recipe_gives_a_case_the_map_of_the_command_line(measured, tmp_path):
    """Both equal the same steps taken one by one, to the last bit; options are stronger than a recipe."""
    (tmp_path / "begun.toml").write_text(BEGUN)
    arguments = ["surface", "map.npy", "--recipe", "begun.toml", *OPTIONS, "--store", "recipe.toml"]
    said = CliRunner().invoke(main, arguments)
    assert said.exit_code == 0, said.output
    found = read_maps(parse_case(case('recipe = "recipe.toml"'), tmp_path / "case.toml").surface)[0]
    surface = heightmap.HeightMap(measured * 1e-6, (2e-6, 2e-6)).without_spikes().transposed().filled()
    surface = levelling.level(surface.crop((10e-6, 20e-6), (180e-6, 160e-6)), 2)
    expected = rotation.rotated(levelling.band_limit(surface, longest=1e-4, shortest=8e-6), np.radians(30.0))
    assert found.spacing == expected.spacing
    np.testing.assert_array_equal(found.heights, expected.heights)
    points = " × ".join(map(str, expected.shape))
    assert f"a map of {points} points" in said.output
    assert "wavelengths 8 µm to 0.1 mm" in said.output
    rms = float(re.search(r"Sq +([\d.]+) µm", said.output)[1])
    assert rms == pytest.approx(1e6 * levelling.level(expected).heights.std(), rel=1e-3)


def recipe(text, tmp_path):
    (tmp_path / "recipe.toml").write_text(text)
    read_recipe(tmp_path / "recipe.toml")


test_recipes_that_are_wrong = refusals(
    ("crp = 1", "crp: received an unknown key"),
    ('longest = "1 kg"', "longest: received"),
    ("shortest = 8e-6", "shortest: received"),
    ('form = "cone"', 'form: received \'cone\'; allowed: "plane", "quadratic"'),
    ("form =", "no TOML"),
    of=recipe,
    error=(CaseError, InputError),
)


def test_pieces_are_given_by_as_many_lengths_as_they_need():
    line, surface = heightmap.Profile(np.arange(9.0), 1.0), heightmap.HeightMap(np.eye(9), (1.0, 1.0))
    assert Recipe(crop=[2.0, 3.0]).stepped(line).heights.tolist() == [2.0, 3.0, 4.0]
    assert Recipe(crop=[2.0, 3.0, 4.0, 2.0]).stepped(surface).shape == (4, 2)
    with pytest.raises(InputError, match="crop: received 2 lengths; allowed: four of a map"):
        Recipe(crop=[2.0, 3.0]).stepped(surface)
    with pytest.raises(InputError, match="crop: received 4 lengths; allowed: two of a line"):
        Recipe(crop=[2.0, 3.0, 4.0, 2.0]).stepped(line)
