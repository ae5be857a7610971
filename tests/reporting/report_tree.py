"""A synthetic result with the shape and the size of a real run, made from closed forms and noise."""

import json

import numpy as np
import xarray as xr

from asperity.laws import spec_of
from asperity.scenes import schema
from asperity.scenes.report import CHAPTERS
from asperity.schema import VERSION, contact, rolling, spectra, surface

LAWS = ["areal", "shifted", "printed", "table", "linear-filtered", "linear"]
SENSORS = [0.2, 0.35, 0.5, 0.65, 0.8]
DATUM = 1.5e-6
LOAD = 5.0
RADIUS = 0.025
HERTZ = 4 / 3 * 115e9 * np.sqrt(RADIUS)  # of steel on steel


def figures_by_name(kind="ball-on-beam"):
    """All figures that a result may have, of two of one name that of a kind of case."""
    figures = [figure for chapter in CHAPTERS for figure in chapter.figures]
    return {figure.name: figure for figure in (figures if kind == "wheel-on-rail" else figures[::-1])}


def group(values, **attrs):
    """Variables by their entries of the schema, of one contact."""
    found = {
        entry.name: ([dim for dim in entry.dims if dim != "contact"], numbers, {"units": entry.units,
                     "long_name": entry.long_name})
        for entry, numbers in values.items()
    }  # fmt: skip
    return xr.Dataset(found, attrs=attrs)


def dumped(keys, *rows):
    return json.dumps([dict(zip(keys, row, strict=True)) for row in rows])


ROOT = {
    "title": "Steel ball on a steel beam",
    "asperity_version": "0.1.0",
    "schema_version": VERSION,
    "created": "2026-01-02T03:04:05+00:00",
    "case": 'kind = "ball-on-beam"\nspeed = "1 m/s"\n\n[ball]\nradius = "25 mm"\nmaterial = "steel"\n',
    "seed": 1,
    "citations": json.dumps(["O. Lundberg, licentiate thesis, 2014.", "A. E. H. Love, Phil. Trans., 1929."]),
    "verdict": "The ball keeps contact for 97.9 % of the time; areal lies within 1.3 dB of table.",
    "warnings": dumped(
        ("category", "message", "count"),
        ("ExtrapolationWarning", "Approach 3.2 µm left the computed range. Add a larger approach.", 12),
        ("ShortRecordWarning", "1 s holds 63 periods of the lowest band. Roll longer.", 1),
    ),
}
PARAMETERS = [
    ("speed", "1 m/s", "1 m/s", ""),
    ("laws", "areal, shifted, printed, table, linear", "areal, linear", "the first is the main one"),
    ("duration", "0.6 s", "the beam's length", "0.6 m of path"),
    ("surface.file", "aa5754_um.npz", "none", ""),
    ("ball.radius", "25 mm", "25 mm", ""),
    ("beam.height", "12 mm", "10 mm", ""),
    ("contact.samples", "8", "8", ""),
]
STATISTICS = [
    ("Sq", 0.31e-6, "m", "samples", "root mean square height", "16 µm … 0.8 mm"),
    ("Ssk", -0.41, "1", "samples", "skewness", "16 µm … 0.8 mm"),
    ("Rq", 0.29e-6, "m", "path", "root mean square height of the centre line", "16 µm … 0.8 mm"),
]


def scenario(laws):
    keys = ("key", "value", "default", "note", "is_default")
    return xr.Dataset(
        attrs={
            "kind": "ball-on-beam",
            "parameters": dumped(keys, *((*row, row[1] == row[2]) for row in PARAMETERS)),
            "numerics": dumped(("name", "value"), ("time step", "10 µs"), ("run time: scan", "21.4 s")),
            "laws": json.dumps([spec_of(law).entry() for law in laws]),
        }
    )


def texture(rng, shape, spacing, rms=0.3e-6, hurst=0.8, longest=0.4e-3):
    kx, ky = np.fft.fftfreq(shape[0], spacing)[:, None], np.fft.rfftfreq(shape[1], spacing)[None, :]
    k = np.hypot(kx, ky)
    amplitude = np.where(k > 0, np.maximum(k, 1 / longest) ** -(1 + hurst), 0)
    noise = rng.standard_normal(k.shape) + 1j * rng.standard_normal(k.shape)
    heights = np.fft.irfft2(noise * amplitude, s=shape)
    return heights * rms / heights.std()


def of_surface(rng):
    step, wavenumber = 8e-6, np.linspace(200, 62500, 400)
    psd = 2e-16 / (1 + (wavenumber / 2500) ** 2) ** 1.3
    keys = ("symbol", "value", "unit", "surface", "meaning", "bandwidth")
    values = {
        surface.SAMPLE_HEIGHTS: texture(rng, (128, 128), step),
        surface.PATH_HEIGHTS: texture(rng, (2000, 64), step),
        surface.LINE: texture(rng, (20000, 2), step)[:, 0],
        surface.PSD_SAMPLE: psd * rng.gamma(8, 1 / 8, 400),
        surface.PSD_PATH: psd * rng.gamma(60, 1 / 60, 400),
        surface.SURFACE_WAVENUMBER: wavenumber,
    }
    counts = {"X": 128, "Y": 128, "PATH_X": 2000, "PATH_Y": 64, "DISTANCE": 20000}
    values |= {getattr(surface, name): step * np.arange(count) for name, count in counts.items()}
    told = {"source": "aa5754_um.npz, array polished", "statistics": dumped(keys, *STATISTICS)}
    return group(values, missing_share=0.0, **told)


def of_contact(rng):
    approach = np.array([-1.0, -0.5, 0.0, 0.3, 0.6, 1.0, 1.5, 2.0, 3.0]) * 1e-6
    r, smooth = approach + DATUM, np.maximum(approach, 0)
    force = HERTZ * (smooth**3 + (0.15e-6 * np.exp(approach / 0.4e-6)).clip(max=0.4e-6) ** 3) ** 0.5
    radius, wavenumber = np.sqrt(RADIUS * np.maximum(approach, 0.05e-6)), np.geomspace(500, 25000, 68)
    theory = np.sinc(2 * wavenumber * radius[:, None])
    noisy = theory + 0.01 * rng.standard_normal(theory.shape)
    noisy[0] = theory[0] = np.nan
    excited, magnitude = wavenumber < 21e3, np.abs(noisy)
    side, patch = np.linspace(-0.25e-3, 0.25e-3, 64), 1.3e-4
    inside = np.maximum(1 - (side[:, None] ** 2 + side**2) / patch**2, 0)
    pressure = 2.4e8 * np.sqrt(inside) * rng.gamma(1.2, 1, inside.shape)
    values = {
        contact.FORCE: force,
        contact.FORCE_STD: 0.05 * force,
        contact.STIFFNESS: force / r,
        contact.STIFFNESS_STD: 0.05 * force / r,
        contact.TANGENT_STIFFNESS: np.gradient(force, approach),
        contact.HERTZ_FORCE: HERTZ * smooth**1.5,
        contact.HERTZ_STIFFNESS: HERTZ * smooth**1.5 / r,
        contact.FILTER: magnitude,
        contact.FILTER_RAW: np.where(excited, 1.02 * magnitude, np.nan),
        contact.FILTER_APPLIED: 0.99 * magnitude,
        contact.FILTER_STD: 0.05 + 0 * noisy,
        contact.FILTER_SIGNED: noisy,
        contact.FILTER_COHERENCE: magnitude,
        contact.FILTER_THEORY: theory,
        contact.FILTER_EXCITED: excited.astype(np.int8),
        contact.FILTER_SCALE: np.linspace(0.9, 0.5, 9),
        contact.PRINTED_FILTER: magnitude,
        contact.CONTACT_RADIUS: radius,
        contact.PRESSURE: pressure,
        contact.GAP: np.where(pressure > 0, 0, 1e-7),
        contact.APPROACH: approach,
        contact.WAVENUMBER: wavenumber,
        contact.PX: side,
        contact.PY: side,
    }
    datum = {"datum": DATUM, "datum_samples": DATUM, "datum_path": 1.25 * DATUM, "samples": 8}
    working = {"working_load": LOAD, "working_approach": 0.55e-6, "contact_area": 3.1e-8}
    found = group(values, hertz_radius=1.25e-4, hertz_constant=HERTZ, **datum, **working)
    found["filter"].attrs["normalise"] = "tangent"
    return found


def of_rolling(rng, laws, steps, time_step):
    shared = np.convolve(rng.standard_normal(steps + 40), np.hanning(41), "same")[:steps]
    force = np.empty((len(laws), steps))
    for row, law in enumerate(laws):
        own = np.convolve(rng.standard_normal(steps + 20), np.hanning(21), "same")[:steps]
        force[row] = LOAD + 0.42 * shared + 0.12 * own * (1 + row / 3)
        if not law.startswith("linear"):
            force[row] = np.maximum(force[row], 0)
    lost = force <= 0
    lost[[law.startswith("linear") for law in laws]] = False
    events, terms = (np.diff(lost.astype(int), axis=1) == 1).sum(1), ["work of the load", "beam", "contact"]
    values = {
        rolling.CONTACT_FORCE: force,
        rolling.RELATIVE_DISPLACEMENT: 0.5e-6 + 1e-7 * force / LOAD,
        schema.ACCELERATION: 3 * rng.standard_normal((len(laws), len(SENSORS), steps)),
        rolling.CONTACT_LOSS_SHARE: lost.mean(1),
        rolling.CONTACT_LOSS_EVENTS: events,
        rolling.LONGEST_LOSS: 1.3e-4 * (events > 0),
        schema.ENERGY: rng.uniform(-1e-4, 1e-3, (len(laws), len(terms))),
        schema.ENERGY_RESIDUAL: rng.uniform(1e-12, 1e-10, len(laws)),
        rolling.LAW: laws,
        schema.ROLLING_SENSOR: SENSORS,
        rolling.TIME: time_step * np.arange(steps),
        schema.ENERGY_TERM: terms,
    }
    return group(values)


def of_spectra(rng, laws, duration):
    frequency, band = np.arange(0, 6000, 4.0), 1000 * 10 ** (np.arange(-15, 8) / 10)
    tilt = 1 + 0.4 * np.arange(len(laws))[:, None] * (frequency / 3000)
    force = 0.02 / (1 + (frequency / 900) ** 2) * tilt * rng.gamma(20, 1 / 20, tilt.shape)
    force[:, 0] = 0
    level = -10 - 8 * np.log10(band / 1000) ** 2 + np.arange(len(laws))[:, None] * np.log2(band / 250)
    level = level + rng.normal(0, 0.4, level.shape)
    product, sensors = 0.23 * band * duration, np.ones((1, len(SENSORS), 1))

    def difference(to):
        return level - level[laws.index(to)] if to in laws else np.full_like(level, np.nan)

    practice, bare = spectra.FORCE_LEVEL_DIFFERENCES.values()
    values = {
        spectra.FORCE_PSD: force,
        spectra.FORCE_LEVEL: level,
        spectra.BAND_TIME_PRODUCT: product,
        spectra.LEVEL_DEVIATION: 4.34 / np.sqrt(product),
        practice: difference("linear-filtered"),
        bare: difference("linear"),
        spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE: difference("table"),
        schema.ACCELERATION_PSD: force[:, None] * rng.uniform(0.5, 2, sensors.shape),
        schema.ACCELERATION_LEVEL: level[:, None] + 120 * sensors,
        spectra.LAW: laws,
        schema.SPECTRA_SENSOR: SENSORS,
        spectra.FREQUENCY: frequency,
        spectra.BAND: band,
    }
    found = group(values)
    found[spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE.name].attrs["reference"] = "table"
    return found


def report_tree(laws=None, steps=100_000, time_step=1e-5, seed=7):
    """Result tree of a made-up run: `laws` over `steps` time steps of `time_step` s."""
    laws = list(LAWS if laws is None else laws)
    rng = np.random.default_rng(seed)
    return xr.DataTree.from_dict(
        {
            "/": xr.Dataset(attrs=ROOT),
            "/scenario": scenario(laws),
            "/surface": of_surface(rng),
            "/contact": of_contact(rng),
            "/rolling": of_rolling(rng, laws, steps, time_step),
            "/spectra": of_spectra(rng, laws, steps * time_step),
        }
    )


def with_force(*series):
    """Tree whose laws, the first of them the main one, have these forces."""
    tree = report_tree(["areal", "shifted", "linear"][: len(series)], steps=len(series[0]))
    force, share = np.array(series), [float((each <= 0).mean()) for each in series]
    held = tree["rolling"].to_dataset()
    tree["rolling"] = held.assign(contact_force=(("law", "time"), force), contact_loss_share=("law", share))
    return tree


def uncertain(share, laws=("areal", "table", "linear-filtered", "linear")):
    """Tree in which B T reaches ten after a share of the bands."""
    tree = report_tree(list(laws), steps=1000)
    bands = tree["spectra"].sizes["band"]
    product = 10.0 * 10 ** ((np.arange(bands) - share * bands) / 10)
    tree["spectra"]["band_time_product"].values[:] = product
    return tree, product < 10.0


def laws_in(chart):
    """Laws that can be shown or not."""
    found = {getattr(mark, "law", "") for panel in chart.panels for mark in panel.marks}
    return found - {""}
