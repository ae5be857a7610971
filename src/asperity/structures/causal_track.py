"""A causal track that stands for one with constant loss factors, or with measured stiffnesses.

No material has one stiffness and one loss factor at all frequencies: by Kramers and Kronig a loss factor η
lets the stiffness grow, by 2η/π per neper of frequency. The stiffnesses of the causal track relax
(`asperity.structures.support`), such that the contact force of a wheel is as nearly as possible that on
the track with constant loss factors, in each one-third octave. A measured stiffness over frequency is taken
for what it is: the elements aim at it instead.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import scipy
from scipy.linalg import block_diag

from asperity.arguments import Array, Complex, NDArray
from asperity.spectra import third_octave_bands
from asperity.store import Store, content_key, made
from asperity.structures.support import ConstantLoss, Losses, Relaxation, StiffnessTable, relaxing
from asperity.structures.track import Track
from asperity.structures.track_parameters import Relaxations

LOWEST, HIGHEST = 5.0, 5000.0
"""One-third octaves over which the contact force is fitted, Hz."""
FREQUENCIES = tuple(float(f) for f in 10.0 ** (1.0 + np.arange(10) / 3.0))
"""Of the Maxwell elements, three in a decade, Hz."""
LEAST_STATIC = 0.4
"""Least stiffness at rest, relative to the nominal one; 1/(1 + 2η) where that is more (`least_static`)."""
WHEELS = (300.0, 600.0, 1200.0)
"""Masses of the wheels whose contact force is fitted, kg."""
CONTACT = 1.2e9
"""Stiffness of their contact, N/m."""
LARGE = 0.5
"""Errors beyond this, dB, weigh more than their squares: the largest shall be small, not the mean alone."""
DEPARTURE = 0.05
"""Weight of a stiffness that departs by its nominal value, beside an error of 1 dB."""
RAIL = 300.0
"""Frequency at which the rail keeps its nominal stiffness, Hz."""
POSITIONS, LINES = 6, 8
"""Places in half a bay, and frequencies in a band."""
STEPS, SETTLED = 40, 1e-3
"""Most steps of the fit, and the relative gain of a step that ends it."""
CHOICES = [
    LOWEST, HIGHEST, FREQUENCIES, LEAST_STATIC, WHEELS, CONTACT, LARGE, DEPARTURE, RAIL, POSITIONS, LINES,
    STEPS, SETTLED,
]  # fmt: skip
"""All that a fit depends on beside its track."""

Linearised = Callable[[Array], tuple[Array, Array]]


def causal_track(track: Track, cache: Store | None = None) -> Track:
    """Put stiffnesses that relax in the place of loss factors and tables; a causal track stays as it is.

    Least squares of the level of the mean square of 1/(α_W + α_C + α_R) over half a bay and each band, for
    three rigid wheels on a linear contact, in the strengths of the Maxwell elements of the springs below the
    rail. None of them is negative, so that the track is passive. The rail, whose loss factor is small, keeps
    it in all bands, and its stiffness at 300 Hz, and so does a sleeper that bends. At rest, and under a load
    that hardly moves, the track is softer than the nominal one. Of bays that differ, the nominal one is
    fitted. A cache keeps the fit.
    """
    if track.is_causal:
        return track
    if track not in _fitted:
        _fitted[track] = replace(track, relaxations=_relaxations(track.regular, cache))
    return _fitted[track]


_fitted: dict[Track, Track] = {}
"""Causal tracks that are known, by those they stand for."""


def _relaxations(track: Track, cache: Store | None) -> Relaxations:
    """Fit, or look up, what stands for the loss factors of a track."""

    def make() -> dict[str, Array]:
        fit = _Fit(track)
        unknowns = _least_squares(fit.linearised, fit.start()) if fit.lossy else np.zeros(0)
        found = vars(fit.track_of(unknowns).relaxations)
        return {part: np.array([r.static, *r.strengths]) for part, r in found.items() if r is not None}

    key = content_key("causal-track", track.parameters, CHOICES)
    kept = made(cache, key, make)
    plain = {part: values.tolist() for part, values in kept.items()}
    return Relaxations(**{part: Relaxation(c[0], tuple(c[1:]), FREQUENCIES) for part, c in plain.items()})


def least_static(factor: float) -> float:
    """Least stiffness at rest, relative to the nominal one, of pads and ballast with a loss factor η.

    1/(1 + 2η), for by 2η a loss factor stiffens that is kept over π nepers, from 5 Hz to 115 Hz; at least
    `LEAST_STATIC`.
    """
    return max(1.0 / (1.0 + 2.0 * factor), LEAST_STATIC)


def _least(losses: Losses) -> float:
    """The same of any losses; below its first frequency a table goes on with the loss factor there."""
    if isinstance(losses, StiffnessTable):
        return losses.static * least_static(losses.imaginary[0] / losses.real[0])
    assert isinstance(losses, ConstantLoss)
    return least_static(losses.factor or 0.0)


def _rail(factor: float) -> Relaxation:
    """The loss factor in all bands."""
    losses = relaxing(2.0 * np.pi * third_octave_bands(LOWEST, HIGHEST)[0], FREQUENCIES).imag[:, 1:]
    strengths = scipy.optimize.nnls(losses, np.full(len(losses), factor))[0]
    gained = float(relaxing(2.0 * np.pi * RAIL, FREQUENCIES).real[1:] @ strengths)
    return Relaxation(max(1.0 - gained, LEAST_STATIC), tuple(strengths.tolist()), FREQUENCIES)


class _Fit:
    """Errors of the contact force in bands, as a function of the Maxwell elements between rail and ground."""

    def __init__(self, track: Track) -> None:
        self.track = track
        self.rail = _rail(track.rail_loss_factor) if track.rail_loss_factor else None
        self.sleeper = _rail(track.sleeper_loss_factor) if track.sleeper_loss_factor else None
        beams = "rail", "sleeper"
        self.lossy = {part: losses for part, losses in track.lossy.items() if part not in beams}
        centres, low, high = third_octave_bands(LOWEST, HIGHEST)
        steps = (np.arange(LINES) + 0.5) / LINES
        self.omega = 2.0 * np.pi * (low[:, None] * (high / low)[:, None] ** steps).ravel()
        self.basis = relaxing(self.omega, FREQUENCIES)
        coarse = relaxing(2.0 * np.pi * centres, FREQUENCIES)
        self.coarse = np.concatenate([coarse.real, coarse.imag])
        self.least = np.zeros((len(self.lossy), 1 + len(FREQUENCIES)))
        self.least[:, 0] = [_least(losses) for losses in self.lossy.values()]
        wanted = [losses.at(2.0 * np.pi * centres) + np.zeros(len(centres)) for losses in self.lossy.values()]
        self.aims = [np.concatenate([each.real, each.imag]) for each in wanted]
        self.places = track.places(POSITIONS)
        self.carried = [1.0 / CONTACT - 1.0 / (mass * self.omega**2) for mass in WHEELS]
        nominal = self.receptance(track)
        self.wanted = [self.banded(np.abs(1.0 / (carried + nominal)) ** 2) for carried in self.carried]

    def receptance(self, track: Track) -> Complex:
        """Receptances of the rail at the places, (places, f)."""
        waves = track.waves(self.omega)
        return np.array([waves.receptance(x, x) for x in self.places])

    def banded(self, values: NDArray[Any]) -> NDArray[Any]:
        """Mean over places and over the frequencies of each band, (places, f, …) → (bands, …)."""
        mean = values.mean(axis=0)
        return mean.reshape(-1, LINES, *mean.shape[1:]).mean(axis=1)

    def parts(self, unknowns: Array) -> Array:
        """Coefficients of spring and elements, (lossy parts, 1 + elements)."""
        return self.least + unknowns.reshape(self.least.shape)

    def track_of(self, unknowns: Array, stiffer: str = "", share: float = 0.0) -> Track:
        """The track with the elements that the unknowns stand for, one part stiffer by a share."""
        found = {}
        for name, part in zip(self.lossy, self.parts(unknowns), strict=True):
            static, *strengths = (float(c) for c in part * (1.0 + (share if name == stiffer else 0.0)))
            found[name] = Relaxation(static, tuple(strengths), FREQUENCIES)
        return replace(self.track, relaxations=Relaxations(self.rail, sleeper=self.sleeper, **found))

    def start(self) -> Array:
        """Unknowns that depart least from the constant loss factors and the tables."""
        missing = [aim - self.coarse @ least for aim, least in zip(self.aims, self.least, strict=True)]
        return np.concatenate([np.zeros(0), *(scipy.optimize.nnls(self.coarse, aim)[0] for aim in missing)])

    def linearised(self, unknowns: Array) -> tuple[Array, Array]:
        """Weighted errors and departures, (n,), and their slopes, (n, unknowns)."""
        receptance = self.receptance(self.track_of(unknowns))
        share = 1e-6
        columns = []
        for name, part in zip(self.lossy, self.parts(unknowns), strict=True):
            stiffer = self.receptance(self.track_of(unknowns, name, share))
            slope = (stiffer - receptance) / (share * (self.basis @ part))
            columns.append(slope[..., None] * self.basis)
        change = np.concatenate(columns, axis=-1)
        pairs = zip(self.carried, self.wanted, strict=True)
        rows = [self._errors(carried, wanted, receptance, change) for carried, wanted in pairs]
        residuals, slopes = zip(*rows, self._departures(unknowns), strict=True)
        return np.concatenate(residuals), np.vstack(slopes)

    def _errors(
        self, carried: Array, wanted: Array, receptance: Complex, change: Complex
    ) -> tuple[Array, Array]:
        """Errors of the level in each band, dB, large ones weighted, and their slopes."""
        transfer = 1.0 / (carried + receptance)
        power = np.abs(transfer) ** 2
        level = self.banded(power)
        share = 1.0 / np.sqrt(len(WHEELS))
        error = 10.0 * np.log10(level / wanted)
        rising = self.banded((-2.0 * power * transfer)[..., None] * change).real
        slopes = 10.0 / np.log(10.0) * rising / level[:, None]
        weight = np.sqrt(1.0 + (error / LARGE) ** 2)
        return share * weight * error, share * (2.0 * weight - 1.0 / weight)[:, None] * slopes

    def _departures(self, unknowns: Array) -> tuple[Array, Array]:
        """Departures from the constant loss factors and tables at the centres of bands, and their slopes."""
        aims = np.array(self.aims)
        departures = self.parts(unknowns) @ self.coarse.T - aims
        return DEPARTURE * departures.ravel(), DEPARTURE * block_diag(*[self.coarse] * len(aims))


def _least_squares(linearised: Linearised, start: Array) -> Array:
    """Unknowns, not negative, of the least sum of squares: Levenberg-Marquardt, its steps by `nnls`."""
    unknowns = start
    damping = 1e-3
    residual, slope = linearised(unknowns)
    for _ in range(STEPS):
        brake = np.sqrt(damping) * np.linalg.norm(slope, axis=0)
        aim = np.concatenate([slope @ unknowns - residual, brake * unknowns])
        tried = scipy.optimize.nnls(np.vstack([slope, np.diag(brake)]), aim, maxiter=100 * aim.size)[0]
        found = linearised(tried)
        if (squares := residual @ residual) == 0.0:  # losses so small that nothing is to be gained
            return unknowns
        gain = 1.0 - (found[0] @ found[0]) / squares
        damping *= 0.1 if gain > 0.0 else 10.0
        if gain > 0.0:
            unknowns = tried
            residual, slope = found
        if 0.0 < gain < SETTLED or damping > 1e6:
            break
    return unknowns
