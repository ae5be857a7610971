"""Films of oil in the contacts of a bearing: how thick they are, and what is left to asperities."""

from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.errors import Finding, Grade, percent
from asperity.scenarios.prepared_bearing import RINGS
from asperity.scenarios.raceway_films import RacewayFilm, films_on
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values, bearing
from asperity.written_numbers import rounded


def films_of(computed: ComputedBearing) -> list[RacewayFilm]:
    """Films on both raceways."""
    return films_on(computed.case, computed.raceways, computed.balls)


def films_group(computed: ComputedBearing) -> Values:
    """Lay out the films of all balls at rest, and under the heaviest load what they do."""
    found = films_of(computed)
    static = computed.case.static
    loads = [getattr(static, f"{ring}_load") for ring in RINGS]
    central = [_over(load, each.film.central) for load, each in zip(loads, found, strict=True)]
    least = [_over(load, each.film.minimum) for load, each in zip(loads, found, strict=True)]
    rms = np.array([each.rms for each in found])
    with np.errstate(divide="ignore"):
        parameter = np.array(least) / rms[:, None, None]
    return {
        bearing.FILM_THICKNESS: central,
        bearing.LEAST_FILM: least,
        bearing.FILM_PARAMETER: parameter,
        bearing.HEAVIEST_FILM: [each.film.central(each.load) for each in found],
        bearing.HEAVIEST_PARAMETER: [each.parameter for each in found],
        bearing.FILM_RMS: rms,
        bearing.FILM_STIFFNESS: [each.film.stiffness(each.load) for each in found],
        bearing.FILM_DAMPING: [each.damping for each in found],
        bearing.FILM_HEATING: [each.film.reduction for each in found],
        bearing.ASPERITY_SHARE: [each.share for each in found],
        bearing.FILM_FORMULA: found[0].film.formula.name,
        bearing.OIL_VISCOSITY: found[0].film.viscosity,
        bearing.OIL_PRESSURE: found[0].film.pressure_viscosity,
    }


def _over(loads: Array, thickness: Any) -> Array:
    """Film under loads, m; missing where there is none."""
    return np.vectorize(lambda load: thickness(load) if load > 0.0 else np.nan)(loads)


def films_doubted(computed: ComputedBearing) -> list[Finding]:
    """What of films is outside of what their formulas are of."""
    findings = []
    for ring, each in zip(RINGS, films_of(computed), strict=True):
        findings.append(
            Finding(
                f"film on the {ring} ring, numbers outside of its fit",
                ", ".join(each.outside) or "none",
                f"none outside of {each.film.formula.fitted_to}",
                Grade.NOTE if each.outside else None,
                *each.film.formula.beyond,
                warned=True,
            )
        )
        if each.rms:
            findings.append(
                Finding(
                    f"film parameter on the {ring} ring",
                    rounded(each.parameter),
                    "3 or more, a full film",
                    None if each.regime == "full film" else Grade.NOTE,
                    f"{each.regime.capitalize()}: asperities carry {percent(each.share)} of the load.",
                    "Take a thicker oil, a higher speed or finer surfaces, or give lubricant.damping_time.",
                )
            )
    return findings


def films_cited(computed: ComputedBearing) -> list[str]:
    """What the formulas of its films are cited by."""
    return [
        films_of(computed)[0].film.formula.source,
        "W. R. D. Wilson and S. Sheu, J. Lubrication Technology 105 (1983) 187 (heating of the inlet).",
        "ASTM D341 and D2270, ISO 3448 (viscosity of oils over temperature).",
    ]


OBSERVER = Observer(
    "bearing_film",
    DECLARED,
    films_group,
    needs=("bearing",),
    asked_of=lambda computed: computed.case.films is not None,
    findings=films_doubted,
    sources=films_cited,
)
