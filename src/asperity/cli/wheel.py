"""The modes of a wheel by its section: in words, as a table that a case names, and as a picture."""

from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.case import cases, tables
from asperity.case.bodies import WheelOnRail
from asperity.errors import InputError, OutOfRangeWarning
from asperity.reference.materials import material
from asperity.reference.railways import SECTIONS
from asperity.reporting.chart import BLUE, Axis, Chart, Panel, Shape
from asperity.reporting.figure import write_chart
from asperity.structures.body import GRAVITY
from asperity.structures.outline import checked_outline, doubts_of, volume_of
from asperity.structures.wheel_modes import with_running_circle
from asperity.terminal import say
from asperity.written_numbers import count_of, rounded

COLUMNS = ("Hz", "n", "damping", "radial/kg", "axial/kg", "axial", "radial")


def show_wheel(section: str, highest: str | None, table: Path | None, picture: Path | None) -> None:
    """Print the modes of a wheel, and write and draw them where that is asked for.

    `section` is a named one, the path of an outline, or that of a case whose wheel is drawn; `highest` the
    upper end of the spectra, with its unit, that of the case by default.
    """
    case = _case_of(section)
    if highest is not None:
        case = case.with_(numerics={"highest_frequency": highest})
    wheel = case.rolling
    if not wheel.is_drawn:
        raise InputError("wheel.section", "a wheel that is not drawn", "a section, which has modes")
    for doubt in doubts_of(checked_outline(wheel.outline), wheel.radius):
        OutOfRangeWarning.warn(doubt)
    modes = wheel.standing_modes(case.numerics.highest_frequency)
    rows = modes.table()
    if not len(rows):
        received = f"{case.numerics.highest_frequency:g} Hz"
        allowed = "one with a mode below it"
        raise InputError("highest frequency", received, allowed, "Raise it with --highest.")
    say(f"{section}: {rounded(wheel.drawn_mass, 4)} kg without its axle, held at a radius of "
        f"{1e3 * wheel.outline[:, 0].min():.4g} mm; {count_of(len(rows), 'mode')} under a radial force up to "
        f"{rows[:, 0].max():.0f} Hz.")  # fmt: skip
    say("Radial and axial modal mass at the contact; axial motion of the disc and radial motion of the "
        "tread, rms per radial motion at the contact:")  # fmt: skip
    say("  {:>8} {:>3} {:>9} {:>10} {:>10} {:>7} {:>7}".format(*COLUMNS))
    shapes = np.abs(modes.at()[1][modes.heard()])
    for (frequency, ratio, mass, n, axial, radial), shape in zip(rows, shapes, strict=True):
        masses = f"{mass:10.4g} {shape**-2.0 if shape > 0.0 else np.inf:10.4g}"
        say(f"  {frequency:8.1f} {n:3.0f} {ratio:9.2g} {masses} {axial:7.2f} {radial:7.2f}")
    if table is not None:
        modes.write(table)
        say(f"Table, for wheel.modes: {table.resolve()}")
    if picture is not None:
        write_chart(_chart(wheel.outline), f"Section of a wheel, {section}", picture)
        say(f"Picture: {picture.resolve()}")


def _case_of(section: str) -> Any:
    """A wheel on a rail with a section, or a case that has one."""
    if section.endswith(".toml"):
        return cases.of_bodies(cases.read_case(Path(section)), "wheel")
    smooth = {"smooth": True}
    if section in SECTIONS:
        return WheelOnRail(surface=smooth, wheel={"section": section})
    path = Path(section)
    if not path.is_file():
        allowed = f"{', '.join(SECTIONS)}, or the path of an outline or of a case"
        raise InputError("section", f"'{section}'", allowed)
    outline, circle = with_running_circle(tables.read_outline(path))
    heavy = 2.0 * material("steel").density * volume_of(outline)  # with its axle: modes do not ask for it
    wheel = {"section": path, "radius": float(outline[circle, 0]), "mass": heavy, "load": GRAVITY * heavy}
    return WheelOnRail(surface=smooth, wheel=wheel)


def _chart(outline: Array) -> Chart:
    """The section, its axle below."""
    radius, place = 1e3 * np.vstack([outline, outline[:1]]).T
    shape = Shape(place, radius, BLUE, opacity=0.35)
    across = Axis("axial place from the running circle / mm", place.min() - 20.0, place.max() + 20.0)
    outwards = Axis("radius / mm", radius.min() - 20.0, radius.max() + 20.0)
    return Chart((Panel(across, outwards, (shape,), height=7.0, equal=True),))
