"""What a case will compute, before it is computed."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from asperity.config import Case, WheelOnRailCase
from asperity.errors import InputError
from asperity.progress import duration

if TYPE_CHECKING:
    from asperity.scenarios.expecting import Expected

STEP_TIME = 3e-6  # s per time step of one compiled law, in order of magnitude
SOLUTIONS_PER_STEP = 3  # of `direct`: two or three iterations in each time step
ANNOUNCED = 60.0  # s of a scan that is announced before it starts


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
    from asperity.scenarios.expecting import direct_time, expected_scans
    from asperity.scenarios.reducing import STATES

    contact = case.contact
    states = STATES if contact.approaches is None else len(contact.approaches)
    settling = case.settled_time
    length = (settling + case.rolled_time) * case.speed
    points = round(length / contact.spacing) + 1
    steps = round((settling + case.rolled_time) / case.time_step)
    where = f"{length:g} m from {case.rolled_range[0]:g} m"
    run_in = f", and {settling:g} s before it" if settling else ""
    scans = expected_scans(case)
    solves = {f"scan for the {name}": scan.solutions for name, scan in scans.items()}
    seconds = sum(scan.seconds for scan in scans.values()) + steps * len(case.laws) * STEP_TIME
    if "direct" in case.laws:
        solves["direct"] = SOLUTIONS_PER_STEP * steps
        seconds += solves["direct"] * direct_time(case)
    return [
        ("path", f"{where}, {points} points {contact.spacing * 1e6:g} µm apart"),
        ("time", f"{case.rolled_time:g} s{run_in}, {steps} steps of {case.time_step * 1e6:.4g} µs"),
        *_track(case),
        ("laws", ", ".join(case.laws)),
        (
            "contact",
            f"{contact.cells} × {contact.cells} cells, {contact.samples} samples, {states} approaches",
        ),
        *_real_contact(case),
        *((f"contact solutions, {name}", f"at most {count}") for name, count in solves.items()),
        *([("scan of the path", described_scan(scans["path"]))] if "path" in scans else []),
        ("work", f"in the order of {duration(seconds)}, less what the cache holds"),
    ]


def _real_contact(case: Case) -> list[tuple[str, str]]:
    """Expected real contact, and which laws it takes out of their range."""
    from asperity.scenarios.expecting import expected_area_ratio
    from asperity.scenarios.validity import AREA, SCANNED

    ratio = expected_area_ratio(case)
    if ratio is None:
        return []
    text = f"about {100 * ratio:.0f} % of the area of smooth bodies"
    averaged = [law for law in case.laws if law not in SCANNED]
    if ratio < AREA[0] and averaged:
        text += f": below {100 * AREA[0]:.0f} % {', '.join(averaged)} are out of range; take table"
    return [("real contact", text)]


def described_scan(scan: Expected) -> str:
    """Describe the scan of a path: its size, time, disk use, and what an interruption costs.

    Parameters
    ----------
    scan : Expected
        From `asperity.scenarios.expecting`.

    Returns
    -------
    str
        One sentence.
    """
    from asperity.store import Store
    from asperity.threads import thread_count

    root, size = Store().root, f"{scan.bytes / 2**20:.1f} MiB"
    return (
        f"{scan.positions} positions {scan.step * 1e6:.4g} µm apart × {scan.states} approaches, "
        f"solved in {'single' if scan.single else 'double'} precision, "
        f"in the order of {duration(scan.seconds)} on {thread_count()} threads, {size} in {root}; "
        "if interrupted or killed, it goes on after its last finished block"
    )


def announce_scan(case: Case) -> None:
    """Before a long scan of a path starts, say what it takes; refuse one that the disk cannot hold.

    Parameters
    ----------
    case : BallOnBeamCase or WheelOnRailCase
        The case.

    Raises
    ------
    InputError
        If the disk has too little room.
    """
    if "table" not in case.laws:
        return
    from asperity.scenarios.expecting import check_disk, expected_scans
    from asperity.store import Store

    scan = expected_scans(case)["path"]
    check_disk(scan, Store().root)
    if scan.seconds > ANNOUNCED:
        click.echo(f"Scan of the path: {described_scan(scan)}.", err=True)


def _track(case: Case) -> list[tuple[str, str]]:
    """Characteristic numbers of the track."""
    if not isinstance(case, WheelOnRailCase):
        return []
    from asperity.rolling.loss_factors import warn_of_loss_factors
    from asperity.scenarios.rail_losses import described_losses, expected_error_of_losses

    track, losses = case.track_model(), expected_error_of_losses(case)
    warn_of_loss_factors(losses)
    frequencies = f"pinned–pinned {track.pinned_pinned_frequency:.4g} Hz, sleeper passing"
    passing = f"{case.speed / track.sleeper_spacing:.4g} Hz, critical speed {track.critical_speed:.4g} m/s"
    points = ", ".join(f"{position:g} m" for position in case.point_positions)
    return [
        ("track", f"{frequencies} {passing}"),
        *described_losses(losses, case.wheel.load),
        ("rail motion recorded at", points),
    ]


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
