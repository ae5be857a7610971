"""Flow resistivity of ground, by what it is."""

CITATION = (
    "M. E. Delany and E. N. Bazley, Applied Acoustics 3 (1970) 105 (impedance of porous material), with the "
    "classes of ground of B. Plovsing (2006), as in D. A. Bies, C. H. Hansen and C. Q. Howard, Engineering "
    "Noise Control, 5th edition, table 5.2."
)
HARD = "hard"
"""Ground that reflects all, and of whose interference only the mean is taken."""
GROUNDS: dict[str, float] = {
    "grass": 80e3,
    "pasture": 200e3,
    "lawn": 500e3,
    "gravel-road": 2e6,
    "asphalt": 20e6,
    "ballast-shoulder": 200e3,
}
"""Flow resistivity, Pa s/m²: the classes C (turf, loose soil) to G (asphalt, concrete) of `CITATION`.

Of ballast none is printed. That of its shoulder is chosen here: the hardest class, D, of those that
CNOSSOS-EU (Directive (EU) 2015/996, 2.5) counts as wholly absorbing, as it counts rail tracks on ballast.
"""
