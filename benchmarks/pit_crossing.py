"""Figure of the front page: the force on a ball as it crosses a pit of a raceway, by contact and by guess.

    python benchmarks/pit_crossing.py     # table, docs/pictures/pit_crossing.png

A 6205 under 100 N: the ball in the middle of the load zone on the outer raceway, across a round pit of
0.28 mm depth. `table` is the scanned three-dimensional contact; dots are single contacts solved by
`HalfSpace` on another grid. Beside them the two functions by which lumped models let a ball down over a
fault, a drop over its length and a half sine, both compared in doi:10.1177/09574565241243391; drawn with the
most that a sphere can sink between the edges, L²/8R, as there, and told in the table for the whole depth as
well. Above, the approach is that under the load and held; below, the bearing turns at 1797 1/min, and the
ball moves as forces and inertia let it.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from asperity import BallBearing, HalfSpace
from asperity.laws import HertzLaw
from asperity.laws.layout import force
from asperity.laws.periodic import Periodic
from asperity.reduction.texture import StateTexture
from asperity.rolling.bearing import BearingRings, roll_bearing
from asperity.scenarios.raceway_grids import raceway_on
from asperity.scenarios.raceway_laws import raceway_laws
from asperity.structures.ring import Ring
from asperity.surfaces.faults import Fault

FIGURE = Path(__file__).parents[1] / "docs/pictures/pit_crossing.png"
BEARING, RADIAL, SPEED = BallBearing.named("6205"), 100.0, 1797 / 60
CONTACT, RADIUS = BEARING.outer_contact, BEARING.raceway_radii[1]
LOAD = float(BEARING.loaded(RADIAL).outer_load.max())
HELD = CONTACT.approach(LOAD)
LENGTHS, DEPTH, DAMPING, STEP = (0.178e-3, 0.533e-3), 0.28e-3, 100.0, 1e-6
FINE, EDGE = 2e-6, 10e-6  # m, of lumped drops and their edges
LOOKS = {
    "table": ("#0072b2", 2.2, "-", "three-dimensional contact"),
    "drop": ("#d55e00", 1.2, "-", "lumped: drop"),
    "half sine": ("#cc79a7", 1.2, "--", "lumped: half sine"),
}
RINGS = BearingRings(Ring.rigid(0.5), Ring.rigid(0.3, radial_stiffness=1e8, damping_ratio=0.03))


def lumped(name: str, length: float, depth: float) -> Callable[[np.ndarray], np.ndarray]:
    """How far a lumped model lets the ball down over a pit, m, at places beside its middle, m."""
    if name == "half sine":
        return lambda along: depth * np.cos(np.pi * np.clip(along / length, -0.5, 0.5))
    return lambda along: depth * np.sin(0.5 * np.pi * np.clip((0.5 * length - abs(along)) / EDGE, 0, 1)) ** 2


def law_of(down: Callable[[np.ndarray], np.ndarray]) -> Periodic:
    """Hertz's contact let down around angle zero."""
    around, beyond = round(2 * np.pi * RADIUS / FINE), 40
    dx = 2 * np.pi * RADIUS / around
    along = ((np.arange(-beyond, around + beyond + 1) + around // 2) % around - around // 2) * dx
    texture = StateTexture.unfiltered(down(along), dx, -beyond * dx)
    return Periodic(HertzLaw(CONTACT.stiffness_constant, texture, DAMPING), around * dx)


def table(length: float) -> Periodic:
    """The solved contact over a pit at angle zero."""
    surface = raceway_on(CONTACT, LOAD, RADIUS, faults=[Fault("pit", length=length, depth=DEPTH)])
    return raceway_laws(["table"], CONTACT, surface, LOAD, damping=DAMPING)["table"]


def solved(length: float, along: float) -> float:
    """Force of one contact at a place beside the middle of the pit, N: a grid of its own."""
    (a, b), spacing = CONTACT.semi_axes(HELD), (4e-6, 13e-6)
    m, n = round(6 * a / spacing[0]), round(3 * b / spacing[1])
    x, y = np.meshgrid(np.arange(-m, m + 1) * spacing[0], np.arange(-n, n + 1) * spacing[1], indexing="ij")
    pit = np.hypot(x + along, y) < 0.5 * length
    gap = x**2 / (2 * CONTACT.radius_x) + y**2 / (2 * CONTACT.radius_y) + DEPTH * pit
    return HalfSpace(gap.shape, spacing, CONTACT.modulus).solve(gap, HELD).force


def rolled(law: Periodic) -> tuple[np.ndarray, np.ndarray]:
    """Place of the first ball beside the middle of the pit, m, and force on the outer raceway, N."""
    turning = BEARING.kinematics(SPEED, contact_angle=0.0)
    inner = HertzLaw(BEARING.inner_contact.stiffness_constant, None, DAMPING)
    run = roll_bearing(
        BEARING, RINGS, inner, law, speed=SPEED, radial=RADIAL, duration=1.2 / turning.ball_pass_outer,
        settling=2.5 / turning.ball_pass_outer, time_step=STEP,
    )  # fmt: skip
    azimuth = run.cage - 2 * np.pi / BEARING.balls  # of the ball that comes to the pit within the record
    return RADIUS * azimuth, run.outer_force[-1]


def main() -> None:
    from matplotlib.figure import Figure

    warnings.simplefilter("ignore")
    figure = Figure(figsize=(10.0, 5.4), layout="constrained")
    panels = figure.subplots(2, 2, sharex="col", sharey="row")
    a, b = (1e3 * each for each in CONTACT.semi_axes(HELD))
    print(f"ball of {LOAD:.1f} N, half axes {a:.3f} and {b:.3f} mm, approach {HELD * 1e6:.2f} um\n")
    print("| pit, mm | law | least force held, N | as it rolls, N |\n|---:|---|---:|---:|")
    for (held, rolls), length in zip(panels.T, LENGTHS, strict=True):
        ends = -1.2 * length - 1e-4, 2.0 * length + 3e-4
        along = np.linspace(*ends, 1601)
        sinks, scanned = min(DEPTH, length**2 / (8 * CONTACT.radius_x)), table(length)
        for row, name in enumerate(LOOKS):
            colour, width, style, label = LOOKS[name]
            for depth in (sinks,) if name == "table" else (sinks, DEPTH):
                down = lumped(name, length, depth)
                still = CONTACT.stiffness_constant * np.clip(HELD - down(along), 0, None) ** 1.5
                still = force(scanned, along, HELD) if name == "table" else still
                place, moving = rolled(scanned if name == "table" else law_of(down))
                near = (place > ends[0]) & (place < ends[1])
                told = f"{still.min():.0f} | {moving[near].min():.0f} to {moving[near].max():.0f}"
                how = name if name == "table" else f"{name} of {depth * 1e6:.3g} um"
                print(f"| {length * 1e3:g} | {how} | {told} |", flush=True)
                if depth == sinks:
                    held.plot(1e3 * along, still, style, color=colour, lw=width, label=label, zorder=3 - row)
                    rolls.plot(1e3 * place[near], moving[near], style, color=colour, lw=width, zorder=3 - row)
        dots = np.linspace(-0.8, 0.8, 13) * (length + 2e-3 * a)
        exact = [solved(length, x) for x in dots]
        off = np.abs(force(scanned, dots, HELD) - exact).max()
        print(f"| {length * 1e3:g} | solved one by one | within {off:.2f} N of `table` | |")
        held.plot(1e3 * dots, exact, "o", color="black", ms=4, label="solved one by one")
        held.set(ylim=(-4, 88), title=f"pit of {length * 1e3:.2f} mm, {DEPTH * 1e3:g} mm deep")
        for each in (held, rolls):
            each.axvspan(-500 * length, 500 * length, color="0.92", zorder=0)
        rolls.set(xlim=(1e3 * ends[0], 1e3 * ends[1]), ylim=(-8, 218))
        rolls.set_xlabel("place of the ball beside the middle of the pit / mm")
    panels[0][0].set_ylabel("force on the ball / N\napproach held")
    panels[1][0].set_ylabel("force on the ball / N\nas it rolls, 1797 1/min")
    panels[0][0].legend(loc="lower right", fontsize=9)
    figure.savefig(FIGURE, dpi=110)


if __name__ == "__main__":
    main()
