"""Materials by numbers, wherever a name may stand."""

import json

import numpy as np
import pytest

import asperity
from asperity.case.cases import as_case, parse_case
from asperity.errors import CaseError
from asperity.reference.materials import MATERIALS, Material, contact_modulus
from asperity.studies.definition import study_of

pytestmark = pytest.mark.usefixtures("own_cache")

CASE = {
    "kind": "ball-on-beam",
    "duration": "4 ms",
    "laws": ["hertz"],
    "surface": {"spectrum": "iso3095"},
    "ball": {"material": "glass", "load": "5 N"},
    "beam": {"material": "aluminium"},
}
ALUMINIUM = {"youngs_modulus": "70 GPa", "poisson_ratio": 0.3, "density": "2.7 g/cm^3"}
TOML = '{ youngs_modulus = "70 GPa", poisson_ratio = 0.3, density = "2.7 g/cm^3" }'


def with_beam_of(material):
    return CASE | {"beam": {"material": material}}


def test_numbers_of_a_named_material_are_that_material():
    named, own = asperity.run(CASE), asperity.run(with_beam_of(ALUMINIUM))
    assert own["rolling"].to_dataset().equals(named["rolling"].to_dataset())
    assert own["contact"].attrs["contact_modulus"] == pytest.approx(
        1 / ((1 - 0.2**2) / 70e9 + (1 - 0.3**2) / 70e9), rel=1e-12
    )


def test_stiffness_and_density_both_count():
    """1/E* adds compliances; a beam's natural frequencies go with the root of E/rho."""
    usual = asperity.run(CASE)
    heavy = asperity.run(with_beam_of(ALUMINIUM | {"density": "27 g/cm^3"}))
    assert heavy["contact"].attrs["contact_modulus"] == usual["contact"].attrs["contact_modulus"]
    assert not np.allclose(heavy["rolling/acceleration"], usual["rolling/acceleration"])


def test_titles_and_parameters_name_them():
    assert asperity.run(CASE).attrs["title"] == "Glass ball on an aluminium beam"
    found = asperity.run(with_beam_of(ALUMINIUM))
    assert found.attrs["title"] == "Glass ball on a 70 GPa beam"
    rows = {p["key"]: p for p in json.loads(found["scenario"].attrs["parameters"])}
    assert rows["beam.material"]["value"] == "youngs_modulus 70 GPa, poisson_ratio 0.3, density 2700 kg/m^3"
    assert not rows["beam.material"]["is_default"]
    brass = {"name": "brass", "youngs_modulus": "100 GPa", "poisson_ratio": 0.34, "density": "8500 kg/m^3"}
    assert asperity.run(with_beam_of(brass)).attrs["title"] == "Glass ball on a brass beam"


@pytest.mark.parametrize(
    "text",
    [
        f"[beam]\nmaterial = {TOML}\n",
        '[beam.material]\nyoungs_modulus = "70 GPa"\npoisson_ratio = 0.3\ndensity = "2.7 g/cm^3"\n',
    ],
)
def test_a_case_file_has_them_in_braces_or_below(text):
    case = parse_case(f'kind = "ball-on-beam"\n[surface]\nrms = "1 um"\n{text}')
    found = case.beam.material
    assert (found.youngs_modulus, found.poisson_ratio) == (70e9, 0.3)
    assert found.density == pytest.approx(2700.0)


def test_python_may_hand_a_material_over():
    brass = Material("brass", 100e9, 0.34, 8500.0)
    case = as_case(CASE).with_(beam={"material": brass})
    assert (case.beam.material.name, case.beam.material.density) == ("brass", 8500.0)
    assert contact_modulus(case.ball.material, case.beam.material) < contact_modulus(
        MATERIALS["glass"], MATERIALS["steel"]
    )


def test_a_study_may_sweep_them():
    plan = study_of(CASE, {"beam.material": ["aluminium", ALUMINIUM | {"density": "3 g/cm^3"}]})
    first, second = plan.members()
    assert first.case.beam.material == MATERIALS["aluminium"]
    assert second.case.beam.material.density == pytest.approx(3000.0)
    assert first.key != second.key
    assert plan.axes[0].coordinate.tolist() == [
        "aluminium",
        "youngs_modulus 70 GPa, poisson_ratio 0.3, density 3 g/cm^3",
    ]
    assert "beam.material = youngs_modulus 70 GPa" in second.label


def test_all_that_is_wrong_is_said_at_once():
    wrong = {"youngs_modulus": "70", "poison_ratio": 0.3, "poisson_ratio": 0.6, "name": ""}
    with pytest.raises(CaseError) as caught:
        as_case(with_beam_of(wrong))
    errors = caught.value.errors
    assert len(errors) == 5
    text = "\n".join(errors)
    for message in (
        "beam.material.poison_ratio: received an unknown key; allowed: name, youngs_modulus, poisson_ratio, "
        'density, citation. Did you mean "poisson_ratio"?',
        "beam.material.youngs_modulus: received '70'; allowed: a pressure greater than 0",
        "beam.material.poisson_ratio: received 0.6; allowed: a number greater than -1 and at most 0.5.",
        'beam.material.density: received nothing; allowed: a density greater than 0, with its unit, as "2700',
        "beam.material.name: received ''; allowed: a text in quotes.",
    ):
        assert message in text
    with pytest.raises(CaseError, match=r'received \[\].*or numbers: \{ youngs_modulus = "72 GPa"'):
        as_case(with_beam_of([]))
