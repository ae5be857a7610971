"""Named sets of track parameters, each value with its source; least decay rate for tests of vehicles."""

import numpy as np

from asperity.arguments import Array, ArrayLike, one_of

_NORDBORG = "A. Nordborg, J. Acoust. Soc. Am., 2002 (not seen), as used by a public re-implementation"
_NORDBORG_VISCOUS = "viscous variant of " + _NORDBORG
_UIC60 = "UIC 60 as in the program rolland: E = 210 GPa, I = 3.037e-5 m^4, A = 76.7e-4 m^2, m' = 60.2 kg/m"
_UIC60_SHEAR = _UIC60 + "; kappa = 0.393, G = 80.77 GPa"
_RANGE = "chosen here within the published range "
_OWN = "default of asperity, chosen here: the thesis prints none; "

Parameters = dict[str, tuple[float, str]]

_UIC60_RAIL: Parameters = {
    "bending_stiffness": (210e9 * 3.037e-5, _UIC60),
    "mass_per_length": (60.2, _UIC60),
    "rail_loss_factor": (0.02, _UIC60),
}
_UIC60_SUPPORTS: Parameters = {
    "pad_stiffness": (180e6, _RANGE + "65 to 225 MN/m"),
    "pad_damping": (18e3, _RANGE + "18 to 30 kN s/m for pads of 180 MN/m"),
    "sleeper_mass": (150.0, _RANGE + "140 to 177.5 kg"),
    "ballast_stiffness": (40e6, _RANGE + "20 to 150 MN/m"),
    "ballast_damping": (47e3, "published together with a ballast of 40 MN/m"),
    "sleeper_spacing": (0.6, _RANGE + "0.55 to 0.65 m"),
}
_CHOSEN = "chosen here, no particular product"
_UIC60_TIMOSHENKO: Parameters = {
    **_UIC60_RAIL,
    "shear_stiffness": (80.77e9 * 76.7e-4 * 0.393, _UIC60_SHEAR),
    "rotary_inertia": (60.2 / 76.7e-4 * 3.037e-5, _UIC60),
}
_NORDBORG_RAIL: Parameters = {
    "bending_stiffness": (210e9 * 22.5e-6, _NORDBORG + ": E = 210 GPa, I = 22.5e-6 m^4"),
    "mass_per_length": (60.0, _NORDBORG),
    "rail_loss_factor": (0.004, _NORDBORG),
    "pad_stiffness": (300e6, _NORDBORG),
    "sleeper_mass": (150.0, _NORDBORG),
    "ballast_stiffness": (150e6, _NORDBORG),
    "sleeper_spacing": (0.6, _NORDBORG),
}

TRACKS: dict[str, Parameters] = {
    "x2000": {
        "bending_stiffness": (210e9 * 3.037e-5, _OWN + _UIC60),
        "mass_per_length": (60.2, _OWN + _UIC60),
        "rail_loss_factor": (0.02, _OWN + _UIC60),
        "pad_stiffness": (200e6, _OWN + "published range 65 to 225 MN/m"),
        "pad_damping": (28e3, _OWN + "published together with a pad of 200 MN/m"),
        "sleeper_mass": (150.0, _OWN + "published range 140 to 177.5 kg"),
        "ballast_stiffness": (150e6, _OWN + "published range 20 to 150 MN/m"),
        "ballast_damping": (48e3, _OWN + "published together with a ballast of 150 MN/m"),
        "sleeper_spacing": (0.6, _OWN + "published range 0.55 to 0.65 m"),
    },
    "nordborg": {
        **_NORDBORG_RAIL,
        "pad_damping": (18e3, _NORDBORG_VISCOUS),
        "ballast_damping": (48e3, _NORDBORG_VISCOUS),
    },
    "nordborg-loss-factor": {
        **_NORDBORG_RAIL,
        "pad_loss_factor": (0.15, _NORDBORG),
        "ballast_loss_factor": (0.4, _NORDBORG),
    },
    "uic60": {**_UIC60_TIMOSHENKO, **_UIC60_SUPPORTS},
    "uic60-euler": {**_UIC60_RAIL, **_UIC60_SUPPORTS},
    "slab-blocks": {
        **_UIC60_TIMOSHENKO,
        "pad_stiffness": (150e6, _CHOSEN + ": a pad on a block"),
        "pad_loss_factor": (0.2, _CHOSEN),
        "sleeper_mass": (100.0, _CHOSEN + ": the block"),
        "ballast_stiffness": (25e6, _CHOSEN + ": the boot of the block, on a rigid slab"),
        "ballast_loss_factor": (0.2, _CHOSEN + ": of the boot"),
        "sleeper_spacing": (0.6, _RANGE + "0.55 to 0.65 m"),
    },
    "embedded": {
        **_UIC60_TIMOSHENKO,
        "pad_stiffness": (60e6, _CHOSEN + ": 100 MN/m per metre of rail"),
        "pad_loss_factor": (0.2, _CHOSEN),
        "sleeper_mass": (0.0, "none"),
        "ballast_stiffness": (float("inf"), "the trough of the rail is rigid"),
        "sleeper_spacing": (0.6, "a length of rail, to which pad_stiffness belongs"),
        "continuous": (True, "the rail lies on its embedment all along"),
    },
}


def named_track(name: str) -> Parameters:
    """Parameters of a named track of `TRACKS`, those of `Track`, each with (value in SI, source)."""
    return dict(TRACKS[one_of("track name", name, TRACKS)])


_HALF_BAND = 10.0**0.05
_FROM_BAND_DB_PER_M = ((250.0, 2.0), (400.0, 6.0), (800.0, 2.19), (1000.0, 0.8))
_LAST_BAND = 5000.0


def iso_3095_decay_rate(frequency: ArrayLike) -> Array:
    """Lower limit of the vertical decay rate of a reference track, dB/m, at frequencies (f,), Hz.

    That of the one-third octave which holds the frequency; NaN below 250 Hz and above 5 kHz. ISO 3095:2013;
    the edition of 2025 has not been compared.
    """
    at = np.asarray(frequency, dtype=np.float64)
    limit = np.full(at.shape, np.nan)
    for first, value in _FROM_BAND_DB_PER_M:
        limit[at >= first / _HALF_BAND] = value
    limit[at > _LAST_BAND * _HALF_BAND] = np.nan
    return limit
