"""Checks of railway tables and of sound power."""

import json
from functools import partial
from pathlib import Path

import mpmath as mp
import numpy as np
from ledger import Check

from asperity import Track, Wheel
from asperity.reference import cnossos
from asperity.scenarios.scene import force_transfer
from asperity.scenes.cnossos_power import rolling_sound_power
from asperity.spectra import a_weighted_total

TABLES = Path(__file__).parent / "data" / "railway_tables.json"
LEVEL = partial(Check, unit="dB", tolerance=1e-9, absolute=True)


def tables():
    """Tables of Directive (EU) 2015/996, in a second transcription."""
    data = json.loads(TABLES.read_text())
    wavelengths = np.array(data["wavelength_mm"]) * 1e-3
    row = partial(LEVEL, source="Directive (EU) 2015/996 as amended by 2021/1226, second transcription")

    def furthest(spectrum, printed):
        order = np.argsort(-spectrum[0])
        assert np.allclose(np.sort(wavelengths)[::-1], spectrum[0][order], rtol=0.03)
        return np.abs(spectrum[1][order] - np.array(printed)[np.argsort(-wavelengths)]).max()

    what = "largest difference in 35 bands"
    for name, printed in data["contact_filter_A3_dB"].items():
        load, diameter = name.replace("kN", " kN").replace("mm", " mm").split("_")
        found = furthest(cnossos.contact_filter(f"{load}, {diameter}"), printed)
        yield row(what, 0.0, found, body=f"contact filter A3, {load}, {diameter}")
    for key, name in (("E_EN_ISO_3095_2013", "iso3095"), ("M_average_network", "cnossos-average")):
        found = furthest(cnossos.rail_roughness(name), data["rail_roughness_dB"][key])
        yield row(what, 0.0, found, body=f"rail roughness, {name}")


def iso_limit():
    printed = [
        17.1, 15.0, 13.0, 11.0, 9.0, 7.0, 4.9, 2.9, 0.9, -1.1, -3.2, -5.0, -5.6, -6.2, -6.8, -7.4, -8.0, -8.6,
        -9.2, -9.8, -10.4, -11.0,
    ]  # fmt: skip
    lengths, found = (v[7:29] for v in cnossos.rail_roughness("iso3095"))
    difference = np.abs(found[np.argsort(-lengths)] - np.array(printed)).max()
    what = "ISO 3095:2013 rail roughness, 40 to 0.315 cm: largest difference in 22 bands"
    yield LEVEL(what, 0.0, difference, source="ISO 3095:2013, limit")


def power():
    """1 kHz at 10^1.7 m/s is the band of 50 mm: everything can be read off the tables by hand."""
    rail, disc = cnossos.rail_roughness("iso3095"), cnossos.wheel_roughness("disc")
    track, wheel = cnossos.track_transfer("medium"), cnossos.wheel_transfer("920 mm")
    a3 = cnossos.contact_filter("50 kN, 920 mm")
    band, power = rolling_sound_power(10**1.7, rail, disc, track, wheel, contact_filter=a3, axles=4)
    at = np.argmin(np.abs(band - 1000.0))
    roughness = 10 * mp.log10(mp.mpf(10) ** mp.mpf("-0.11") + mp.mpf(10) ** mp.mpf("-0.16"))
    excitation = roughness - mp.mpf("1.1") + 10 * mp.log10(4)
    by_hand = "by hand from the printed tables: −1.1 ⊕ −1.6 − 1.1 dB, four axles"
    for body, transfer, found in (("track", "104.4", power[0, at]), ("wheel", "94.9", power[1, at])):
        what, source = f"CNOSSOS, 1 kHz at 50.1 m/s: sound power of the {body}", f"{by_hand}, {transfer} dB"
        yield LEVEL(what, excitation + mp.mpf(transfer), found, source=source, tolerance=1e-6)
    what, found = "A-weighted power of 90 dB at 250 Hz", a_weighted_total([90.0], [10**2.4])
    yield LEVEL(what, 81.4, found, source="IEC 61672-1, Table 3, −8.6 dB", tolerance=0.0501)


def linear_force():
    """Force on a wheel, a contact spring and a rail in series: −h/(α_W + α_C + α_R)."""
    track, wheel, stiffness = Track.named("nordborg"), Wheel(600.0, 65e3), 1.25e9
    for frequency in (60.0, 630.0, 2500.0):
        rail = track.receptance(frequency, 0.3, 0.3)
        expected = 1 / (-1 / (600.0 * (2 * np.pi * frequency) ** 2) + 1 / stiffness + rail)
        found = force_transfer(np.array([frequency]), wheel.receptance, track, stiffness, [0.3])
        what = f"linear contact at mid-span, {frequency:g} Hz: force over roughness"
        source = "Remington; receptances in series"
        yield Check(what, abs(expected), abs(found), "GN/m", source=source, tolerance=1e-9)
