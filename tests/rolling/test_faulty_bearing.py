"""A pit on a raceway of a bearing that turns: its lines in the envelope, and how the load zone weighs it."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.diagnostics import envelope_spectrum
from asperity.laws import HertzLaw
from asperity.laws.layout import force
from asperity.rolling.bearing import BearingRings, roll_bearing
from asperity.scenarios.raceway_laws import raceway_laws, raceway_on
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.ring import Ring
from asperity.surfaces.faults import Fault

BEARING, RADIAL, SPEED, DAMPING = BallBearing.named("6205"), 100.0, 90.0, 50.0
CONTACTS = {"inner": BEARING.inner_contact, "outer": BEARING.outer_contact}
RADII = dict(zip(CONTACTS, BEARING.raceway_radii, strict=True))
RESONANCE, BAND, STEP = 3000.0, (2000.0, 4000.0), 3.2e-6
RINGS = BearingRings(
    Ring.rigid(0.5),
    Ring.rigid(0.3, radial_stiffness=0.3 * (2 * np.pi * RESONANCE) ** 2, damping_ratio=0.05),
)
LOAD = float(BEARING.loaded(RADIAL).outer_load.max())


@cache
def pitted(part):
    """The scanned contact on a raceway with a pit of 0.4 mm at angle zero."""
    pit = Fault("pit", length=0.4e-3, depth=0.1e-3)
    surface = raceway_on(CONTACTS[part], LOAD, RADII[part], faults=[pit])
    return raceway_laws(["table"], CONTACTS[part], surface, LOAD, damping=DAMPING, accuracy=1e-3)["table"]


@dataclass
class Turned:
    """A law on a raceway that is turned by an angle, rad."""

    law: object
    part: str
    angle: float

    def __post_init__(self):
        self.name, self.damping = self.law.name, self.law.damping

    def prepare(self, positions):
        return self.law.prepare(np.asarray(positions) - RADII[self.part] * self.angle)


def turned(part=None, angle=0.0, duration=0.2, **keys):
    """A bearing with a pit on one raceway, at an angle from the load, or without; seen beside the pit."""
    laws = [HertzLaw(each.stiffness_constant, None, DAMPING) for each in CONTACTS.values()]
    if part:
        laws[list(CONTACTS).index(part)] = Turned(pitted(part), part, angle)
    return roll_bearing(
        BEARING, RINGS, *laws, speed=SPEED, radial=RADIAL, duration=duration, settling=0.03, time_step=STEP,
        sensors=[("outer", angle, "radial")], **keys,
    )  # fmt: skip


@pytest.mark.parametrize(("part", "other"), [("outer", "inner"), ("inner", "outer")])
def test_a_pit_has_the_lines_of_its_raceway_and_none_of_the_other(part, other):
    """Side bands where it turns through the load zone, at the speed of the ring, and nowhere else."""
    turning = BEARING.kinematics(SPEED, contact_angle=0.0)
    frequency, amplitude = envelope_spectrum(turned(part).acceleration[0], 1 / STEP, BAND)

    def line(expected):
        return amplitude[abs(frequency - expected) < 4.0].max()

    own = turning.tone(part)
    for order in (1, 2, 3):
        near = abs(frequency - order * own) < 0.3 * SPEED
        assert frequency[near][amplitude[near].argmax()] == pytest.approx(order * own, abs=2.5)
        assert line(order * own) > 0.15 * line(own)
    sides = np.array([line(own - SPEED), line(own + SPEED)])
    if part == "inner":
        assert (sides > 0.4 * line(own)).all()
        assert line(own - 0.5 * SPEED) < 0.2 * line(own)
        assert line(turning.tone(other)) < 0.25 * line(own)  # feet of the second side band, 15 Hz below
    else:
        assert (sides < 0.005 * line(own)).all()
        assert line(turning.tone(other)) < 1e-3 * line(own)


def test_vibration_of_a_pit_follows_the_static_load():
    """Static: what a ball under its load loses over the pit where it is held; no ball is loaded opposite."""
    angles, contact, lost, found = (0.0, 25.0, 40.0, 180.0), CONTACTS["outer"], [], []
    for angle in np.radians(angles):
        load = BEARING.loaded(RADIAL, speed=SPEED, cage_angles=[angle]).outer_load[0, 0]
        lost.append(load - force(pitted("outer"), [0.0], contact.approach(load))[0])
        signal = turned("outer", angle, 0.028).acceleration[0]  # nine balls pass
        lines = np.abs(np.fft.rfft(signal * np.hanning(signal.size)))
        frequency = np.fft.rfftfreq(signal.size, STEP)
        found.append(np.hypot.reduce(lines[(frequency > BAND[0]) & (frequency < BAND[1])]))
    assert lost[0] > lost[1] > lost[2] > 5 * lost[3]
    assert_allclose(np.array(found) / found[0], np.array(lost) / lost[0], rtol=0.3, atol=0.02)
    loose = turned("outer", np.pi, 1.2 / BEARING.kinematics(SPEED).ball_pass_outer, centrifugal=False)
    azimuth = loose.cage + 2 * np.pi / 9 * np.arange(9)[:, None]
    over = np.abs(azimuth % (2 * np.pi) - np.pi) * RADII["outer"] < 0.2e-3  # the pit
    assert over.any()
    assert not loose.outer_force[over].any()
