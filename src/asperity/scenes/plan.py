"""What rolling takes, from a few steps of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.config.case import Case
from asperity.errors import warn_of_findings
from asperity.laws import Role, in_role
from asperity.scenarios.laws import working_point
from asperity.scenarios.measure import A_WEIGHTED, Measure, a_weighted, density_of
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.refining import Setting
from asperity.scenes import noise
from asperity.scenes.track import described_losses, loss_factor_error, warn_of_loss_factors
from asperity.schema import spectra
from asperity.structures.track import Track


def rows(prepared: PreparedCase) -> list[tuple[str, str]]:
    """What else will be computed, in words: several contacts, a track, and its sound."""
    offsets, over = prepared.bodies.offsets, prepared.bodies.over
    found = []
    if len(offsets) > 1:
        places = f"{min(offsets):g} to {max(offsets):g} m ahead of the position"
        found.append(("contacts", f"{len(offsets)}, {places}"))
    return found + (_rows_of_track(prepared, over) if isinstance(over, Track) else [])


def _rows_of_track(prepared: PreparedCase, track: Track) -> list[tuple[str, str]]:
    """Characteristic numbers of the track, in words, and what is known of its sound."""
    case: Any = prepared.case
    _, stiffness = working_point(case.contact, prepared.shape, None)
    scene, highest = prepared.bodies, case.numerics.highest_frequency
    losses = loss_factor_error(track, scene.first, stiffness, highest)
    warn_of_loss_factors(losses)
    known = "rail, sleepers and wheel"
    if reason := noise.silent_wheel(case):
        known = f"rail and sleepers, for {reason}"
    if in_role(Role.BARE, case.laws) is not None:
        known += (
            f"; by CNOSSOS-EU for {noise.track_label(case)} pads and a wheel of {noise.wheel_label(case)}"
        )
        warn_of_findings(noise.findings_of_labels(case))
    frequencies = f"pinned–pinned {track.pinned_pinned_frequency:.4g} Hz, sleeper passing"
    passing = f"{case.speed / track.sleeper_spacing:.4g} Hz, critical speed {track.critical_speed:.4g} m/s"
    points = ", ".join(f"{position:g} m" for position in scene.points)
    return [
        ("track", f"{frequencies} {passing}"),
        *described_losses(losses, prepared.shape.load),
        ("rail motion recorded at", points),
        ("sound power", f"of {known}"),
    ]


def settings_of(case: Case) -> list[Setting]:
    """List them."""
    return []


def _force(tree: DataTree, law: str) -> NDArray[np.float64]:
    return density_of(tree, spectra.FORCE_PSD, law)


MEASURES = {
    A_WEIGHTED: Measure(
        "contact force level, energy mean over the contacts, A-weighted", "dB(A) re 1 N", a_weighted(_force)
    ),
}
