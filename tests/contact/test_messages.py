"""What callers of the contact are told of arguments that have no meaning."""

import math

import numpy as np

from asperity import HalfSpace, HeightMap, Hertz, Profile
from asperity.contact.hertz import in_groove
from refusals import refusals

FLAT = np.zeros((4, 4))
ONE_MISSING = np.where(np.eye(4)[1] * np.eye(4)[:, [2]], math.nan, 0.0)
ELASTIC, HARD = HalfSpace((4, 4), 1.0, 1.0), HalfSpace((4, 4), 1.0, 1.0, hardness=2.0)
RADIUS, GROOVE = 6.35e-3, 6.6e-3


def scan(surface=FLAT, body=FLAT, approaches=(0.1,), **keywords):
    ELASTIC.scan(surface, body, approaches, **keywords)


def run_in(surface=FLAT, body=FLAT, load=1.0, half_space=HARD, **keywords):
    half_space.run_in(surface, body, load, **keywords)


def groove(*arguments):
    in_groove(115e9, *arguments)


test_messages = refusals(
    (HalfSpace, ((0, 4), 1.0, 1.0), {}, "half-space shape: received 0; allowed: two positive whole"),
    (HalfSpace, ((4, 4), (1.0, -1.0), 1.0), {}, "half-space spacing: received -1.0"),
    (HalfSpace, ((4, 4), 1.0, 0.0), {}, "contact modulus: received 0.0.*Steel on steel has 115e9"),
    (HalfSpace, ((4, 4), 1.0, 1.0, -3.0), {}, "hardness: received -3.0"),
    (ELASTIC.solve, (FLAT,), {}, "approach and load: received neither; allowed: exactly one"),
    (ELASTIC.solve, (FLAT, 1.0, 1.0), {}, "approach and load: received both"),
    (ELASTIC.solve, (FLAT,), {"load": -1.0}, "load: received -1.0; allowed: a force ≥ 0"),
    (ELASTIC.solve, (FLAT, 1.0), {"rtol": 0.0}, "rtol: received 0.0; allowed: a number between 0 and 1"),
    (ELASTIC.solve, (FLAT, 1.0), {"start": np.zeros((2, 2))}, r"start pressure: received shape \(2, 2\)"),
    (ELASTIC.solve, (np.zeros((4, 5)), 1.0), {}, r"gap: .*of the half-space's shape \(4, 4\)"),
    (HARD.solve, (FLAT,), {"load": 33.0}, "33 N; allowed: less than hardness × window area = 32 N"),
    (scan, (FLAT[1:],), {}, "window of the scan: received 4 × 4 cells on a surface of 3 × 4 cells"),
    (scan, (ONE_MISSING,), {}, "the scan: received 1 of 16 points without a height.*Fill missing points"),
    (scan, (FLAT[0],), {}, "surface of the scan: received 4 numbers; allowed: a height map, or an array"),
    (scan, (HeightMap(FLAT, 2.0),), {}, "2 × 2 m apart; allowed: 1 × 1 m apart.*Resample the map"),
    (scan, (Profile(FLAT[0], 1.0),), {}, "surface of the scan: received a line of heights"),
    (scan, (FLAT, FLAT[1:]), {}, r"body of the scan: .*finite array of the half-space's shape \(4, 4\)"),
    (scan, (FLAT, ONE_MISSING), {}, "body of the scan: received nan"),
    (scan, (FLAT, FLAT, [0.2, 0.1]), {}, "approaches of the scan: received numbers that do not rise"),
    (scan, (FLAT, FLAT, []), {}, "approaches of the scan: received none; allowed: finite, increasing"),
    (scan, (), {"stride": 0}, "stride of the scan: received 0"),
    (scan, (), {"force_accuracy": 0.2}, "force_accuracy: received 0.2; allowed: .* at most 0.1"),
    (scan, (), {"force_accuracy": 1e-4, "rtol": 1e-6}, "rtol and force_accuracy: received both"),
    (run_in, (), {"half_space": ELASTIC}, "hardness of the half-space: received None"),
    (run_in, (), {"passes": "often"}, r'passes.*from 1 to 100, or "shakedown"'),
    (run_in, (), {"passes": 101}, "passes: received 101"),
    (run_in, (FLAT, FLAT[1:]), {}, r"body that runs in: received shape \(3, 4\)"),
    (run_in, (), {"stride": 4}, "stride of running-in: received 4; allowed: a whole number from 1 to 3"),
    (Hertz, (1e11, 1.0, math.inf), {}, "Hertz radius_y: received inf"),
    (Hertz, (1e11, 0.0, 1.0), {}, "Hertz radius_x: received 0.0; allowed: a .*positive"),
    (groove, (RADIUS, RADIUS), {}, r"radii of ball and groove \(m\): received 0.00635 and -0.00635"),
    (groove, (RADIUS, 0.9 * RADIUS), {}, "A hollow must be rounder than what lies in it"),
    (groove, (RADIUS, -GROOVE), {}, r"radius of the groove \(m\): received -0.0066"),
    (groove, (RADIUS, GROOVE, -5e-3), {}, "radii of ball and raceway"),
    (groove, (RADIUS, GROOVE, 0.0), {}, "raceway.*received 0.0; allowed: numbers other than 0"),
    of=lambda call, arguments, keywords: call(*arguments, **keywords),
)
