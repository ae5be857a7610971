"""Named ball bearings: main dimensions as they are printed, and what is chosen here where none are."""

PRINTED_BY = (
    "the Bearing Data Center of Case Western Reserve University, for SKF 6205-2RS JEM and 6203-2RS JEM"
)
"""Diameters of balls and pitch circle, there in inches, here rounded to 10 µm."""

BEARINGS: dict[str, dict[str, float]] = {
    "6203": {"balls": 8, "ball_diameter": 6.75e-3, "pitch_diameter": 28.50e-3},
    "6205": {"balls": 9, "ball_diameter": 7.94e-3, "pitch_diameter": 39.04e-3},
}
"""By the keywords of `asperity.structures.ball_bearing.BallBearing`, m."""
CONFORMITY = 0.52
"""Radius of a groove over the diameter of the ball, where none is printed; 0.515 to 0.53 is usual."""
CLEARANCE = 10e-6
"""Diametral clearance of the named bearings, m, chosen here."""
STATIC_PRESSURE = 4.2e9
"""Peak pressure, Pa, from which on a dent of about 1/10 000 of the ball's diameter remains (ISO 76:2006)."""
HARDNESS = 7.0e9
"""Of hardened rings, Pa: about 700 HV, chosen here."""
