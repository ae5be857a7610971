"""Every number of a case has limits of what is plausible, with a reason."""

import math

import pytest

from asperity.case import PRESETS
from asperity.case.cases import case_class, case_of
from asperity.case.describing import entries
from asperity.errors import CaseError
from asperity.units import quantity
from asperity.values import ListOf, Number, Quantity

NUMBERS = [
    pytest.param(kind, entry, id=f"{kind} {entry.dotted}")
    for kind in PRESETS
    for entry in entries(case_class(kind))
    if isinstance(entry.key.one, Quantity | Number)
]


def limits(entry):
    """Least and largest value in SI, and the unit; those of the kind, where it has both."""
    kind = entry.key.one
    unit = kind.dimension if isinstance(kind, Quantity) else ""
    if entry.key.within is not None:
        low, high, reason = entry.key.within
        assert len(reason) > 10
        return *(quantity(v, unit) for v in (low, high)), unit
    return kind.above if kind.at_least is None else kind.at_least, kind.at_most, unit


@pytest.mark.parametrize(("kind", "entry"), NUMBERS)
def test_every_number_has_limits(kind, entry):
    low, high, _ = limits(entry)
    assert -math.inf < low < high < math.inf


@pytest.mark.parametrize(("kind", "entry"), NUMBERS)
def test_numbers_beyond_their_limits_are_told_with_a_reason(kind, entry):
    if entry.key.within is None:
        pytest.skip("its kind has limits of its own")
    low, high, unit = limits(entry)
    _, _, reason = entry.key.within
    section, _, name = entry.dotted.rpartition(".")
    for value in (1.01 * high, low / 1.01 if low > 0 else 1.01 * low):
        if value == 0.0:
            continue
        given = f"{value!r} {unit}" if unit else value
        several = isinstance(entry.key.kind, ListOf)
        keys = {name: [given] if several else given}
        texture = {"surface": {"smooth": True} if kind == "wheel-on-rail" else {"rms": "0.3 um"}}
        case = {"kind": kind, **texture, **({section: keys} if section else keys)}
        with pytest.raises(CaseError) as caught:
            case_of(case)
        message = str(caught.value)
        own = "; allowed: a" in message  # its kind, as a length greater than 0, is stricter
        assert entry.dotted in message
        assert own or reason[1:] in message


def test_the_message_names_value_limits_and_reason():
    with pytest.raises(CaseError) as caught:
        case_of({"kind": "ball-on-beam", "surface": {"rms": "1e20 m"}})
    assert (
        "surface.rms: received 1e+20 m; allowed: 1 pm to 1 mm. Less is smoother than atoms are, more is no "
        "roughness." in str(caught.value)
    )


def test_an_own_material_is_held_to_solids():
    material = {"youngs_modulus": "1 Pa", "poisson_ratio": 0.3, "density": "1 t/mm^3"}
    with pytest.raises(CaseError) as caught:
        case_of({"kind": "ball-on-beam", "ball": {"material": material}})
    assert "youngs_modulus: received 1 Pa; allowed: 1 kPa to 10 TPa" in str(caught.value)
    assert "density: received 1e+12 kg/m^3; allowed: 1 kg/m^3 to 100000 kg/m^3" in str(caught.value)
