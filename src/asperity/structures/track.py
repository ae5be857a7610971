"""The infinite track: a rail on supports, each a dynamic stiffness over frequency, and its decay rates."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, finite_array, shown
from asperity.errors import InputError
from asperity.reference.railways import named_track
from asperity.structures import periodic_rail, track_parameters
from asperity.structures import support as chains
from asperity.structures.cell_waves import CellWaves, cell_waves, static_receptance_of_cell
from asperity.units import written

_LOSSES = [(f"{layer}_damping", f"{layer}_loss_factor") for layer in track_parameters.LAYERS]
_INSTEAD = [*_LOSSES, *((b, a) for a, b in _LOSSES), *(("pad_table", each) for each in _LOSSES[0])]
"""Pairs of parameters of which the first, where it is given, replaces the second."""
_SCALED = ("stiffness", "damping")
"""Of pads and ballast, in bays that differ."""
VANISHING_DAMPING = 1e-9  # relative; picks the outgoing wave where nothing in the track dissipates


@dataclass(frozen=True)
class Track(track_parameters.TrackParameters):
    """Rail of infinite length on supports, Euler-Bernoulli or Timoshenko.

    Each support is a chain: a pad on a half sleeper, rigid or bending, on a pad of its own if there is one,
    on ballast, and, if they are given, a mass of ballast and the subgrade. Supports are equal, or repeat
    after a cell of bays that differ. All stiffnesses, dampers and masses are those under one rail.

    Parameters
    ----------
    bending_stiffness : float
        E I, N m^2.
    mass_per_length : float
        m', kg/m.
    pad_stiffness : float
        k_p, N/m.
    sleeper_mass : float
        m_s, half a sleeper, kg; zero is allowed.
    ballast_stiffness : float
        k_b, N/m; infinite where blocks or rails lie on a rigid slab.
    sleeper_spacing : float
        L, m.
    rail_loss_factor : float
        E (1 + i eta), and for Timoshenko G likewise.
    pad_damping, pad_loss_factor : float, optional
        Viscous, N s/m, or hysteretic, k_p (1 + i eta); one of them, or none for no damping.
    pad_stiffens : bool
        Whether a pad that has a loss factor stiffens over frequency, as in
        `asperity.structures.support.stiffening`; `pad_stiffness` is that at 300 Hz.
    ballast_damping, ballast_loss_factor : float, optional
        The same for the ballast.
    shear_stiffness, rotary_inertia : float, optional
        G A kappa, N, and rho I, kg m: both for a Timoshenko rail, none for Euler-Bernoulli.
    sleeper_bending_stiffness, sleeper_length, seat_distance : float, optional
        Of a whole sleeper that bends, N m^2 and m, and the distance of its two seats, m.
    sleeper_loss_factor : float, optional
        Of its bending stiffness.
    under_sleeper_pad_stiffness, ballast_mass, subgrade_stiffness : float, optional
        Layers that the support has beside pad and ballast, N/m and kg; springs with a damping or a loss
        factor of their own, as the pad.
    continuous : bool
        Whether the supports are spread evenly along the rail: s(omega) = K(omega)/L.
    rail_damper_mass, rail_damper_frequency, rail_damper_loss_factor : float, optional
        Of a `asperity.structures.support.tuned_damper` in the middle of each bay: kg, Hz, 1.
    pad_table : StiffnessTable, optional
        Measured stiffness of the pad over frequency, to which `pad_stiffness` gives the scale: its real part
        at 300 Hz, by default that of the table in `Track.named`.
    measured_sleeper : MeasuredSleeper, optional
        A sleeper by its modes, of the half mass `sleeper_mass`, instead of one that is rigid or bends.
    name : str
        What the set is called.
    sources : tuple of str
        Where the values come from, one text per parameter.
    relaxations : Relaxations, optional
        Causal stiffnesses that stand for the loss factors, as `asperity.structures.causal_track` finds them.
    bays : Bays, optional
        How the bays of a cell differ, after which the track repeats; of equal bays by default.
    opposed : bool
        Whether the other rail is pressed upwards by as much, which a sleeper that bends feels.

    Raises
    ------
    InputError
        If a value is out of range, one element has both viscous damping and a loss factor, or only one
        of shear stiffness and rotary inertia is given.

    Notes
    -----
    Vertical motion of one rail. Euler-Bernoulli overestimates the
    pinned-pinned frequency of a UIC 60 rail at 0.6 m by a third (1420 for 1063 Hz); above about 5 kHz
    the section of a rail deforms. A constant loss factor is not causal: in time a causal track stands
    for it (`asperity.structures.causal_track`). Viscous damping is causal.

    Examples
    --------
    >>> from asperity import Track
    >>> track = Track.named("x2000", pad_stiffness=300e6)
    >>> sleeper, mid_span = (abs(track.receptance(1000.0, x, x)) for x in (0.0, 0.3))
    >>> bool(mid_span > sleeper)  # near the pinned-pinned frequency
    True
    """

    @classmethod
    def named(cls, name: str, **overrides: Any) -> Track:
        """A named set of parameters with its sources.

        Parameters
        ----------
        name : str
            One of `asperity.reference.railways.TRACKS`.
        **overrides
            Physical parameters of `Track` that replace those of the set. A viscous damping replaces the loss
            factor of the same element, and the other way round.

        Returns
        -------
        Track

        Raises
        ------
        InputError
            If the name or a parameter is unknown, or a value is out of range.
        """
        parameters = named_track(name)
        for key in overrides:
            if key not in _PARAMETERS:
                raise InputError("track parameter", repr(key), "one of " + ", ".join(_PARAMETERS))
        for one, other in _INSTEAD:
            if overrides.get(one) is not None and other not in overrides:
                parameters.pop(other, None)
        if overrides.get("pad_table") is not None:
            overrides = {"pad_stiffness": overrides["pad_table"].nominal} | overrides
        if overrides.get("measured_sleeper") is not None:
            overrides = {"sleeper_mass": overrides["measured_sleeper"].mass} | overrides
        sources = {key: source for key, (_, source) in parameters.items()}
        sources |= dict.fromkeys(overrides, "given here")
        values: dict[str, Any] = {"name": name} | {key: value for key, (value, _) in parameters.items()}
        values["sources"] = tuple(f"{key}: {source}" for key, source in sources.items())
        return cls(**(values | overrides))

    def __repr__(self) -> str:
        rail = f"{written(self.bending_stiffness, 'N m^2', 'MN m^2')}, {self.mass_per_length:g} kg/m"
        pads, ballast = (
            written(stiffness, "N/m", "MN/m") for stiffness in (self.pad_stiffness, self.ballast_stiffness)
        )
        sleepers = "spread evenly" if self.continuous else f"every {self.sleeper_spacing:g} m"
        name = f"Track {self.name}" if self.name else "Track"
        differ = f", {len(self.bays.spacing)} bays that differ" if self.bays else ""
        return (
            f"<{name}: rail {rail}; pads {pads}; half sleepers {self.sleeper_mass:g} kg {sleepers}{differ}; "
            f"ballast {ballast}>"
        )

    @property
    def parameters(self) -> dict[str, Any]:
        """All that its motion depends on, by name."""
        return {key: value for key, value in asdict(self).items() if key not in ("name", "sources")}

    def _losses(self, part: str) -> chains.Losses:
        relaxed: chains.Losses | None = getattr(self.relaxations, part, None)
        factor = getattr(self, f"{part}_loss_factor")
        over_frequency = None
        if part == "pad":
            over_frequency = chains.stiffening(factor) if self.pad_stiffens else self.pad_table
        return relaxed or over_frequency or chains.ConstantLoss(factor)

    @property
    def rail(self) -> periodic_rail.Rail:
        """The rail without supports."""
        section = self.shear_stiffness, self.rotary_inertia
        return periodic_rail.Rail(
            self.bending_stiffness, self.mass_per_length, self._losses("rail"), *section
        )

    @property
    def springs(self) -> dict[str, chains.Spring]:
        """Springs between rail and ground by their names of `LAYERS`, those that give way at all."""
        return {
            layer: chains.Spring(stiffness, self._losses(layer), getattr(self, f"{layer}_damping") or 0.0)
            for layer in track_parameters.LAYERS
            if (stiffness := getattr(self, f"{layer}_stiffness") or np.inf) < np.inf
        }

    @property
    def elements(self) -> dict[str, chains.Element]:
        """What lies between rail and ground, by name, from the rail down."""
        springs = self.springs
        sleeper: chains.Element = self.measured_sleeper or chains.RigidMass(self.sleeper_mass)
        if self.sleeper_bending_stiffness is not None:
            beam = self.sleeper_length, self.sleeper_bending_stiffness, self.seat_distance
            sleeper = chains.BendingSleeper(self.sleeper_mass, *beam, self._losses("sleeper"), self.opposed)
        bed = {} if self.ballast_mass is None else {"ballast mass": chains.RigidMass(self.ballast_mass)}
        found = {"pad": springs.pop("pad"), "sleeper": sleeper} | springs
        subgrade = {"subgrade": found.pop("subgrade")} if "subgrade" in found else {}
        return found | bed | subgrade

    @property
    def support(self) -> chains.Chain:
        """What the rail lies on at each sleeper."""
        return chains.Chain(tuple(self.elements.values()))

    @property
    def damper(self) -> chains.Chain | None:
        """What hangs at the rail in the middle of each bay."""
        if self.rail_damper_mass is None:
            return None
        assert self.rail_damper_frequency is not None
        assert self.rail_damper_loss_factor is not None
        tuning = self.rail_damper_frequency, self.rail_damper_loss_factor
        return chains.tuned_damper(self.rail_damper_mass, *tuning)

    @property
    def under_one_rail(self) -> tuple[Track, ...]:
        """Tracks whose mean receptance is that of a force on one rail alone, as of a hammer.

        Half of it presses both rails alike, and half of it one against the other, where sleepers bend in
        their odd modes, too. Of rigid sleepers each half moves with its own rail.
        """
        bends = self.sleeper_bending_stiffness is not None
        return (self, replace(self, opposed=True)) if bends else (self,)

    @property
    def lossy(self) -> dict[str, chains.Losses]:
        """Losses that are not causal, by part: of the rail, of the springs below it, and of a sleeper."""
        parts = {"rail": self.rail.losses} | {layer: each.losses for layer, each in self.springs.items()}
        if self.sleeper_bending_stiffness is not None:
            parts["sleeper"] = self._losses("sleeper")
        return {
            part: losses
            for part, losses in parts.items()
            if isinstance(losses, chains.StiffnessTable)
            or (isinstance(losses, chains.ConstantLoss) and losses.factor)
        }

    @property
    def is_causal(self) -> bool:
        """Whether it responds after a force only: no constant loss factor, or relaxations instead."""
        return not self.lossy

    @property
    def cell_bays(self) -> int:
        """Number of bays after which the track repeats."""
        return len(self._lengths)

    @property
    def has_cells(self) -> bool:
        """Whether it has several points in one period: bays that differ, or rail dampers beside supports."""
        return bool(self.bays or (self.damper and not self.continuous))

    @property
    def period(self) -> float:
        """Length after which the track repeats, m."""
        return self.cell_bays * self.sleeper_spacing

    @property
    def sleepers(self) -> Array:
        """Places of the sleepers of a cell (n,), from zero, m."""
        return np.concatenate([[0.0], np.cumsum(self._lengths[:-1])])

    @property
    def regular(self) -> Track:
        """The track whose bays are all nominal."""
        return replace(self, bays=None) if self.bays else self

    @property
    def bay_tracks(self) -> list[Track]:
        """Tracks of equal bays, one for each bay of the cell, on such supports as it begins with."""
        if not self.bays:
            return [self]
        regular = self.regular
        return [regular.scaled(*each) for each in zip(self.bays.pad, self.bays.ballast, strict=True)]

    def scaled(self, pad: float, ballast: float) -> Track:
        """The track with pads and ballast scaled, their damping with them."""
        parts = (("pad", pad), ("ballast", ballast))
        scaled = {f"{part}_{what}": factor for part, factor in parts for what in _SCALED}
        given = {key: factor * getattr(self, key) for key, factor in scaled.items() if getattr(self, key)}
        return replace(self, **given)

    @property
    def mid_spans(self) -> Array:
        """Places half way between the sleepers of a cell (n,), m."""
        return self.sleepers + 0.5 * self._lengths

    @property
    def _lengths(self) -> Array:
        """Of the bays of a cell, m."""
        return self.sleeper_spacing * (self.bays.lengths if self.bays else np.ones(1))

    def sleeper_near(self, x: float) -> tuple[float, float]:
        """Places of the sleeper nearest to one, m, and of the middle of the bay behind it."""
        cells = np.floor(x / self.period) + np.arange(-1, 2)[:, None]
        sleepers, middles = ((each + self.period * cells).ravel() for each in (self.sleepers, self.mid_spans))
        nearest = np.argmin(np.abs(sleepers - x))
        return float(sleepers[nearest]), float(middles[nearest])

    def places(self, count: int) -> Array:
        """Places to average over, m: so many in half a bay, its own mirror image, or all along other bays."""
        if not self.bays:
            return (np.arange(count) + 0.5) * 0.5 * self.sleeper_spacing / count
        return (np.arange(2 * count * self.cell_bays) + 0.5) * 0.5 * self.sleeper_spacing / count

    @cached_property
    def nominal(self) -> Track:
        """The track with its constant loss factors and its table, without relaxations."""
        return replace(self, relaxations=None)

    @property
    def is_damped(self) -> bool:
        """Whether anything in the track dissipates."""
        damped = any(spring.damping for spring in self.springs.values())
        damped = damped or bool(self.measured_sleeper and any(self.measured_sleeper.damping_ratios))
        return bool(damped or self.relaxations or self.lossy or self.damper)

    def waves(self, omega: ArrayLike) -> periodic_rail.PeriodicWaves | CellWaves:
        """The two waves of the supported rail at angular frequencies (f,), rad/s, as in `Chain`.

        Without any damping the outgoing wave is that of a damping which vanishes. An `InputError` says if the
        frequency is so high that a wave decays by more than exp(-200) in one bay.
        """
        omega = np.atleast_1d(np.asarray(omega, dtype=complex))
        if not self.is_damped:
            omega = omega * (1.0 - VANISHING_DAMPING * 1j)
        rail = self.rail
        spacing = self.sleeper_spacing
        damper = self.damper
        if self.continuous:
            foundation = self.support.stiffness(omega) / spacing
            if damper is not None:
                foundation = foundation + damper.stiffness(omega) / spacing
            return periodic_rail.periodic_waves(*rail.waves(omega, foundation), np.zeros_like(omega), spacing)
        if not self.has_cells:
            return periodic_rail.periodic_waves(*rail.waves(omega), self.support.stiffness(omega), spacing)
        points = np.array([each.support.stiffness(omega) for each in self.bay_tracks])
        lengths = self._lengths
        if damper is not None:
            hung = np.broadcast_to(damper.stiffness(omega), points.shape)
            points = np.stack([points, hung], axis=1)
            lengths = np.repeat(0.5 * lengths, 2)
        return cell_waves(*rail.waves(omega), points.reshape(-1, omega.size), lengths, self.cell_bays)

    def receptance(self, frequency: ArrayLike, x: ArrayLike, x0: ArrayLike) -> Complex:
        """Displacement at `x` per harmonic force at `x0`.

        Parameters
        ----------
        frequency : array_like
            Hz, positive. Time factor exp(+i omega t).
        x, x0 : array_like
            Positions of the response and of the force, m from a sleeper; of one shape.

        Returns
        -------
        ndarray of complex
            m/N, of the shapes of positions and `frequency`, one after the other.

        Raises
        ------
        InputError
            If a frequency is not positive or a position not finite.

        Notes
        -----
        Exact for the infinite track: Floquet sum in closed form.
        """
        at = finite_array("frequency (Hz)", frequency, "finite positive numbers", above=0.0)
        what = "positions on the track (m)"
        allowed = "finite numbers, as many for the response as for the force"
        to, of = (finite_array(what, each, allowed) for each in (x, x0))
        if to.shape != of.shape:
            raise InputError(what, f"{shown(x)} and {shown(x0)}", allowed)
        waves = self.waves(2.0 * np.pi * at.ravel())
        pairs = zip(to.flat, of.flat, strict=True)
        return np.array([waves.receptance(*pair) for pair in pairs]).reshape((*to.shape, *at.shape))

    @property
    def foundation_stiffness(self) -> float:
        """Static stiffness of the supports per length s = K(0)/L, N/m^2."""
        static = np.mean([each.support.static for each in self.bay_tracks])
        return float(static) / self.sleeper_spacing

    @property
    def bow_length(self) -> float:
        """Characteristic length of the rail under a load on a continuous foundation, (4 B/s)^(1/4), m."""
        return float((4.0 * self.bending_stiffness / self.foundation_stiffness) ** 0.25)

    def static_deflection(self, force: float, x: float = 0.0) -> float:
        """Deflection under a constant force at rest, at the force.

        Parameters
        ----------
        force : float
            N.
        x : float
            Position of the force, m from a sleeper.

        Returns
        -------
        float
            m. Exact for discrete supports; with relaxations, when all of them have come to an end.
        """
        spacing = self.sleeper_spacing
        rail = self.rail.static
        if self.continuous:
            return force * self.rail.deflection_on(self.foundation_stiffness)
        if not self.bays:
            return force * periodic_rail.static_receptance(*rail, self.support.static, spacing, x % spacing)
        supports = np.array([each.support.static for each in self.bay_tracks])
        return force * static_receptance_of_cell(*rail, supports, self._lengths, x)

    @property
    def critical_speed(self) -> float:
        """Critical speed of the continuous foundation (4 s B/m^2)^(1/4), m/s.

        The mass m is that of rail and sleepers together, m' + m_s/L, which gives the smaller speed: at
        the low frequencies of a constant moving force the sleepers move with the rail, and so do ballast and
        rail dampers that have a mass.
        """
        more = (self.ballast_mass or 0.0) + (self.rail_damper_mass or 0.0)
        mass = self.mass_per_length + (self._moving_sleeper + more) / self.sleeper_spacing
        return float((4.0 * self.foundation_stiffness * self.bending_stiffness / mass**2) ** 0.25)

    def refuse_speed(self, speed: float) -> None:
        """Refuse a speed, m/s, at which the response of this track has no bound: negative or critical."""
        if not 0.0 <= speed < (critical := self.critical_speed):
            allowed = f"zero or more, below the critical speed of the track, {critical:.4g} m/s"
            remedy = "Lower the speed, or take stiffer supports or a stiffer rail."
            raise InputError("speed (m/s)", f"{speed:.4g}", allowed, remedy)

    @property
    def pinned_pinned_frequency(self) -> float:
        """Frequency at which half a bending wave fits between two supports, Hz.

        Euler-Bernoulli (pi/2L^2) sqrt(B/m'); Timoshenko from the dispersion relation at k = pi/L. Infinite on
        supports that are spread evenly. Rail dampers, which split it, are left out.
        """
        if self.continuous:
            return float("inf")
        return self.rail.pinned_frequency(self.sleeper_spacing)

    @property
    def cut_on_frequencies(self) -> tuple[float, ...]:
        """Frequencies of the whole track moving as one on its layers, undamped, Hz, ascending.

        Rail and sleepers on the ballast, then the rail on its pads against the sleepers; from each of
        them on waves travel. Without sleeper mass only one, sqrt(s/m')/2 pi. Of the nominal stiffnesses, with
        rigid sleepers, and without the masses of ballast and rail dampers.
        """
        rail = self.mass_per_length * self.sleeper_spacing
        pad = self.pad_stiffness
        ballast = self._below_sleeper
        if self._moving_sleeper == 0.0:
            return (float(np.sqrt(self.foundation_stiffness / self.mass_per_length) / (2.0 * np.pi)),)
        middle = pad / rail + (pad + ballast) / self.sleeper_mass
        root = np.sqrt(middle**2 - 4.0 * pad * ballast / (rail * self.sleeper_mass))
        upper = 0.5 * (middle + root)
        lower = pad * ballast / (rail * self.sleeper_mass) / upper
        return tuple(float(np.sqrt(square) / (2.0 * np.pi)) for square in (lower, upper))

    @property
    def cut_on_frequency(self) -> float:
        """Frequency above which bending waves run along the rail on its pads, Hz.

        The last of `cut_on_frequencies`; waves of rail and sleepers together run in a band below it.
        """
        return self.cut_on_frequencies[-1]

    @property
    def antiresonance_frequency(self) -> float:
        """Frequency sqrt((k_p + k_b)/m_s)/2 pi at which the sleepers hold the rail still, Hz.

        Infinite without a sleeper that moves; k_b is that of all springs under it, nominal.
        """
        if self._moving_sleeper == 0.0:
            return float("inf")
        square = (self.pad_stiffness + self._below_sleeper) / self.sleeper_mass
        return float(np.sqrt(square) / (2.0 * np.pi))

    @property
    def _below_sleeper(self) -> float:
        """Nominal stiffness of all springs under a sleeper in line, N/m."""
        under = [spring.nominal for layer, spring in self.springs.items() if layer != "pad"]
        return under[0] if len(under) == 1 else 1.0 / sum(1.0 / k for k in under) if under else float("inf")

    @property
    def _moving_sleeper(self) -> float:
        """Mass of half a sleeper, kg; zero of one on rigid ground."""
        return self.sleeper_mass if self._below_sleeper < np.inf else 0.0


_PARAMETERS = tuple(
    each.name
    for each in fields(Track)
    if each.name not in ("name", "sources", "relaxations", "bays", "opposed")
)

EN_15461_BAYS = (
    0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 7.0, 8.0,
    10.0, 12.0, 16.0, 20.0, 24.0, 30.0, 36.0, 42.0, 48.0, 54.0, 66.0,
)  # fmt: skip
"""EN 15461:2008, measuring points in sleeper bays from the force."""


def decay_rate(track: Track, frequency: ArrayLike) -> Array:
    """Decay rate, dB/m, of the wave that reaches farthest, from its change over one bay; frequencies in Hz.

    -20 lg|lambda|/L of the larger multiplier; of a cell of bays that differ, over all of it.
    """
    frequency = finite_array("frequency (Hz)", frequency, "finite positive numbers", above=0.0)
    largest = np.abs(track.waves(2.0 * np.pi * frequency.ravel()).multipliers).max(axis=0)
    return (-20.0 * np.log10(largest) / track.period).reshape(frequency.shape)


def decay_rate_en15461(track: Track, frequency: ArrayLike) -> Array:
    """Decay rate, dB/m, as a measurement by EN 15461 finds it, force at mid-span; frequencies in Hz.

    It differs from `decay_rate` as measurements do: the near field at the force raises it, up to twofold for
    an Euler-Bernoulli rail, and 66 bays bound it from below. Where bays differ, it is the mean of forces in
    the middle of each, at distances in bays of the mean length. The hammer strikes one rail alone.
    """
    frequency = finite_array("frequency (Hz)", frequency, "finite positive numbers", above=0.0)
    struck = [each.waves(2.0 * np.pi * frequency.ravel()) for each in track.under_one_rail]
    distances = track.sleeper_spacing * np.array(EN_15461_BAYS)
    rates = []
    for force in track.mid_spans:
        each = [waves.receptances(force + distances, force) for waves in struck]
        responses = np.mean(each, axis=0)
        rates.append(decay_rate_of_responses(distances, np.abs(responses)))
    return np.mean(rates, axis=0).reshape(frequency.shape)


def decay_rate_of_responses(distances: ArrayLike, responses: ArrayLike) -> Array:
    """Decay rate, dB/m, of responses (n, ...) at distances (n,) from the force, m, EN 15461.

    4.343/sum(|A_n|^2/|A_0|^2 Delta x_n), with magnitudes in any unit and distances that ascend from zero. EN
    15461:2008: Delta x_n reaches half way to the neighbours; the first interval starts at the force, the last
    is symmetric about its point.
    """
    distances = np.asarray(distances, dtype=float)
    if distances.ndim != 1 or len(distances) < 2 or distances[0] != 0.0 or np.any(np.diff(distances) <= 0.0):
        raise InputError("distances from the force (m)", distances, "two or more, ascending from zero")
    middles = 0.5 * (distances[1:] + distances[:-1])
    edges = np.concatenate([[0.0], middles, [2.0 * distances[-1] - middles[-1]]])
    energy = np.abs(np.asarray(responses)) ** 2
    return 10.0 / np.log(10.0) / np.tensordot(np.diff(edges), energy / energy[0], axes=1)
