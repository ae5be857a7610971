"""Statements of the thesis, measured: one sub-command for each table of docs/evidence/against_the_thesis.md.

    python benchmarks/thesis.py wheel | ball | states | noise | signs

`wheel` presses and moves a railway wheel at the states r = 5, 15, 30, 70 and 110 µm: the stiffness k_c = F/r
next to Hertz's, and what the filters leave at 4 kHz. `ball` does so with a steel ball at r = 1 to 4 µm on one
surface and at 5 to 25 µm on a rougher one. `states` rolls the wheel with 8, 16 and 32 states of the filters.
`noise` compares laws with two linear contacts on rails at and above ISO 3095: the force in bands, and dB(A).
`signs` changes what might turn the sign of those dB(A).
Each prints its table in Markdown. The surfaces are our own choice: the thesis prints none.
"""

from __future__ import annotations

import sys
import warnings

import numpy as np
from xarray import Dataset

import asperity
from asperity.case.scene import Case
from asperity.reference.cnossos import rail_roughness
from asperity.scenarios import reducing

UM = 1e-6
WHEEL_SPEED, BALL_SPEED = 56.0, 1.0  # m/s
WHEEL_STATES = (5.0, 15.0, 30.0, 70.0, 110.0)  # µm
BALLS = {  # rms of the surface, and states in µm
    "0.1 um": (1.0, 2.0, 3.0, 4.0),
    "1 um": (5.0, 10.0, 15.0, 25.0),
}
STATES = (8, 16, 32)
GROUPS = {  # one-third octaves, Hz: first and last
    "63 Hz": (60, 66),
    "125–630 Hz": (120, 650),
    "1–1.6 kHz": (950, 1650),
    "4 kHz": (3900, 4100),
}


def wheel() -> None:
    """Print stiffness and filters of a wheel on a rough rail."""
    case = asperity.WheelOnRail(
        laws=["shifted", "printed"],
        duration="20 ms",
        settling=0,
        surface={"rms": "1 um", "longest": "30 mm", "shortest": "2 mm"},
        contact={"spacing": "0.25 mm", "window": "20.25 mm", "samples": 6, "sample_length": "0.48 m"},
    )
    print_states(at_states(case, WHEEL_STATES), WHEEL_SPEED, (1e3, 2e3, 4e3))


def ball() -> None:
    """Print stiffness and filters of a ball on two rough beams."""
    for rms, states in BALLS.items():
        case = asperity.BallOnBeam(
            laws=["shifted", "printed"],
            start="0.5 m",
            duration="10 ms",
            settling=0,
            surface={"rms": rms, "longest": "1 mm", "shortest": "0.1 mm"},
            ball={"radius": "25 mm", "load": "30 N"},
            contact={"spacing": "25 um", "window": "2.025 mm", "samples": 6, "sample_length": "12 mm"},
        )
        print(f"\n{rms} rms\n")
        print_states(at_states(case, states), BALL_SPEED, (1e3, 2e3, 4e3))


def at_states(case: Case, states: tuple[float, ...]) -> Dataset:
    """Contact of a case at states r, µm, counted from the first touch of its samples."""
    datum = 0.0
    for _ in range(2):  # the datum is known once the samples are pressed
        approaches = [f"{state - datum:.6f} um" for state in states]
        contact = asperity.run(case.with_(contact={"approaches": approaches}))["contact"].to_dataset()
        datum = contact.attrs["datum"] / UM
    return contact


def print_states(contact: Dataset, speed: float, frequencies: tuple[float, ...]) -> None:
    """Print a row for each state: stiffness, and both filters at wavenumbers f/v, dB."""
    heard = "".join(f" {name} at {f / 1e3:g} kHz |" for name in ("printed", "to k_t") for f in frequencies)
    print(f"| r, µm | k_c, MN/m | spread | Hertz at r − d₀, MN/m | k_c over it |{heard}")
    print("|---" * (5 + 2 * len(frequencies)) + "|")
    wavenumber = contact.wavenumber.values
    for row, state in enumerate((contact.approach.values + contact.attrs["datum"]) / UM):
        found, smooth = float(contact.stiffness[row]), float(contact.hertz_stiffness[row])
        levels = "".join(
            f" {np.interp(f / speed, wavenumber, 20 * np.log10(contact[name].values[row])):.1f} |"
            for name in ("printed_filter", "filter")
            for f in frequencies
        )
        spread = float(contact.stiffness_std[row])
        print(
            f"| {state:.2f} | {found / 1e6:.4g} | {spread / 1e6:.2g} | {smooth / 1e6:.4g} "
            f"| {found / smooth:.3f} |{levels}"
        )
    print(f"\nd₀ = {contact.attrs['datum'] / UM:.2f} µm")


def states() -> None:
    """Print the force of filtered laws by the number of states of their filters."""
    bands, laws = (1000.0, 2000.0, 2500.0, 3150.0, 4000.0), ["shifted", "printed"]
    print("| above ISO 3095 | law | states |" + "".join(f" {band:g} Hz |" for band in bands))
    print("|---" * (3 + len(bands)) + "|")
    for above in (0, 15):
        levels = {}
        for count in STATES:
            reducing.STATES = count
            level = asperity.run(rail(above, laws))["spectra/force_level"]
            levels[count] = level.sel(band=list(bands), method="nearest")
        for law in laws:
            for count in STATES[:-1]:
                apart = (levels[count] - levels[STATES[-1]]).sel(law=law).values
                print(f"| +{above} dB | `{law}` | {count} |" + "".join(f" {each:+.2f} |" for each in apart))


def rail(above: float, laws: list[str], **sections: dict[str, str]) -> asperity.WheelOnRail:
    """Wheel at 200 km/h on a rail so many dB rougher than ISO 3095, with other sections."""
    wavelengths, limit = rail_roughness("iso3095")
    return asperity.WheelOnRail(
        speed="200 km/h",
        laws=laws,
        settling="0.2 s",
        surface={"spectrum": np.column_stack([wavelengths, limit + above])},
        wheel={"roughness": "disc", "section": "rigid"},
        numerics={"poles": 60},
        **sections,
    )


def noise() -> None:
    """Print the force of the laws over that of two linear contacts, by bands, and in dB(A)."""
    laws = ["shifted", "shifted-unfiltered", "areal", "printed", "printed-unfiltered", "linear-filtered"]
    print("| above ISO 3095 | law | linear with |" + "".join(f" {name} |" for name in GROUPS) + " dB(A) |")
    print("|---" * (4 + len(GROUPS)) + "|")
    for above in (0, 10, 15, 20):
        for name, linearise in (("k_t", "rough"), ("k_c", "secant")):
            spectra = asperity.run(rail(above, [*laws, "linear"], contact={"linearise": linearise}))[
                "spectra"
            ]
            force, power = spectra.force_level_difference_to_linear, spectra.sound_power_level_a
            louder = (power - power.sel(law="linear")).sel(source="total")
            for law in laws:
                over = [force.sel(law=law, band=slice(*ends)).mean() for ends in GROUPS.values()]
                over.append(louder.sel(law=law))
                print(
                    f"| +{above} dB | `{law}` | {name} |" + "".join(f" {float(each):+.1f} |" for each in over)
                )


def signs() -> None:
    """Print dB(A) over the two linear contacts with other datums, normalisation, damping and stiffness."""
    laws = ["shifted", "shifted-unfiltered", "printed", "printed-unfiltered"]
    variants = {
        "as it stands": {},
        "filters referred to k_t": {"normalise": "tangent"},
        "datum of samples and path": {"datum": "path"},
        "damping of 100 kN s/m": {"damping": "100000 N s/m"},
        "Hertz's stiffness for k_t": {"linearise": "hertz"},
    }
    print("| what is changed | linear with |" + "".join(f" `{law}` |" for law in laws))
    print("|---" * (2 + len(laws)) + "|")
    for name, keys in variants.items():
        for stiffness, linearise in (("k_t", "rough"), ("k_c", "secant")):
            if stiffness == "k_c" and "linearise" in keys:
                continue
            run = asperity.run(rail(0, [*laws, "linear"], contact={"linearise": linearise} | keys))
            power = run["spectra/sound_power_level_a"].sel(source="total")
            louder = power.sel(law=laws) - power.sel(law="linear")
            print(f"| {name} | {stiffness} |" + "".join(f" {each:+.1f} |" for each in louder.values))


def main() -> None:
    """Print the table that was asked for."""
    warnings.simplefilter("ignore")
    {"wheel": wheel, "ball": ball, "states": states, "noise": noise, "signs": signs}[sys.argv[1]]()


if __name__ == "__main__":
    main()
