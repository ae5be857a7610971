"""Materials by numbers, wherever a name may stand."""

import numpy as np
import pytest

from asperity.case.cases import as_case, parse_case
from asperity.errors import CaseError
from asperity.reference.materials import MATERIALS
from asperity.studies.definition import study_of

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


def test_numbers_of_a_named_material_act_as_that_material():
    """1/E* adds compliances; a beam's natural frequencies go with the root of E/rho."""
    named, own, heavy = (
        as_case(with_beam_of(material))
        for material in ("aluminium", ALUMINIUM, ALUMINIUM | {"density": "10.8 g/cm^3"})
    )
    modulus = 1 / ((1 - 0.2**2) / 70e9 + (1 - 0.3**2) / 70e9)
    for case in (named, own, heavy):
        assert case.smooth_contact.modulus == pytest.approx(modulus, rel=1e-12)
    usual, same, slower = (case.beam.model(5e3).natural_frequencies for case in (named, own, heavy))
    np.testing.assert_array_equal(same, usual)
    np.testing.assert_allclose(slower[: len(usual)], 0.5 * usual, rtol=1e-12)


def test_titles_and_parameters_name_them():
    brass = {"name": "brass", "youngs_modulus": "100 GPa", "poisson_ratio": 0.34, "density": "8500 kg/m^3"}
    own = as_case(with_beam_of(ALUMINIUM))
    titles = [case.title for case in (as_case(CASE), own, as_case(with_beam_of(brass)))]
    assert titles == [f"Glass ball on {beam} beam" for beam in ("an aluminium", "a 70 GPa", "a brass")]
    row = next(row for row in own.parameters() if row["key"] == "beam.material")
    assert row["value"] == "youngs_modulus 70 GPa, poisson_ratio 0.3, density 2700 kg/m^3"
    assert not row["is_default"]


def test_a_case_file_has_them_in_braces_or_below():
    below = '[beam.material]\nyoungs_modulus = "70 GPa"\npoisson_ratio = 0.3\ndensity = "2.7 g/cm^3"\n'
    for text in (f"[beam]\nmaterial = {TOML}\n", below):
        found = parse_case(f'kind = "ball-on-beam"\n[surface]\nrms = "1 um"\n{text}').beam.material
        assert found == as_case(with_beam_of(ALUMINIUM)).beam.material


def test_a_study_may_sweep_them():
    plan = study_of(CASE, {"beam.material": ["aluminium", ALUMINIUM | {"density": "3 g/cm^3"}]})
    first, second = plan.members()
    assert first.case.beam.material == MATERIALS["aluminium"]
    assert second.case.beam.material.density == pytest.approx(3000.0)
    assert first.key != second.key
    own = "youngs_modulus 70 GPa, poisson_ratio 0.3, density 3 g/cm^3"
    assert plan.axes[0].coordinate.tolist() == ["aluminium", own]
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
