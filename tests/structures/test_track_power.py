"""Power that goes into a track is dissipated by its parts, each integrated by itself."""

import numpy as np
import pytest

from asperity import Track
from asperity.structures.causal_track import causal_track
from asperity.structures.mobility import dissipated_power
from refusals import refusals

FREQUENCY = np.array([25.0, 90.0, 210.0, 480.0, 1063.0, 2100.0, 4800.0])
DAMPERS = {"rail_damper_mass": 15.0, "rail_damper_frequency": 800.0, "rail_damper_loss_factor": 0.35}
BENT = {
    "sleeper_bending_stiffness": 6e6,
    "under_sleeper_pad_stiffness": 2e8,
    "under_sleeper_pad_damping": 1e4,
}
BED = {"ballast_mass": 300.0, "subgrade_stiffness": 9e7, "subgrade_loss_factor": 0.3}
TRACKS = {
    "uic60": Track.named("uic60"),
    "uic60-euler": Track.named("uic60-euler"),
    "all layers": Track.named("nordborg-loss-factor", **BENT, **BED),
    "in time": causal_track(Track.named("nordborg-loss-factor")),
    "dampers": Track.named("uic60", **DAMPERS),
    "dampers, bending": Track.named("nordborg", **DAMPERS, **BENT),
    "slab-blocks": Track.named("slab-blocks"),
    "embedded": Track.named("embedded", **DAMPERS),
    "embedded, Euler-Bernoulli": Track.named("embedded", shear_stiffness=None, rotary_inertia=None),
    "rigid ground": Track.named("uic60", ballast_stiffness=np.inf),
    "continuous, with sleepers": Track.named("uic60", continuous=True, **BED),
}


@pytest.mark.parametrize("name", TRACKS)
def test_what_goes_in_is_dissipated(name):
    track = TRACKS[name]
    for x in (0.0, 0.11, 0.3, 0.5, 7.9):
        parts = dissipated_power(track, FREQUENCY, x)
        fed = -2.0 * np.pi * FREQUENCY * track.receptance(FREQUENCY, x, x).imag
        np.testing.assert_allclose(sum(parts.values()), fed, rtol=1e-9)
        assert all((power >= 0.0).all() for power in parts.values())
    assert set(parts) == {"rail", *track.springs} | ({"rail_damper"} if track.damper else set())


def test_what_dissipates_nothing_gets_nothing():
    track = Track.named("uic60", pad_damping=None, ballast_damping=None)
    parts = dissipated_power(track, FREQUENCY, 0.2)
    assert not parts["pad"].any()
    assert not parts["ballast"].any()
    assert (parts["rail"] > 0.0).all()


test_bad_questions_are_refused = refusals(
    ([100.0, 0.0], 0.0, "frequency"),
    ([1.0], np.nan, "force"),
    of=lambda frequency, x: dissipated_power(TRACKS["uic60"], frequency, x),
)
