"""``asperity wheel``: modes by a section, in words, as a table, and drawn."""

from pathlib import Path

import numpy as np

from asperity.case.bodies import WheelOnRail
from asperity.case.tables import read_mode_table
from asperity.structures.outline import WheelSection
from command_line import call

LOW = ("--highest", "400 Hz")


def modes_of(**wheel):
    case = WheelOnRail(surface={"smooth": True}, wheel=wheel)
    return case.rolling.standing_modes(400.0).table()


def outline(path, scale=1e3):
    rows = scale * WheelSection.named("bent-web").outline(0.42)
    path.write_text("radius (mm), axial place (mm)\n" + "\n".join(f"{r!r}, {z!r}" for r, z in rows.tolist()))


def test_modes_of_a_named_section_are_told_and_written():
    told = call("wheel", "straight-web", *LOW, "-o", "modes.csv", "--picture", "section.svg").stdout
    expected = modes_of(section="straight-web")
    assert f"{len(expected)} modes" in told
    assert f"{expected[0, 0]:.1f}" in told
    assert (read_mode_table(Path("modes.csv")) == expected).all()
    assert Path("section.svg").read_text(encoding="utf-8").lstrip().startswith("<?xml")


def test_modal_masses_are_told_along_both_directions():
    """Where the web bends the axial one is the small one: 1/shape² of mass-normalised shapes."""
    told = call("wheel", "straight-web", *LOW).stdout
    case = WheelOnRail(surface={"smooth": True}, wheel={"section": "straight-web"})
    modes = case.rolling.standing_modes(400.0)
    rows = [line.split() for line in told.splitlines() if line.startswith("  ")]
    columns = rows[0].index("radial/kg"), rows[0].index("axial/kg")
    found = np.array([[float(row[k]) for k in columns] for row in rows[1:]])
    radial, axial = (each[modes.heard()] for each in modes.at())
    np.testing.assert_allclose(found, np.stack([radial**-2.0, axial**-2.0], axis=1), rtol=1e-3)
    assert found[0, 1] < 0.2 * found[0, 0]


def test_an_outline_brings_its_radius():
    outline(Path("outline.csv"))
    call("wheel", "outline.csv", *LOW, "-o", "modes.csv")
    expected = modes_of(section="bent-web", radius=0.42)
    np.testing.assert_allclose(read_mode_table(Path("modes.csv")), expected, rtol=1e-6)


def test_a_case_brings_dimensions_and_damping():
    Path("case.toml").write_text(
        'kind = "wheel-on-rail"\n[surface]\nsmooth = true\n[wheel]\nsection = "straight-web"\n'
        'web_thickness = "40 mm"\nadded_damping = 0.02\n'
    )
    call("wheel", "case.toml", *LOW, "-o", "modes.csv")
    expected = modes_of(section="straight-web", web_thickness=0.04, added_damping=0.02)
    assert (read_mode_table(Path("modes.csv")) == expected).all()


def test_an_outline_of_diameters_or_with_its_flange_on_the_field_side_is_told():
    outline(Path("diameters.csv"), scale=2e3)
    assert "Is it the diameter" in call("wheel", "diameters.csv", *LOW).stderr
    rows = 1e3 * WheelSection.named("bent-web").outline(0.42) * [1.0, -1.0]
    np.savetxt("mirrored.csv", rows, delimiter=",", header="radius (mm), axial place (mm)", comments="")
    refused = call("wheel", "mirrored.csv", *LOW, code=2)
    assert "allowed: places positive away from the flange. Change their sign" in refused.stderr


def test_a_wheel_without_a_mode_below_the_highest_frequency_is_refused():
    told = call("wheel", "straight-web", "--highest", "1 Hz", code=2).stderr
    assert "highest frequency: received 1 Hz; allowed: one with a mode below it. Raise it" in told
