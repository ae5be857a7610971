"""What rolling a wheel on a rail takes, from small pieces of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.errors import ComputationError
from asperity.kinds.wheel_on_rail import schema
from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.kinds.wheel_on_rail.labels import findings_of_labels, track_label, wheel_label
from asperity.kinds.wheel_on_rail.losses import (
    described_losses,
    expected_error_of_losses,
    warn_of_loss_factors,
)
from asperity.kinds.wheel_on_rail.roll import roll_wheel
from asperity.kinds.wheel_on_rail.sound import silent_wheel
from asperity.laws import HertzLaw, Role, in_role
from asperity.progress import Progress
from asperity.reduction.texture import StateTexture
from asperity.scenarios.measure import (
    A_WEIGHTED,
    ACCELERATION,
    Measure,
    a_weighted,
    density_of,
    line_frequencies,
)
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.refining import Setting, Way
from asperity.scenarios.trial import STEPS, timed
from asperity.scenarios.trial_track import POLE_TIME, try_track
from asperity.scenarios.validity import warn_of_findings
from asperity.schema import spectra
from asperity.structures.moving_kernel import SHORTEST, STARTS, MovingKernel
from asperity.structures.rail_poles import POLES, RailPoles
from asperity.threads import thread_count

REPORT = 4.0
"""Time of starting the program, and of drawing and writing a report, s."""
LAG_TIME = 2e-7
"""Time of points that are passed, per bay, law and lag of the moving kernel, s."""


def rows(case: Any) -> list[tuple[str, str]]:
    """Characteristic numbers of the track, in words."""
    track, losses = case.track_model(), expected_error_of_losses(case)
    warn_of_loss_factors(losses)
    known = "rail, sleepers and wheel"
    if reason := silent_wheel(case):
        known = f"rail and sleepers, for {reason}"
    if in_role(Role.BARE, case.laws) is not None:
        known += f"; by CNOSSOS-EU for {track_label(case)} pads and a wheel of {wheel_label(case)}"
        warn_of_findings(findings_of_labels(case))
    frequencies = f"pinned–pinned {track.pinned_pinned_frequency:.4g} Hz, sleeper passing"
    passing = f"{case.speed / track.sleeper_spacing:.4g} Hz, critical speed {track.critical_speed:.4g} m/s"
    points = ", ".join(f"{position:g} m" for position in case.point_positions)
    return [
        ("track", f"{frequencies} {passing}"),
        *described_losses(losses, case.wheel.load),
        ("rail motion recorded at", points),
        ("sound power", f"of {known}"),
    ]


def records(case: Any) -> int:
    """Histories that a law leaves behind."""
    return 4 + 2 * len(case.point_positions)


def seconds(prepared: PreparedCase, progress: Progress, pace: float) -> dict[str, float]:
    """Time of the moving kernel, its poles, and of the points that the wheel passes, s."""
    case: Any = prepared.case
    trial = try_track(case.track_model(), case.speed, case.time_step, progress)
    poles = min(case.numerics.poles or POLES, POLES) if case.numerics.kernel == "poles" else 0
    first, last = case.rolled_range
    bays, lags = (last - first) / case.track_model().sleeper_spacing, trial.length / case.time_step
    return {
        "moving kernel": trial.kernel / thread_count(),
        "poles": poles * POLE_TIME * pace,
        "passed points": bays * len(case.laws) * lags * LAG_TIME * pace,
    }


def step_seconds(prepared: PreparedCase) -> float:
    """Time of a step of smooth bodies over a smooth path, s."""
    case = prepared.case
    law = HertzLaw(prepared.shape.hertz.stiffness_constant, StateTexture.unfiltered(np.zeros(8), 1e3, -4e3))
    rail, wheel, duration = _rail_like(prepared), prepared.bodies.wheel, STEPS * case.time_step
    _, taken = timed(lambda: roll_wheel(rail, wheel, law, start=0.0, duration=duration, settling=0.0))
    return taken / STEPS


def _rail_like(prepared: PreparedCase) -> RailPoles | MovingKernel:
    """A rail that costs as much as that of a case, and hardly moves."""
    case: Any = prepared.case
    lags = round(SHORTEST / case.time_step)
    kernel = MovingKernel(case.track_model(), case.speed, case.time_step, np.full((STARTS, lags), 1e-20))
    if case.numerics.kernel != "poles":
        return kernel
    count = min(case.numerics.poles or POLES, POLES) // 2
    poles = 0.5 * np.exp(1j * np.linspace(0.1, 3.0, count))
    return RailPoles(kernel, poles, np.full((STARTS, count), 1e-20 + 0j), 0.0, 0.0)


def settings_of(case: WheelOnRail) -> list[Setting]:
    """The kernel itself, which any number of poles can only come near to."""
    if case.numerics.kernel != "poles":
        return [Setting("poles", (), "the rail is scattered from its kernel, without poles")]
    words = f"up to {case.numerics.poles or POLES} → the kernel that they are fitted to"
    scattered = Way(words, {"numerics.kernel": "scatter", "numerics.poles": None})
    return [Setting("poles", (scattered,), scans_kept=True)]


ACCELERATION_REFERENCE = 1e-6
"""Of acceleration levels, m/s²."""


def _sound_power(tree: DataTree, law: str) -> NDArray[np.float64]:
    """Energy of a band, shared out over its lines as the force is: it has no finer spectrum."""
    held = tree[schema.SOUND_POWER_LEVEL.group].to_dataset()
    if schema.SOUND_POWER_LEVEL.name not in held:
        what = "the sound power of rolling is not known"
        raise ComputationError(what, "a rough rail, and bands between 50 Hz and 10 kHz")
    power = held[schema.SOUND_POWER_LEVEL.name].sel(law=law, source="total").values
    centre, frequency = held[schema.NOISE_BAND.name].values, line_frequencies(tree)
    force = density_of(tree, spectra.FORCE_PSD, law)
    step = frequency[1] - frequency[0]
    density = np.zeros_like(force)
    for middle, level in zip(centre, power, strict=True):
        inside = np.abs(np.log10(frequency / middle)) <= 0.05
        if inside.any() and force[inside].sum() > 0.0 and np.isfinite(level):
            density[inside] = 10.0 ** (level / 10.0) * force[inside] / (force[inside].sum() * step)
    return density


def _acceleration(tree: DataTree, law: str) -> NDArray[np.float64]:
    """Of the rail at the points that are passed by."""
    velocity = density_of(tree, schema.POINT_VELOCITY_PSD, law)
    return velocity * (2.0 * np.pi * line_frequencies(tree) / ACCELERATION_REFERENCE) ** 2


MEASURES = {
    A_WEIGHTED: Measure(
        "sound power level of rolling, A-weighted", "dB(A) re 1 pW", a_weighted(_sound_power), ("linear",)
    ),
    ACCELERATION: Measure(
        "acceleration level of the rail at the points passed by, energy mean",
        "dB re 1e-6 m/s²",
        _acceleration,
    ),
}
