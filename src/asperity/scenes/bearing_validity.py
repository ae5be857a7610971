"""What of the runs of a bearing must be in range, and how far its laws are from solved contacts."""

from collections.abc import Iterator

import numpy as np

from asperity.case.ball_bearing import BearingUnderLoad
from asperity.errors import Finding, Grade, percent
from asperity.laws import spec_of
from asperity.rolling.bearing import RolledBearing
from asperity.scenes.validity import beyond, contacts_softened, energy_left, load_missed

OFF = (0.1, 0.5)
"""Shares of the diameter of a ball by which a ring may be off its place: warned of, and out of range."""


def bearing_findings(case: BearingUnderLoad, runs: dict[str, RolledBearing]) -> Iterator[Finding]:
    """Numbers of the runs that must be in range."""
    for name, run in runs.items():
        share = run.unconverged_steps / case.steps_taken
        left = run.energy.residual
        yield Finding(
            f"share of the time steps that missed their tolerance, {name}", percent(share), "below 1 %",
            Grade.of_share(share) if share else None, "Their contact forces are too coarse.",
            "Take a smaller time_step.", warned=True
        )  # fmt: skip
        yield energy_left(name, left, "time_step")
        stiffness = [each.stiffness_under(load) for each, load in case.contacts]
        yield from contacts_softened(name, float((run.softening.T * stiffness).max()), "time_step")
        yield from out_of_place(case, name, run)
    yield from _missed(runs)


def out_of_place(case: BearingUnderLoad, law: str, run: RolledBearing) -> Iterator[Finding]:
    """Rings farther off than what rolls lets them, and a load that it does not carry in the mean."""
    of = case.bearing.bearing
    element = of.ELEMENT
    angle = case.static.contact_angle
    moved = max(float(np.abs(each).max()) for each in (run.inner_motion, run.outer_motion))
    yield from beyond(
        f"displacement of a ring over the diameter of a {element}",
        moved / of.ball_diameter,
        OFF,
        "A ring is not held, or by springs too soft for what drives it.",
        "Check the stiffnesses of shaft and housing, loads and clearance.",
        f"a ring displaced by {{}} of a {element}",
        law,
    )
    azimuth = run.cage + 2.0 * np.pi * np.arange(of.balls)[:, None] / of.balls
    radial = np.cos(angle) * np.sum(run.inner_force * np.cos(azimuth), axis=0)
    other_way = np.sum(run.flank_force[: of.balls], axis=0)
    axial = np.sin(angle) * (np.sum(run.inner_force, axis=0) - 2.0 * other_way)
    carried = case.radial, (case.axial + of.preload) * bool(angle)
    for way, force, load in zip(("radial", "axial"), (radial, axial), carried, strict=True):
        if load > 0.0:
            mean = float(np.mean(force)) / load
            yield from load_missed(f"mean {way} force", f"of the {element}s on the inner ring", mean, law)


def _missed(runs: dict[str, RolledBearing]) -> Iterator[Finding]:
    """How far every law is from one that solves each contact in each step, where that was rolled."""
    for exact in (name for name in runs if spec_of(name).solved_every_step):
        for name in (name for name in runs if name != exact):
            off = []
            for what in ("inner_force", "outer_force", "acceleration"):
                found = getattr(runs[name], what)
                solved = getattr(runs[exact], what)
                varied = np.mean(solved.var(axis=1))
                off.append(percent(float(np.sqrt(np.mean((found - solved) ** 2) / varied))))
            yield Finding(
                f"{name} from {exact}: forces on the inner and the outer ring, acceleration", ", ".join(off),
                f"rms, of how those of {exact} vary", None, "How far the law is from solved contacts.", ""
            )  # fmt: skip
