"""The data sheet of a bearing on one page: geometry, load, stiffness over load, tones, bands by part."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from asperity.errors import InputError, PhysicsWarning
from asperity.reference.bearings import LISTED
from asperity.reporting import chart, data
from asperity.reporting.figure import PageFigure
from asperity.reporting.page import Block, figures_page
from asperity.reporting.panels import log_axis
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.scenes.bearing_at_rest import static_group
from asperity.scenes.figures.bearing import ball_contacts_table, bands_table
from asperity.schema import tree
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.roller_bearing import PRINTED, RollerBearing
from asperity.structures.rolling_bearing import PARTS
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from xarray import DataTree

    from asperity.case.loaded_bearing import LoadKeys
    from asperity.structures.bearing_statics import LoadedBearing

FACTORS = np.geomspace(0.1, 4.0, 15)
"""Loads over that of the sheet at which stiffness is told."""
DIRECTIONS = ("along the radial load", "across it", "axially")
COLOURS = (chart.BLUE, chart.GREEN, chart.VERMILLION)
PART_NAMES = {
    "outer": "outer ring (BPFO)",
    "inner": "inner ring (BPFI)",
    "ball": "{}, on both rings (2 BSF)",
}


def bearing_sheet(name: str, keys: LoadKeys, run: DataTree | None) -> str:
    """Lay out the data sheet of a bearing under its load.

    Parameters
    ----------
    name : str
        What it is called.
    keys : LoadKeys
        The bearing, its load and its speed.
    run : DataTree, optional
        A result of it, whose velocities in the bands of ISO 15242 are told, by part.

    Returns
    -------
    str
        A page of HTML that needs nothing else.

    Raises
    ------
    InputError
        If it does not carry its load.
    """
    speed = float(keys.speed or 0.0)
    of = keys.bearing
    found = keys.loaded()
    turning = of.kinematics(speed or 1.0, contact_angle=found.contact_angle)
    at_rest = tree(static_group(found, turning))
    load = f"{rounded(found.radial, 4)} N radially, {rounded(found.axial, 4)} N axially"
    at = f" at {rounded(60.0 * speed, 5)} 1/min" if speed else ""
    if tilt := getattr(found, "tilt", 0.0):
        load += f", tilted by {rounded(1e3 * tilt, 4)} mrad,"
    blocks: list[Block] = [_geometry(keys), _stiffness(keys), _tones(found, speed)]
    if run is not None and (bands := data.unless_missing(bands_table, run)):
        blocks.append(bands)
    blocks.append(ball_contacts_table(at_rest))
    summary = f"Under {load}{at}: heaviest {of.ELEMENT} {rounded(found.inner_load.max())} N, "
    peak = max(found.inner_pressure.max(), found.outer_pressure.max())
    summary += f"{rounded(peak / 1e9)} GPa, contact angle {rounded(math.degrees(found.contact_angle))}°."
    return figures_page(f"{of.ELEMENT.capitalize()} bearing {name}", summary, blocks, {})


def _geometry(keys: LoadKeys) -> ReportTable:
    of = keys.bearing
    listed = LISTED.get(keys.name or "")
    rows: list[tuple[str, str]] = []
    if listed is not None and listed.bore is not None:
        rows.append(("bore × outside diameter × width", f"{listed.cells[2]} mm"))
    diameter = f"{rounded(1e3 * of.ball_diameter, 5)}"
    pitch = "pitch diameter", f"{rounded(1e3 * of.pitch_diameter, 5)} mm"
    clearance = "diametral clearance", f"{rounded(1e6 * of.radial_clearance)} µm"
    angle = f"{rounded(math.degrees(of.free_angle))}°"
    if isinstance(of, RollerBearing):
        size = f"{diameter} × {rounded(1e3 * of.roller_length, 5)} mm"
        drop = f", {rounded(1e6 * of.profile.drop)} µm" * (of.profile.drop > 0.0)
        rows += [
            ("rollers", f"{of.rollers} of {size}, {of.roller_material.name}"),
            ("profile", f"{of.crowning}{drop}"),
            *(pitch, clearance),
            ("contact angle", angle),
        ]
        if of.taper:
            rows += [("taper", f"{rounded(math.degrees(of.taper))}°"), ("rib", of.rib)]
    else:
        flanks = f"{rounded(math.degrees(of.arch_angle or 0.0), 4)}°"
        arches = [("flanks of the gothic arches", flanks)] if of.arches else []
        rows += [
            ("balls", f"{of.balls} of {diameter} mm, {of.ball_material.name}"),
            pitch,
            ("groove radii", f"{of.inner_conformity:g} D (inner), {of.outer_conformity:g} D (outer)"),
            *arches,
            clearance,
            ("free contact angle", angle),
            ("preload", f"{rounded(of.preload)} N"),
        ]
    rows += [("rings", of.material.name), (f"mass of a {of.ELEMENT}", f"{rounded(1e3 * of.ball_mass)} g")]
    as_given = PRINTED.get(keys.name or "", "Dimensions as given.")
    note = as_given if listed is None else listed.sentence
    columns = {"of": text_cells(what for what, _ in rows), "value": text_cells(told for _, told in rows)}
    return table("geometry", "Geometry", columns, note)


def _carried(keys: LoadKeys) -> Iterator[tuple[float, LoadedBearing]]:
    """The bearing at shares of its load, as far as it carries them."""
    with PhysicsWarning.ignored():
        for factor in FACTORS:
            try:
                yield factor, keys.loaded(factor)
            except InputError:
                if factor > 1.0:
                    return
                continue


def _stiffness(keys: LoadKeys) -> PageFigure:
    shares, found = zip(*_carried(keys), strict=True)
    loads = np.hypot(keys.radial, keys.axial + keys.bearing.preload) * np.array(shares)
    means = np.array([np.diagonal(each.stiffness, axis1=1, axis2=2).mean(axis=0) for each in found])
    ways = dict(enumerate(DIRECTIONS)) if keys.radial else {0: "radially", 2: DIRECTIONS[2]}
    lines = [chart.Line(loads, 1e-6 * means[:, n], way, COLOURS[n], marker="o") for n, way in ways.items()]
    across = log_axis("stiffness / (N/µm)", [each.y for each in lines])
    along = chart.Axis("load / N", float(loads[0]), float(loads[-1]), log=True)
    columns = {"load (N)": loads} | {f"stiffness {way} (N/m)": means[:, n] for n, way in ways.items()}
    of = keys.bearing
    caption = f"Of the inner ring, means while a {of.ELEMENT} passes, at this ratio of radial and axial load."
    parts: list[chart.Panel | str] = [chart.Panel(along, across, tuple(lines)), caption]
    return PageFigure.of("stiffness_over_load", "Stiffness over load", parts, "", columns)


def _tones(found: LoadedBearing, speed: float) -> ReportTable:
    of = found.bearing
    turning = of.kinematics(1.0, contact_angle=found.contact_angle)
    names = ["cage", *(PART_NAMES[part].format(of.ELEMENT) for part in PARTS)]
    orders = np.array([turning.cage, *(turning.tone(part) for part in PARTS)])
    columns = {"of": text_cells(names), "turns of the shaft": number_cells(orders, "{:.4f}")}
    if speed:
        columns["Hz"] = number_cells(orders * speed, "{:.2f}")
    note = "In pure rolling, at the contact angle of the load; a cage that slips is slower by up to 1 %."
    if isinstance(of, BallBearing) and of.arches:
        faster = rounded(1.0 / math.cos(of.arch_angle or 0.0), 4)
        note += f" The tone of a ball on four flanks is {faster} times that of one on two, which stands here."
    return table("tones", "Tones", columns, note)
