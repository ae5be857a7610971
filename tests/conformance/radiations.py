"""Checks of sound radiation from vibration."""

from functools import partial

import mpmath as mp
from ledger import Check

from asperity.radiation import track
from asperity.radiation.wheel import axial_transition
from asperity.structures.track import Track


def elementary():
    """Radiation ratios in closed form and at their limits."""
    ratio, cylinders = partial(Check, "radiation ratio"), "oscillating rigid cylinder, ka ="
    for ka in ("0.3", "1", "4"):
        slope = mp.diff(lambda z: mp.hankel2(1, z), mp.mpf(ka))
        expected, source = 2 / (mp.pi * mp.mpf(ka) * abs(slope) ** 2), "2/(π ka abs(H₁'(ka))²), mpmath"
        yield ratio(
            expected, track.cylinder(float(ka)), body=f"{cylinders} {ka}", source=source, tolerance=1e-9
        )
    for ka, expected, source in (
        (1e-3, mp.pi / 2 * mp.mpf("1e-3") ** 3, "line dipole, (π/2)(ka)³"),
        (1e3, 1.0, "plane wave"),
    ):
        yield ratio(expected, track.cylinder(ka), body=f"{cylinders} {ka:g}", source=source, tolerance=1e-5)
    for ka, expected, source, tolerance in (
        (2.0, 1 - mp.besselj(1, 4) / 2, "1 − J₁(2ka)/ka, mpmath", 1e-9),
        (1e-3, 5e-7, "(ka)²/2", 1e-5),
    ):
        body = f"piston in a plane, ka = {ka:g}"
        yield ratio(expected, track.baffled_piston(ka), body=body, source=source, tolerance=tolerance)
    expected, found = (27 * mp.pi**2 / 8) ** mp.mpf("0.25"), axial_transition(0)
    what = "rigid disc in free air: ka at which its low-frequency power is that of a plane wave"
    yield Check(what, expected, found, source="Rayleigh, 8(ka)⁴/(27π²) = 1", tolerance=1e-9)
    section = track.RailSection(0.150, 0.072, 0.00767)
    dipole = mp.mpf("0.00767") + mp.pi / 4 * (mp.mpf("0.15") ** 2 + mp.mpf("0.072") ** 2)
    expected = (2 * mp.pi / mp.mpf("343.2")) ** 3 * dipole**2 / 8
    found = section.radiating_width * section.radiation_ratio(1.0)[0]
    what = "60E1 rail at 1 Hz: sound power per length over ρ c ⟨v²⟩"
    yield Check(what, expected, found, "m", source="line dipole, k³D²/8", tolerance=1e-4)


def along_the_track():
    """Length of a single wave."""
    rail = Track(
        bending_stiffness=1e9, mass_per_length=60.0, pad_stiffness=1e3, sleeper_mass=0.0,
        ballast_stiffness=1e3, sleeper_spacing=0.05, rail_loss_factor=0.05,
        shear_stiffness=2e7, rotary_inertia=1e-3,
    )  # fmt: skip
    decay = -mp.im(2 * mp.pi * 500 * mp.sqrt(60 / (mp.mpf("2e7") * mp.mpc(1, "0.05"))))
    found = (track.squared_mobility(rail, 500.0) / track.squared_point_mobility(rail, 500.0))[0]
    source = "one wave, 1/−Im ω√(m'/S)"
    what = "rail that shears and hardly bends, 500 Hz: effective length"
    yield Check(what, 1 / decay, found, "m", source=source, tolerance=1e-3)
