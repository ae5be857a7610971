"""What a case will compute, before it is computed."""

from __future__ import annotations

import sys

from asperity.config import Case, WheelOnRailCase
from asperity.errors import InputError
from asperity.progress import duration

SOLVE_TIME = 2e-7  # s per grid cell of one contact solution on one core, in order of magnitude
STEP_TIME = 3e-6  # s per time step of one compiled law, in order of magnitude


def show_plan(case: Case, source: str) -> None:
    """Print the values of a case, and what will be computed from it.

    Parameters
    ----------
    case : BallOnBeamCase or WheelOnRailCase
        The case.
    source : str
        Its file.
    """
    from rich.console import Console
    from rich.table import Table

    measured = [*_measured(case), *_measured_lines(case)]
    console = Console(file=sys.stdout)
    if not console.is_terminal:
        console.width = 120
    values = Table(title=f"{source}: a valid case", title_justify="left")
    for heading in ("key", "value", "default", "what it is"):
        values.add_column(heading)
    for item in case.parameters():
        default = "" if item["is_default"] else item["default"] or "none"
        style = None if item["is_default"] else "bold"
        values.add_row(item["key"], item["value"], default, item["note"], style=style)
    console.print(values)
    work = Table(title="What will be computed", title_justify="left", show_header=False)
    for name, value in [*measured, *plan(case)]:
        work.add_row(name, value)
    console.print(work)


def plan(case: Case) -> list[tuple[str, str]]:
    """List what will be computed and how much work it is.

    Parameters
    ----------
    case : BallOnBeamCase or WheelOnRailCase
        The case.

    Returns
    -------
    list of (str, str)
        Name and value, with units.
    """
    from asperity.scenarios.reducing import STATES

    contact = case.contact
    states = STATES if contact.approaches is None else len(contact.approaches)
    settling = case.settling if isinstance(case, WheelOnRailCase) else 0.0
    length = (settling + case.rolled_time) * case.speed
    positions = round(length / contact.spacing) + 1
    steps = round((settling + case.rolled_time) / case.time_step)
    where = f"{length:g} m from {case.start - settling * case.speed:g} m"
    run_in = f", and {settling:g} s before it" if settling else ""
    solves = _solves(case, states, positions, steps)
    seconds = sum(solves.values()) * contact.cells**2 * SOLVE_TIME + steps * len(case.laws) * STEP_TIME
    return [
        ("path", f"{where}, {positions} positions {contact.spacing * 1e6:g} µm apart"),
        ("time", f"{case.rolled_time:g} s{run_in}, {steps} steps of {case.time_step * 1e6:.4g} µs"),
        *_track(case),
        ("laws", ", ".join(case.laws)),
        (
            "contact",
            f"{contact.cells} × {contact.cells} cells, {contact.samples} samples, {states} approaches",
        ),
        *((f"contact solutions, {name}", f"at most {count}") for name, count in solves.items() if count),
        ("work", f"in the order of {duration(seconds)} on one core, less what the cache holds"),
    ]


def _solves(case: Case, states: int, positions: int, steps: int) -> dict[str, int]:
    """Contact solutions by what they are for."""
    contact = case.contact
    strip = 8 * contact.window if contact.sample_length is None else contact.sample_length
    scanned = max(1, round((strip - contact.window) / contact.spacing))
    return {
        "stiffness and filters": contact.samples * states * scanned if _is_reduced(case) else 0,
        "table": states * positions if "table" in case.laws else 0,
        "direct": 3 * steps if "direct" in case.laws else 0,  # two or three iterations in each time step
    }


def _is_reduced(case: Case) -> bool:
    """Whether stiffness and filters are reduced from rough samples."""
    return isinstance(case, WheelOnRailCase) or case.surface.has_samples


def _track(case: Case) -> list[tuple[str, str]]:
    """Characteristic numbers of the track."""
    if not isinstance(case, WheelOnRailCase):
        return []
    track = case.track_model()
    frequencies = f"pinned–pinned {track.pinned_pinned_frequency:.4g} Hz, sleeper passing"
    passing = f"{case.speed / track.sleeper_spacing:.4g} Hz, critical speed {track.critical_speed:.4g} m/s"
    points = ", ".join(f"{position:g} m" for position in case.point_positions)
    return [("track", f"{frequencies} {passing}"), ("rail motion recorded at", points)]


def _measured(case: Case) -> list[tuple[str, str]]:
    """Read the measured samples, so that their errors come before the work."""
    surface = case.surface
    if surface.file is None:
        return []
    from asperity.cli.inspecting import described, read

    maps = read(
        surface.file, surface.index, array=surface.array, height_unit=surface.height_unit, pixel=surface.pixel
    )
    smallest = min(min(found.size) if isinstance(found.size, tuple) else found.size for found in maps)
    if smallest < case.contact.window:
        allowed = f"at most the measured map, {smallest * 1e6:.4g} um"
        raise InputError(
            "contact.window", f"{case.contact.window * 1e6:g} um", allowed, "Choose a smaller window."
        )
    return [("samples", described(maps))]


def _measured_lines(case: Case) -> list[tuple[str, str]]:
    """Read the measured lines of rail and wheel, so that their errors come before the work."""
    from asperity.cli.inspecting import described, read

    if not isinstance(case, WheelOnRailCase):
        return []
    found = []
    for name, section in (("lines of the rail", case.surface), ("lines of the wheel", case.wheel)):
        if section.line is not None:
            array, unit, spacing = section.line_array, section.line_unit, section.line_spacing
            lines = read(section.line, array=array, height_unit=unit, pixel=spacing)
            found.append((name, described(lines)))
    return found
