"""Complex stiffness that is causal: a spring beside Maxwell elements."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import real, real_array, shown
from asperity.errors import InputError
from asperity.reference.tracks import named_track
from asperity.structures.periodic_rail import (
    PeriodicWaves,
    free_rail_waves,
    periodic_waves,
    pinned_frequency,
    static_receptance,
)


@dataclass(frozen=True)
class Relaxation:
    """Stiffness relative to a nominal one: a spring beside Maxwell elements (springs in line with dampers).

    K(ω)/k = static + Σ_j strength_j iω/(iω + 2π f_j). It is analytic in the lower half-plane, hence causal,
    and Im K >= 0 at all ω > 0, hence passive.
    """

    static: float  # of the spring, zero or more: the stiffness at rest
    # of the Maxwell elements, zero or more: what each adds well above its frequency
    strengths: tuple[float, ...]
    frequencies: tuple[float, ...]  # at which they dissipate most, Hz

    def at(self, omega: ArrayLike) -> NDArray[np.complex128]:
        """Stiffness relative to the nominal one at angular frequencies, rad/s, with Im ω <= 0."""
        return relaxing(omega, self.frequencies) @ np.array([self.static, *self.strengths])


@dataclass(frozen=True)
class Relaxations:
    """What stands for the loss factors of a track; None where there is none."""

    rail: Relaxation | None = None  # of its bending (and shear) stiffness
    pad: Relaxation | None = None
    ballast: Relaxation | None = None


def relaxing(omega: ArrayLike, frequencies: ArrayLike) -> NDArray[np.complex128]:
    """Stiffnesses (..., 1 + j) of a spring, 1, and of Maxwell elements of unit strength, iω/(iω + 2π f_j).

    Angular frequency (...), rad/s; frequencies f_j (j,), Hz.
    """
    rate = 1j * np.asarray(omega, dtype=complex)[..., None]
    elements = rate / (rate + 2.0 * np.pi * np.asarray(frequencies, dtype=float))
    return np.concatenate([np.ones_like(rate), elements], axis=-1)


def check_track(track: Track) -> None:
    """Refuse parameters that no track has; see `asperity.structures.track.Track`."""
    for what, value, needed in (
        ("bending stiffness of the rail (N m^2)", track.bending_stiffness, True),
        ("mass per length of the rail (kg/m)", track.mass_per_length, True),
        ("pad stiffness (N/m)", track.pad_stiffness, True),
        ("ballast stiffness (N/m)", track.ballast_stiffness, True),
        ("sleeper spacing (m)", track.sleeper_spacing, True),
        ("shear stiffness of the rail (N)", track.shear_stiffness, False),
        ("rotary inertia of the rail (kg m)", track.rotary_inertia, False),
    ):
        if needed or value is not None:
            real(what, value, "a finite positive number", above=0.0)
    for what, value, needed in (
        ("sleeper mass (kg)", track.sleeper_mass, True),
        ("rail loss factor", track.rail_loss_factor, True),
        ("pad damping (N s/m)", track.pad_damping, False),
        ("pad loss factor", track.pad_loss_factor, False),
        ("ballast damping (N s/m)", track.ballast_damping, False),
        ("ballast loss factor", track.ballast_loss_factor, False),
    ):
        if needed or value is not None:
            real(what, value, "a finite number, zero or more", at_least=0.0)
    _refuse_doubles(track)


def _refuse_doubles(track: Track) -> None:
    for element, viscous, factor in (
        ("pad", track.pad_damping, track.pad_loss_factor),
        ("ballast", track.ballast_damping, track.ballast_loss_factor),
    ):
        if viscous is not None and factor is not None:
            raise InputError(
                f"damping of the {element}",
                f"{element}_damping = {viscous:g} N s/m and {element}_loss_factor = {factor:g}",
                "one of them",
                "Remove one: an element is either viscous or has a loss factor.",
            )
    if (track.shear_stiffness is None) != (track.rotary_inertia is None):
        missing = "rotary_inertia" if track.rotary_inertia is None else "shear_stiffness"
        raise InputError(
            "Timoshenko rail",
            f"no {missing}",
            "shear_stiffness and rotary_inertia together, or neither (Euler-Bernoulli)",
        )


_ALTERNATIVES = {
    "pad_damping": "pad_loss_factor",
    "pad_loss_factor": "pad_damping",
    "ballast_damping": "ballast_loss_factor",
    "ballast_loss_factor": "ballast_damping",
}
_VANISHING_DAMPING = 1e-9  # relative; picks the outgoing wave where nothing in the track dissipates


@dataclass(frozen=True)
class Track:
    """Rail of infinite length on equal supports, Euler-Bernoulli or Timoshenko.

    Each support is a pad (spring and damper) on a rigid half sleeper on ballast (spring and damper).
    All stiffnesses, dampers and masses are those under one rail.

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
        k_b, N/m.
    sleeper_spacing : float
        L, m.
    rail_loss_factor : float
        E (1 + i eta), and for Timoshenko G likewise.
    pad_damping, pad_loss_factor : float, optional
        Viscous, N s/m, or hysteretic, k_p (1 + i eta); one of them, or none for no damping.
    ballast_damping, ballast_loss_factor : float, optional
        The same for the ballast.
    shear_stiffness, rotary_inertia : float, optional
        G A kappa, N, and rho I, kg m: both for a Timoshenko rail, none for Euler-Bernoulli.
    name : str
        What the set is called.
    sources : tuple of str
        Where the values come from, one text per parameter.
    relaxations : Relaxations, optional
        Causal stiffnesses that stand for the loss factors, as `asperity.structures.causal_track` finds them.

    Raises
    ------
    InputError
        If a value is out of range, one element has both viscous damping and a loss factor, or only one
        of shear stiffness and rotary inertia is given.

    Notes
    -----
    Vertical motion of one rail on rigid half sleepers. Euler-Bernoulli overestimates the
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

    bending_stiffness: float
    mass_per_length: float
    pad_stiffness: float
    sleeper_mass: float
    ballast_stiffness: float
    sleeper_spacing: float
    rail_loss_factor: float = 0.0
    pad_damping: float | None = None
    pad_loss_factor: float | None = None
    ballast_damping: float | None = None
    ballast_loss_factor: float | None = None
    shear_stiffness: float | None = None
    rotary_inertia: float | None = None
    name: str = ""
    sources: tuple[str, ...] = ()
    relaxations: Relaxations | None = None

    def __post_init__(self) -> None:
        check_track(self)

    @classmethod
    def named(cls, name: str, **overrides: Any) -> Track:
        """A named set of parameters with its sources.

        Parameters
        ----------
        name : str
            One of `asperity.reference.tracks.TRACKS`.
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
            alternative = _ALTERNATIVES.get(key)
            if overrides[key] is not None and alternative is not None and alternative not in overrides:
                parameters.pop(alternative, None)
        sources = {key: source for key, (_, source) in parameters.items()}
        sources |= dict.fromkeys(overrides, "given here")
        values: dict[str, Any] = {"name": name} | {key: value for key, (value, _) in parameters.items()}
        values["sources"] = tuple(f"{key}: {source}" for key, source in sources.items())
        return cls(**(values | overrides))

    @property
    def is_causal(self) -> bool:
        """Whether it responds after a force only: no constant loss factor, or relaxations instead."""
        lossy = self.rail_loss_factor or self.pad_loss_factor or self.ballast_loss_factor
        return not lossy or self.relaxations is not None

    @property
    def nominal(self) -> Track:
        """The track with its constant loss factors, without relaxations."""
        return replace(self, relaxations=None)

    @property
    def is_damped(self) -> bool:
        """Whether anything in the track dissipates."""
        return bool(
            self.rail_loss_factor
            or self.pad_damping
            or self.pad_loss_factor
            or self.ballast_damping
            or self.ballast_loss_factor
        )

    def support_stiffness(self, omega: ArrayLike) -> NDArray[np.complex128]:
        """Dynamic stiffness of one support under the rail, N/m, at angular frequencies, rad/s.

        K = K_p (K_b - m_s omega^2)/(K_p + K_b - m_s omega^2); omega has a positive real part or, if causal,
        is in the lower half-plane.
        """
        omega = np.asarray(omega, dtype=complex)
        pad, ballast = self.layer_stiffnesses(omega)
        below = ballast - self.sleeper_mass * omega**2
        return pad * below / (pad + below)

    def layer_stiffnesses(self, omega: ArrayLike) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Dynamic stiffness of a pad, and of ballast under a sleeper, N/m, as in `support_stiffness`."""
        omega, relaxed = np.asarray(omega, dtype=complex), self.relaxations or Relaxations()
        pad = self.pad_stiffness * _loss(self.pad_loss_factor, relaxed.pad, omega)
        ballast = self.ballast_stiffness * _loss(self.ballast_loss_factor, relaxed.ballast, omega)
        rate = 1j * omega
        return pad + rate * (self.pad_damping or 0.0), ballast + rate * (self.ballast_damping or 0.0)

    def free_waves(self, omega: ArrayLike) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Waves of the rail without supports at angular frequencies (f,), rad/s; see `free_rail_waves`."""
        omega, relaxed = np.asarray(omega, dtype=complex), self.relaxations or Relaxations()
        loss = _loss(self.rail_loss_factor, relaxed.rail, omega)
        return free_rail_waves(
            omega,
            self.bending_stiffness * loss,
            self.mass_per_length,
            None if self.shear_stiffness is None else self.shear_stiffness * loss,
            self.rotary_inertia,
        )

    def waves(self, omega: ArrayLike) -> PeriodicWaves:
        """The two waves of the supported rail at angular frequencies (f,), rad/s, as in `support_stiffness`.

        Without any damping the outgoing wave is that of a damping which vanishes. An `InputError` says if the
        frequency is so high that a wave decays by more than exp(-200) in one bay.
        """
        omega = np.atleast_1d(np.asarray(omega, dtype=complex))
        if not self.is_damped:
            omega = omega * (1.0 - _VANISHING_DAMPING * 1j)
        wavenumbers, amplitudes = self.free_waves(omega)
        return periodic_waves(wavenumbers, amplitudes, self.support_stiffness(omega), self.sleeper_spacing)

    def receptance(self, frequency: ArrayLike, x: ArrayLike, x0: ArrayLike) -> NDArray[np.complex128]:
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
        allowed = "finite positive numbers"
        at = real_array("frequency (Hz)", frequency, allowed)
        if not (np.all(np.isfinite(at)) and np.all(at > 0.0)):
            raise InputError("frequency (Hz)", np.min(at), allowed)
        what, allowed = (
            "positions on the track (m)",
            "finite numbers, as many for the response as for the force",
        )
        to, of = (real_array(what, each, allowed) for each in (x, x0))
        if to.shape != of.shape or not (np.isfinite(to).all() and np.isfinite(of).all()):
            raise InputError(what, f"{shown(x)} and {shown(x0)}", allowed)
        waves, pairs = self.waves(2.0 * np.pi * at.ravel()), zip(to.flat, of.flat, strict=True)
        return np.array([waves.receptance(*pair) for pair in pairs]).reshape((*to.shape, *at.shape))

    @property
    def foundation_stiffness(self) -> float:
        """Static stiffness of the supports per length s = K(0)/L, N/m^2."""
        relaxed = self.relaxations or Relaxations()
        pad = self.pad_stiffness * _at_rest(relaxed.pad)
        ballast = self.ballast_stiffness * _at_rest(relaxed.ballast)
        return pad * ballast / (pad + ballast) / self.sleeper_spacing

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
        at, rail = x % self.sleeper_spacing, _at_rest((self.relaxations or Relaxations()).rail)
        compliance = static_receptance(
            self.bending_stiffness * rail,
            None if self.shear_stiffness is None else self.shear_stiffness * rail,
            self.foundation_stiffness * self.sleeper_spacing,
            self.sleeper_spacing,
            at,
        )
        return force * compliance

    @property
    def critical_speed(self) -> float:
        """Critical speed of the continuous foundation (4 s B/m^2)^(1/4), m/s.

        The mass m is that of rail and sleepers together, m' + m_s/L, which gives the smaller speed: at
        the low frequencies of a constant moving force the sleepers move with the rail.
        """
        mass = self.mass_per_length + self.sleeper_mass / self.sleeper_spacing
        return float((4.0 * self.foundation_stiffness * self.bending_stiffness / mass**2) ** 0.25)

    def refuse_speed(self, speed: float) -> None:
        """Refuse a speed, m/s, at which the response of this track has no bound: negative or critical."""
        if not 0.0 <= speed < self.critical_speed:
            raise InputError(
                "speed (m/s)",
                f"{speed:.4g}",
                f"zero or more, below the critical speed of the track, {self.critical_speed:.4g} m/s",
                "Lower the speed, or take stiffer supports or a stiffer rail.",
            )

    @property
    def pinned_pinned_frequency(self) -> float:
        """Frequency at which half a bending wave fits between two supports, Hz.

        Euler-Bernoulli (pi/2L^2) sqrt(B/m'); Timoshenko from the dispersion relation at k = pi/L.
        """
        return pinned_frequency(
            self.sleeper_spacing,
            self.bending_stiffness,
            self.mass_per_length,
            self.shear_stiffness,
            self.rotary_inertia,
        )

    @property
    def cut_on_frequencies(self) -> tuple[float, ...]:
        """Frequencies of the whole track moving as one on its layers, undamped, Hz, ascending.

        Rail and sleepers on the ballast, then the rail on its pads against the sleepers; from each of
        them on waves travel. Without sleeper mass only one, sqrt(s/m')/2 pi.
        """
        rail = self.mass_per_length * self.sleeper_spacing
        pad, ballast = self.pad_stiffness, self.ballast_stiffness
        if self.sleeper_mass == 0.0:
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

        Infinite without sleeper mass.
        """
        if self.sleeper_mass == 0.0:
            return float("inf")
        return float(
            np.sqrt((self.pad_stiffness + self.ballast_stiffness) / self.sleeper_mass) / (2.0 * np.pi)
        )


def _loss(
    factor: float | None, relaxation: Relaxation | None, omega: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Complex stiffness relative to the nominal one."""
    if relaxation is not None:
        return relaxation.at(omega)
    return np.asarray(1.0 + 1j * (factor or 0.0))


def _at_rest(relaxation: Relaxation | None) -> float:
    """Static stiffness relative to the nominal one."""
    return 1.0 if relaxation is None else relaxation.static


_NO_PARAMETERS = ("name", "sources", "relaxations")
_PARAMETERS = tuple(field.name for field in fields(Track) if field.name not in _NO_PARAMETERS)
