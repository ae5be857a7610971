"""What the results of all kinds of case have in common: provenance, parameters, numerics."""

from __future__ import annotations

import json
import warnings
from collections import Counter
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from functools import partial
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity import __version__
from asperity.config.case import Case
from asperity.contact.batched import find_device
from asperity.errors import Grade, PhysicsWarning
from asperity.laws import baselines, reference, spec_of
from asperity.results import checked
from asperity.scenarios.chain import Chain
from asperity.scenarios.chance import PLACES, ForceTransfer, chance_and_start, values_seen
from asperity.scenarios.law_choice import LawChoice
from asperity.scenarios.laws import working_point
from asperity.schema import VERSION, Entry, attributes, provenance, spectra
from asperity.spectra import (
    LEAST_PRODUCT,
    MOST_START,
    band_product,
    level_deviation,
)

SEGMENT = (0.025, 0.2)
"""Shortest and longest segment of the spectra, s: lines 40 Hz and 5 Hz apart."""
METHOD = (
    "O. Lundberg, licentiate thesis, KTH Stockholm (2014).",
    "Lundberg, Finnveden, Björklund, Pärssinen and Lopez Arteaga, A nonlinear state-dependent model for "
    "vibrations excited by roughness in rolling contacts, submitted to J. Sound Vib. (2014): its paper A.",
    "Lundberg, Nordborg, Lopez Arteaga and Finnveden, Estimation of nonlinearities in the wheel-rail rolling "
    "noise generation process, ISMA (2014): its paper B.",
    "H. Hertz, J. reine angew. Math. 92 (1882) 156 (contact of smooth bodies).",
)
ROUGH_CONTACT = (
    "A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377 (influence coefficients).",
    "I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206 (projected conjugate gradients).",
    "E. A. H. Vollebregt, A new solver for the elastic normal contact problem using conjugate gradients, "
    "deflation, and an FFT-based preconditioner (2014).",
)
BANDS = ("IEC 61260-1:2014 (one-third octaves, base 10).",)
EXPECTED = ("G. Matheron, Economic Geology 58 (1963) 1246 (kriging, of the expected errors of laws).",)


def assembled(
    chain: Chain,
    groups: Mapping[str, xarray.Dataset],
    caught: list[warnings.WarningMessage],
    *,
    title: str,
    verdict: str,
    numerics: Iterable[tuple[str, str]],
    citations: tuple[str, ...] = (),
    choice: LawChoice | None = None,
) -> xarray.DataTree:
    """Put the groups of a result, but for scenario, together with provenance.

    The title says what was rolled, the verdict what the run says. `numerics` are names and values of the
    computation beyond those that all kinds of case have, `citations` sources beyond those of the methods
    that they share; choice of a law, from the law accuracy map.
    """
    case = chain.case
    every = (*numerics, *(choice.rows() if choice else ()))
    scenario = {provenance.NUMERICS: json.dumps(_listed(chain, every), ensure_ascii=False)}
    if choice is not None:
        scenario[provenance.EXPECTED_ERRORS] = json.dumps(choice.entries())
    held = scenario_group(case).assign_attrs(attributes(scenario))
    tree = xarray.DataTree.from_dict({"/scenario": held, **groups})
    tree.attrs = attributes(
        {
            provenance.TITLE: title,
            provenance.ASPERITY_VERSION: __version__,
            provenance.SCHEMA_VERSION: VERSION,
            provenance.CREATED: datetime.now(UTC).isoformat(timespec="seconds"),
            provenance.CASE: case.text,
            provenance.SEED: case.seed,
            provenance.CITATIONS: json.dumps(_sources(chain, choice) + citations, ensure_ascii=False),
            provenance.VERDICT: verdict,
            provenance.WARNINGS: json.dumps(_collected(caught), ensure_ascii=False),
        }
    )
    return checked(tree)


def scenario_group(case: Case) -> xarray.Dataset:
    """Lay out what was asked for."""
    scenario = {
        provenance.KIND: case.kind,
        provenance.PARAMETERS: json.dumps(case.parameters(), ensure_ascii=False),
        provenance.LAWS: json.dumps([spec_of(n).entry() for n in case.laws], ensure_ascii=False),
    }
    return xarray.Dataset(attrs=attributes(scenario))


def _sources(chain: Chain, choice: LawChoice | None) -> tuple[str, ...]:
    """Sources of the methods that a run of any kind used."""
    rough = ROUGH_CONTACT if chain.reduction is not None else ()
    return METHOD + rough + BANDS + (EXPECTED if choice is not None else ())


def _collected(caught: list[warnings.WarningMessage]) -> list[dict[str, Any]]:
    """Warnings on the physics, each once with its number, the gravest first."""
    physics = [m.message for m in caught if isinstance(m.message, PhysicsWarning)]
    counts = Counter((type(m).__name__, str(m), m.grade) for m in physics)
    order = list(Grade)
    return [
        {"category": category, "message": message, "grade": grade.value, "count": n}
        for (category, message, grade), n in sorted(counts.items(), key=lambda c: -order.index(c[0][2]))
    ]


def _listed(chain: Chain, numerics: Iterable[tuple[str, str]]) -> list[dict[str, str]]:
    every = [*_numerics(chain), *numerics]
    every += [(f"wall time, {part}", f"{seconds:.2f} s") for part, seconds in chain.seconds.items()]
    return [{"name": name, "value": value} for name, value in every]


def _numerics(chain: Chain) -> Iterable[tuple[str, str]]:
    case, (nx, ny) = chain.case, chain.shape.body.shape
    yield "time step", f"{case.time_step * 1e6:.4g} µs"
    yield "time steps", f"{max(len(r.time) for r in chain.runs.values()) - 1}"
    yield "contact window", f"{nx} × {ny} cells of {case.contact.spacing * 1e6:.4g} µm"
    if (device := find_device()) is not None:
        yield "scans solved on", device.name
    if chain.reduction is not None:
        solves, iterations = chain.reduction.counts.solved, chain.reduction.counts.iterations
        yield "contacts solved for the filters", f"{solves}"
        yield "iterations per contact", f"{iterations / max(solves, 1):.1f}"
        orders = {found.taps.shape[1] - 1 for found in chain.reduction.filters.values()}
        yield "filter order J", ", ".join(map(str, sorted(orders)))
    if chain.scan is not None:
        precision = "single" if chain.scan.single else "double"
        yield "contacts solved for the table", f"{chain.scan.counts.solved} in {precision} precision"
        yield "contacts of the table not converged", f"{chain.scan.counts.unconverged}"
    main, first = next(iter(chain.runs.items()))
    thirds = ", ".join(
        f"{rms_about_mean(part):.3g}" for part in np.array_split(first.contact_force, 3, axis=1)
    )
    yield f"rms of the contact force in thirds of the record, {main}", f"{thirds} N"
    for name, run in chain.runs.items():
        yield f"time steps not converged, {name}", f"{run.unconverged_steps}"


def spectrum_segment(samples: int, step: float) -> int:
    """Length of the segments that spectra are averaged over, in time steps.

    A quarter of the record within `SEGMENT`, so that windows leave most of it.
    """
    shortest, longest = (round(length / step) for length in SEGMENT)
    return min(max(samples // 4, shortest), longest, samples)


def difference_to(baseline: str) -> Entry:
    """Find the entry of the force levels over those of a baseline."""
    role = spec_of(baseline).role
    assert role is not None
    return spectra.FORCE_LEVEL_DIFFERENCES[role]


def sureness(
    chain: Chain, band: NDArray[np.float64], time: float, transfer: ForceTransfer | None
) -> dict[Entry, Any]:
    """Lay out how sure the levels of bands (b,), Hz, are: B T for an averaging time, s, chance, and start.

    By the first contact: others of one path hold much the same.
    """
    found: dict[Entry, Any] = {}
    run = next(iter(chain.runs.values()))
    values = band_product(band, time) * values_seen(run.contact_force[0], chain.case.time_step, band)
    if transfer is not None:
        record, (first, last) = float(run.time[-1]), run.positions[0, [0, -1]]
        places = first + (last - first) * (np.arange(PLACES) + 0.5) / PLACES
        _, stiffness = working_point(chain.case.contact, chain.shape, chain.reduction)
        linear = partial(transfer, stiffness, places)
        held, start = chance_and_start(linear, band, chain.case.settled_time, record)
        values = np.minimum(values, held * time / record)
        found[spectra.START_SHARE] = spectra.START_SHARE.variable(start, most=MOST_START)
    return found | {
        spectra.BAND_TIME_PRODUCT: product_of_bands(spectra.BAND_TIME_PRODUCT, band, time),
        spectra.LEVEL_DEVIATION: level_deviation(values),
    }


def rms_about_mean(force: NDArray[np.float64]) -> float:
    """Rms of contact forces (c, n), N, each about its own mean."""
    return float(np.sqrt(np.mean(np.var(force, axis=-1))))


def drawn(frequency: NDArray[np.float64], highest: float) -> NDArray[np.bool_]:
    """Which lines of a spectrum are kept: up to the edge of the one-third octave of the highest, Hz."""
    return np.asarray((frequency > 0.0) & (frequency <= 1.13 * highest))


def level_differences(laws: list[str], force_level: np.ndarray) -> dict[Entry, xarray.Variable]:
    """Differences of force levels (laws, bands), dB, to the linear laws, and to a reference if any."""
    compared = {difference_to(law): law for law in baselines(laws)}
    if (solved := reference(laws)) is not None:
        compared[spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE] = solved
    return {
        entry: entry.variable(force_level - force_level[laws.index(law)], reference=law)
        for entry, law in compared.items()
    }


def product_of_bands(entry: Entry, centres: np.ndarray, time: float) -> xarray.Variable:
    """Lay out the product B T of bands, from which one sees which levels say little.

    Centres (b,), Hz or cycles per metre; averaging time, s, or length, m. The least product of a level that
    says something is in its attributes.
    """
    return entry.variable(band_product(centres, time), least=LEAST_PRODUCT)
