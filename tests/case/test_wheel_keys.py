"""Keys of a drawn wheel: what its section may be, what overrides it, and what is refused."""

import re

import numpy as np
import pytest

from asperity.case.bodies import WheelOnRail
from asperity.case.cases import as_case, read_case
from asperity.errors import CaseError, OutOfRangeWarning
from asperity.reference.railways import SECTIONS
from asperity.scenarios.geometry import geometry_of
from asperity.structures.outline import WheelSection, checked_outline, doubts_of
from refusals import refusals

TEXTURE = {"spectrum": "iso3095"}
MODES = np.array([[1950.0, 3e-4, 330.0, 2, 0.8, 0.7]])
NUMERICS = {"highest_frequency": 400.0}
"""So that few modes are sought."""


def wheel_on_rail(numerics=NUMERICS, **wheel):
    return WheelOnRail(surface=TEXTURE, wheel=wheel, numerics=numerics)


def outline_file(tmp_path, outline, heading="radius (mm), axial place (mm)"):
    rows = "\n".join(f"{r * 1e3!r}, {z * 1e3!r}" for r, z in np.asarray(outline).tolist())
    path = tmp_path / "outline.csv"
    path.write_text(f"{heading}\n{rows}\n")
    return path


def test_a_named_section_and_its_outline_in_millimetres_have_the_same_modes(tmp_path):
    named = wheel_on_rail(section="curved-web").rolling
    path = outline_file(tmp_path, named.outline)
    surface = 'kind = "wheel-on-rail"\n[surface]\nspectrum = "iso3095"\n'
    (tmp_path / "case.toml").write_text(f'{surface}[wheel]\nsection = "outline.csv"\n')
    drawn = read_case(tmp_path / "case.toml").rolling
    assert drawn.section == path
    assert drawn.outline == pytest.approx(named.outline, rel=1e-12)
    expected = named.standing_modes(400.0).table()
    assert drawn.standing_modes(400.0).table() == pytest.approx(expected, rel=1e-6)
    assert len(expected) > 2


def test_dimensions_override_the_named_section():
    thick = wheel_on_rail(section="straight-web", web_thickness="40 mm")
    drawn = WheelSection.named("straight-web", web_thickness=0.04).outline(0.46)
    assert thick.rolling.outline == pytest.approx(drawn)
    told = {each["key"]: each["value"] for each in thick.parameters()}
    assert told["wheel.web_thickness"] == "40 mm"
    assert told["wheel.web_thickness_rim"] == f"{1e3 * SECTIONS['straight-web']['web_thickness_rim']:g} mm"
    assert thick.rolling.drawn_mass > wheel_on_rail(section="straight-web").rolling.drawn_mass
    rigid = {each["key"] for each in wheel_on_rail(section="rigid").parameters()}
    assert not {"wheel.web_thickness", "wheel.modal_damping"} & rigid


def test_damping_is_that_of_the_nodal_diameters_and_of_dampers():
    modes = wheel_on_rail(section="curved-web", modal_damping=[2e-3, 2e-2, 3e-4], added_damping=5e-3)
    found = modes.rolling.standing_modes(400.0)
    expected = [(2e-3, 2e-2, 5.3e-3)[min(n, 2)] for n in found.nodal_diameters]
    assert found.damping_ratios == pytest.approx(expected)


def test_modes_go_up_to_a_quarter_beyond_the_highest_frequency():
    found = wheel_on_rail(section="curved-web").rolling.standing_modes(1000.0)
    more = wheel_on_rail(section="curved-web").rolling.standing_modes(1300.0)
    assert found.natural_frequencies.max() <= 1250.0
    assert np.sum(more.natural_frequencies <= 1250.0) == len(found.natural_frequencies)


def test_modes_that_nobody_hears_are_not_sought(monkeypatch):
    monkeypatch.setattr("asperity.structures.wheel_modes.HIGHEST", 600.0)
    found = wheel_on_rail(section="curved-web").rolling.standing_modes(1e5)
    assert 300.0 < found.natural_frequencies.max() <= 600.0


def test_a_rigid_wheel_and_a_ball_have_no_modes():
    assert wheel_on_rail(section="rigid").rolling.standing_modes(400.0) is None
    assert as_case({"kind": "bodies", "over": "beam", "surface": {"smooth": True}}).rolling.section == "rigid"
    # a table without nodal diameters stays as it is, and does not turn
    frequency, _, mass = wheel_on_rail(modes=MODES[:, :3]).rolling.resonances(400.0, 56.0)
    assert (frequency == MODES[0, 0]).all()
    assert (mass == MODES[0, 2]).all()


def test_a_table_with_nodal_diameters_turns_with_the_wheel():
    frequency, _, mass = wheel_on_rail(modes=MODES).rolling.resonances(5e3, 46.0)
    turning = 2 * 46.0 / 0.46 / (2.0 * np.pi)
    assert frequency == pytest.approx([1950.0 - turning, 1950.0 + turning], rel=1e-6)
    assert mass == pytest.approx([660.0 * 1950.0 / f for f in frequency], rel=1e-6)


def rectangle(radius):
    return np.array([[0.1, -0.05], [radius, -0.05], [radius, 0.05], [0.1, 0.05]])


MIRRORED = WheelSection.named("curved-web").outline(0.46) * [1.0, -1.0]


test_what_does_not_fit_is_refused = refusals(
    ({"section": "curved-web", "modes": MODES}, "both section and modes"),
    ({"section": "curved"}, 'Did you mean "curved-web"?'),
    ({"section": "rigid", "web_thickness": "20 mm"}, "only together with section"),
    ({"section": "rigid", "added_damping": 0.01}, "only together with section"),
    ({"section": "curved-web", "radius": "0.15 m"}, "allowed: bore, hub and rim one outside"),
    ({"section": "curved-web", "mass": "200 kg"}, "that of the drawn wheel"),
    ({"section": rectangle(0.3)}, "a running circle of 300 mm"),
    ({"section": rectangle(0.92)}, "Are the radii of the section diameters? Then halve them."),
    (
        {"section": rectangle(0.42), "radius": "0.84 m"},
        'Then write radius = "420 mm".',
    ),
    ({"section": MIRRORED}, "a flange at an axial place of 47.6 mm.*Change their sign"),
    ({"section": rectangle(0.46), "web_bend": "1 mm"}, "only together with"),
    ({"section": rectangle(0.46)[[0, 2, 1, 3]]}, "that touch"),
    of=lambda wheel: wheel_on_rail(**wheel),
    error=CaseError,
)


def drawn_in(heading, tmp_path):
    outline = WheelSection.named("curved-web").outline(0.46)
    return wheel_on_rail(section=outline_file(tmp_path, outline, heading))


test_files_in_other_units_or_orders_are_refused = refusals(
    ("radius (m), axial place (m)", "a point 488 m away"),
    ("radius, axial place", "a heading with the units in brackets"),
    ("axial place (mm), radius (mm)", "Exchange the columns"),
    of=drawn_in,
    error=CaseError,
)


def with_web(depth):
    """An outline of hub, web and rim whose web of 30 mm goes to and fro by a depth, m."""
    r = np.arange(0.2, 0.401, 0.02)
    middle = depth * np.resize([1.0, -1.0], len(r))
    outer, inner = (np.stack([r, middle + side], axis=1) for side in (0.015, -0.015))
    rim = [(0.4, 0.06), (0.46, 0.06), (0.46, -0.06), (0.4, -0.06)]
    hub = [(0.2, -0.06), (0.1, -0.06), (0.1, 0.06), (0.2, 0.06)]
    return np.vstack([outer, rim, inner[::-1], hub])


@pytest.mark.parametrize("bend", [-0.4, 0.4, 0.2])
def test_a_web_that_leaves_hub_and_rim_is_told(bend):
    """By what it bends, less what the faces of the hub, 175 mm wide, leave to it on its side."""
    section = WheelSection.named("straight-web", web_bend=bend)
    (told,) = doubts_of(checked_outline(section.outline(0.46)), 0.46)
    beside = float(re.search(r"by ([\d.]+) mm along the axle", told)[1]) * 1e-3
    half = 0.5 * max(section.hub_width, section.rim_width)
    least = abs(bend) + 0.5 * section.web_thickness_rim - half
    assert least - 0.01 < beside < abs(bend)
    with pytest.warns(OutOfRangeWarning, match="stands out of hub and rim"):
        geometry_of(wheel_on_rail(section="straight-web", web_bend=bend, mass="1 t"))
    bent = WheelSection.named("straight-web", web_bend=0.08).outline(0.46)
    assert not list(doubts_of(checked_outline(bent), 0.46))


def test_a_web_that_zigzags_and_a_diameter_for_a_radius_are_told_and_no_named_section_is():
    for name in SECTIONS:
        assert not list(doubts_of(checked_outline(WheelSection.named(name).outline(0.46)), 0.46))
    assert not list(doubts_of(checked_outline(with_web(0.0)), 0.46))
    assert "turns to and fro" in "".join(doubts_of(checked_outline(with_web(8e-3)), 0.46))
    large = 2.0 * WheelSection.named("straight-web").outline(0.46)
    assert any("Is it the diameter" in told for told in doubts_of(checked_outline(large), 0.92))
    for section in ("rigid", "straight-web"):
        with pytest.warns(OutOfRangeWarning, match=r"radius.*920 mm.*Is it the diameter"):
            geometry_of(wheel_on_rail(section=section, radius="0.92 m", mass="3 t"))
