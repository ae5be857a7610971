"""A synthetic result with the shape and the size of a real run, made from closed forms and noise."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from asperity.laws import spec_of
from asperity.scenes.report import CHAPTERS
from asperity.schema import VERSION

LAWS = ["areal", "shifted", "printed", "table", "linear-filtered", "linear"]
SENSORS = [0.2, 0.35, 0.5, 0.65, 0.8]
DATUM = 1.5e-6
LOAD = 5.0
RADIUS = 0.025
MODULUS = 115e9  # E* of steel on steel


def figures_by_name(kind="ball-on-beam"):
    """All figures that a result may have, of two of one name that of a kind of case."""
    figures = [figure for chapter in CHAPTERS for figure in chapter.figures]
    return {figure.name: figure for figure in (figures if kind == "wheel-on-rail" else figures[::-1])}


def variable(dims, values, units, long_name):
    return (dims, values, {"units": units, "long_name": long_name})


def root_attrs():
    return {
        "title": "Steel ball on a steel beam",
        "asperity_version": "0.1.0",
        "schema_version": VERSION,
        "created": "2026-01-02T03:04:05+00:00",
        "case": 'kind = "ball-on-beam"\nspeed = "1 m/s"\n\n[ball]\nradius = "25 mm"\nmaterial = "steel"\n',
        "seed": 1,
        "citations": json.dumps(
            [
                "O. Lundberg, licentiate thesis, KTH Stockholm, 2014.",
                "A. E. H. Love, Phil. Trans. R. Soc. A 228, 1929.",
            ]
        ),
        "verdict": "The ball keeps contact for 97.9 % of the time; areal lies within 1.3 dB of table.",
        "warnings": json.dumps(
            [
                {
                    "category": "ExtrapolationWarning",
                    "message": "Approach 3.2 µm left the computed range. Add a larger approach.",
                    "count": 12,
                },
                {
                    "category": "ShortRecordWarning",
                    "message": "1 s holds 63 periods of the lowest band. Roll longer.",
                    "count": 1,
                },
            ]
        ),
    }


def scenario(laws):
    def parameter(key, value, default, note=""):
        return {"key": key, "value": value, "default": default, "is_default": value == default, "note": note}

    return xr.Dataset(
        attrs={
            "kind": "ball-on-beam",
            "parameters": json.dumps(
                [
                    parameter("kind", "ball-on-beam", "ball-on-beam"),
                    parameter("speed", "1 m/s", "1 m/s"),
                    parameter(
                        "laws",
                        "areal, shifted, printed, table, linear",
                        "areal, linear",
                        "the first is the main one",
                    ),
                    parameter("seed", "1", "1"),
                    parameter("duration", "0.6 s", "the beam's length", "0.6 m of path"),
                    parameter("surface.file", "aa5754_um.npz", "none"),
                    parameter("surface.array", "polished", "none"),
                    parameter("ball.radius", "25 mm", "25 mm"),
                    parameter("ball.material", "steel", "steel", "E = 210 GPa, ν = 0.3, ρ = 7850 kg/m³"),
                    parameter("ball.load", "its weight", "its weight", "5.04 N"),
                    parameter("beam.length", "1 m", "1 m"),
                    parameter("beam.width", "50 mm", "50 mm"),
                    parameter("beam.height", "12 mm", "10 mm"),
                    parameter("beam.loss_factor", "0.005", "0.005"),
                    parameter("beam.support", "simply-supported", "simply-supported"),
                    parameter("contact.spacing", "8 µm", "8 µm"),
                    parameter("contact.window", "0.5 mm", "0.5 mm"),
                    parameter("contact.samples", "8", "8"),
                ]
            ),
            "numerics": json.dumps(
                [
                    {"name": "time step", "value": "10 µs"},
                    {"name": "steps", "value": "100 000"},
                    {"name": "grid of a contact", "value": "64 × 64"},
                    {"name": "contact solves", "value": "12 288"},
                    {"name": "iterations per solve", "value": "17.3"},
                    {"name": "largest residual", "value": "9.1e-9"},
                    {"name": "run time: scan", "value": "21.4 s"},
                ]
            ),
            "laws": json.dumps([spec_of(law).entry() for law in laws]),
        }
    )


def texture(rng, shape, spacing, rms=0.3e-6, hurst=0.8, longest=0.4e-3):
    kx = np.fft.fftfreq(shape[0], spacing)[:, None]
    ky = np.fft.rfftfreq(shape[1], spacing)[None, :]
    k = np.hypot(kx, ky)
    amplitude = np.where(k > 0, np.maximum(k, 1 / longest) ** -(1 + hurst), 0)
    noise = rng.standard_normal(k.shape) + 1j * rng.standard_normal(k.shape)
    heights = np.fft.irfft2(noise * amplitude, s=shape)
    return heights * rms / heights.std()


def surface(rng):
    spacing = 8e-6
    sample, path = texture(rng, (128, 128), spacing), texture(rng, (2000, 64), spacing)
    line = texture(rng, (20000, 2), spacing)[:, 0]
    wavenumber = np.linspace(200, 62500, 400)
    psd = 2e-16 / (1 + (wavenumber / 2500) ** 2) ** 1.3

    statistics = (
        ("Sq", 0.31e-6, "m", "samples", "root mean square height"),
        ("Sa", 0.24e-6, "m", "samples", "mean absolute height"),
        ("Ssk", -0.41, "1", "samples", "skewness"),
        ("Sdq", 0.021, "1", "samples", "root mean square gradient"),
        ("Sal", 41e-6, "m", "samples", "shortest autocorrelation length"),
        ("Rq", 0.29e-6, "m", "path", "root mean square height of the centre line"),
    )
    keys = ("symbol", "value", "unit", "surface", "meaning")
    return xr.Dataset(
        {
            "sample_heights": variable(("x", "y"), sample, "m", "heights of the first sample"),
            "path_heights": variable(("path_x", "path_y"), path, "m", "heights of the path"),
            "line": variable("distance", line, "m", "centre line of the path"),
            "path_height_density": variable(
                "path_height", np.exp(-0.5 * np.linspace(-3, 3, 80) ** 2), "1/m", "density of the heights"
            ),
            "psd_sample": variable(
                "surface_wavenumber", psd * rng.gamma(8, 1 / 8, 400), "m3", "PSD of the samples"
            ),
            "psd_path": variable(
                "surface_wavenumber", psd * rng.gamma(60, 1 / 60, 400), "m3", "PSD of the path"
            ),
        },
        coords={
            "x": ("x", spacing * np.arange(128), {"units": "m"}),
            "y": ("y", spacing * np.arange(128), {"units": "m"}),
            "path_x": ("path_x", spacing * np.arange(2000), {"units": "m"}),
            "path_y": ("path_y", spacing * np.arange(64), {"units": "m"}),
            "distance": ("distance", spacing * np.arange(20000), {"units": "m"}),
            "path_height": ("path_height", 0.3e-6 * np.linspace(-3, 3, 80), {"units": "m"}),
            "surface_wavenumber": ("surface_wavenumber", wavenumber, {"units": "1/m"}),
        },
        attrs={
            "source": "aa5754_um.npz, array polished",
            "missing_share": 0.0,
            "statistics": json.dumps(
                [dict(zip(keys, s, strict=True)) | {"bandwidth": "16 µm … 0.8 mm"} for s in statistics]
            ),
        },
    )


def sinc(q):
    return np.sinc(q / np.pi)


def contact(rng):
    approach = np.array([-1.0, -0.5, 0.0, 0.3, 0.6, 1.0, 1.5, 2.0, 3.0]) * 1e-6
    r = approach + DATUM
    hertz = 4 / 3 * MODULUS * np.sqrt(RADIUS) * np.maximum(approach, 0) ** 1.5
    force = (
        4
        / 3
        * MODULUS
        * np.sqrt(RADIUS)
        * (np.maximum(approach, 0) ** 3 + (0.15e-6 * np.exp(approach / 0.4e-6)).clip(max=0.4e-6) ** 3) ** 0.5
    )
    radius = np.sqrt(RADIUS * np.maximum(approach, 0.05e-6))
    wavenumber = np.geomspace(500, 25000, 68)  # twelfths of an octave
    theory = sinc(2 * np.pi * wavenumber * radius[:, None])
    noisy = theory + 0.01 * rng.standard_normal(theory.shape)
    noisy[0] = theory[0] = np.nan
    excited = wavenumber < 21e3
    estimated = np.where(excited, np.abs(noisy), np.nan)
    side = np.linspace(-0.25e-3, 0.25e-3, 64)
    x, y = np.meshgrid(side, side, indexing="ij")
    a = 1.3e-4
    pressure = 2.4e8 * np.sqrt(np.maximum(1 - (x**2 + y**2) / a**2, 0)) * rng.gamma(1.2, 1, x.shape)
    return xr.Dataset(
        {
            "force": variable("approach", force, "N", "contact force"),
            "force_std": variable("approach", 0.05 * force, "N", "its spread"),
            "stiffness": variable("approach", force / r, "N/m", "contact stiffness F/r"),
            "stiffness_std": variable("approach", 0.05 * force / r, "N/m", "its spread"),
            "tangent_stiffness": variable("approach", np.gradient(force, approach), "N/m", "dF/dδ"),
            "hertz_force": variable("approach", hertz, "N", "Hertz"),
            "hertz_stiffness": variable("approach", hertz / r, "N/m", "F/r of smooth bodies, at r − d₀"),
            "filter": (
                ("approach", "wavenumber"),
                np.abs(noisy),
                {"units": "1", "long_name": "contact filter, magnitude", "normalise": "tangent"},
            ),
            "filter_raw": variable(("approach", "wavenumber"), 1.02 * estimated, "1", "ratio of the spectra"),
            "filter_applied": variable(("approach", "wavenumber"), 0.99 * np.abs(noisy), "1", "of the taps"),
            "filter_std": variable(("approach", "wavenumber"), 0.05 + 0 * noisy, "1", "its spread"),
            "filter_signed": variable(("approach", "wavenumber"), noisy, "1", "contact filter, signed"),
            "filter_coherence": variable(("approach", "wavenumber"), np.abs(noisy), "1", "coherence"),
            "filter_theory": variable(("approach", "wavenumber"), theory, "1", "sin q / q"),
            "filter_excited": variable("wavenumber", excited.astype(np.int8), "1", "1 where excited"),
            "filter_scale": variable("approach", np.linspace(0.9, 0.5, 9), "1", "k_0/k_t"),
            "printed_filter": variable(("approach", "wavenumber"), np.abs(noisy), "1", "as printed"),
            "printed_filter_raw": variable(("approach", "wavenumber"), estimated, "1", "ratio"),
            "printed_filter_applied": variable(("approach", "wavenumber"), np.abs(noisy), "1", "of the taps"),
            "contact_radius": variable("approach", radius, "m", "radius of the Hertz contact"),
            "pressure": variable(("px", "py"), pressure, "Pa", "contact pressure"),
            "gap": variable(("px", "py"), np.where(pressure > 0, 0, 1e-7), "m", "gap"),
        },
        coords={
            "approach": ("approach", approach, {"units": "m"}),
            "wavenumber": ("wavenumber", wavenumber, {"units": "1/m"}),
            "px": ("px", side, {"units": "m"}),
            "py": ("py", side, {"units": "m"}),
        },
        attrs={
            "datum": DATUM,
            "datum_samples": DATUM,
            "datum_path": 1.25 * DATUM,
            "samples": 8,
            "working_load": LOAD,
            "working_approach": 0.55e-6,
            "hertz_radius": 1.25e-4,
            "hertz_constant": 4 / 3 * MODULUS * np.sqrt(RADIUS),
            "contact_area": 3.1e-8,
        },
    )


def rolling(rng, laws, steps, time_step):
    time = time_step * np.arange(steps)
    shared = np.convolve(rng.standard_normal(steps + 40), np.hanning(41), "same")[:steps]
    force = np.empty((len(laws), steps))
    for row, law in enumerate(laws):
        own = np.convolve(rng.standard_normal(steps + 20), np.hanning(21), "same")[:steps]
        swing = 0.42 * shared + 0.12 * own * (1 + row / 3)
        force[row] = LOAD + swing if law.startswith("linear") else np.maximum(LOAD + swing, 0)
    lost = force <= 0
    lost[[law.startswith("linear") for law in laws]] = False
    events = (np.diff(lost.astype(int), axis=1) == 1).sum(1)
    acceleration = 3 * rng.standard_normal((len(laws), len(SENSORS), steps))
    terms = ["work of the load", "ball kinetic", "beam", "beam damping", "contact"]
    energy = rng.uniform(-1e-4, 1e-3, (len(laws), len(terms)))
    approach = variable(("law", "time"), 0.5e-6 + 1e-7 * force / LOAD, "m", "approach")
    return xr.Dataset(
        {
            "contact_force": variable(("law", "time"), force, "N", "contact force"),
            "relative_displacement": approach,
            "acceleration": variable(
                ("law", "sensor", "time"), acceleration, "m/s2", "acceleration of the beam"
            ),
            "ball_displacement": variable(("law", "time"), 1e-6 * force, "m", "displacement of the ball"),
            "beam_displacement": variable(("law", "time"), 1e-6 * force, "m", "displacement of the beam"),
            "contact_loss_share": variable("law", lost.mean(1), "1", "share of time without contact"),
            "contact_loss_events": variable("law", events, "1", "events of contact loss"),
            "longest_loss": variable("law", 1.3e-4 * (events > 0), "s", "longest loss of contact"),
            "energy": variable(("law", "energy_term"), energy, "J", "energy balance"),
            "energy_residual": variable(
                "law", rng.uniform(1e-12, 1e-10, len(laws)), "1", "what is left of the balance"
            ),
        },
        coords={
            "law": laws,
            "sensor": ("sensor", SENSORS, {"units": "m"}),
            "time": ("time", time, {"units": "s"}),
            "energy_term": terms,
        },
    )


def spectra(rng, laws, duration):
    frequency = np.arange(0, 6000, 4.0)
    band = 1000 * 10 ** (np.arange(-15, 8) / 10)
    resonances = sum(
        30 * np.exp(-(((frequency - f0) / (0.01 * f0 + 3)) ** 2)) for f0 in 27 * np.arange(1, 15) ** 2.0
    )
    base = 0.02 / (1 + (frequency / 900) ** 2)
    tilt = 1 + 0.4 * np.arange(len(laws))[:, None] * (frequency / 3000)
    force = base * tilt * rng.gamma(20, 1 / 20, (len(laws), len(frequency)))
    force[:, 0] = 0
    shape = (len(laws), len(SENSORS), len(frequency))
    acceleration = (
        force[:, None] * (1 + resonances) * rng.uniform(0.5, 2, (1, len(SENSORS), 1)) * np.ones(shape)
    )
    level = -10 - 8 * np.log10(band / 1000) ** 2 + np.arange(len(laws))[:, None] * np.log2(band / 250)
    level = level + rng.normal(0, 0.4, level.shape)

    def difference(to):
        return level - level[laws.index(to)] if to in laws else np.full_like(level, np.nan)

    return xr.Dataset(
        {
            "force_psd": variable(("law", "frequency"), force, "N2/Hz", "contact force PSD"),
            "force_level": variable(("law", "band"), level, "dB re 1 N", "contact force level"),
            "band_time_product": variable("band", 0.23 * band * duration, "1", "B T"),
            "level_deviation": variable("band", 4.34 / np.sqrt(0.23 * band * duration), "dB", "chance"),
            "force_level_difference_to_linear_filtered": variable(
                ("law", "band"), difference("linear-filtered"), "dB", "difference to linear-filtered"
            ),
            "force_level_difference_to_linear": variable(
                ("law", "band"), difference("linear"), "dB", "difference to linear"
            ),
            "force_level_difference_to_reference": (
                ("law", "band"),
                difference("table"),
                {"units": "dB", "long_name": "difference to table", "reference": "table"},
            ),
            "acceleration_psd": variable(
                ("law", "sensor", "frequency"), acceleration, "(m/s2)2/Hz", "acceleration PSD"
            ),
            "acceleration_level": variable(
                ("law", "sensor", "band"),
                level[:, None] + 120 + np.zeros((1, len(SENSORS), 1)),
                "dB re 1e-6 m/s2",
                "acceleration level",
            ),
        },
        coords={
            "law": laws,
            "sensor": ("sensor", SENSORS, {"units": "m"}),
            "frequency": ("frequency", frequency, {"units": "Hz"}),
            "band": ("band", band, {"units": "Hz"}),
        },
    )


def report_tree(laws=None, steps=100_000, time_step=1e-5, seed=7):
    """Result tree of a made-up run: `laws` over `steps` time steps of `time_step` s."""
    laws = list(LAWS if laws is None else laws)
    rng = np.random.default_rng(seed)
    root = xr.Dataset(attrs=root_attrs())
    return xr.DataTree.from_dict(
        {
            "/": root,
            "/scenario": scenario(laws),
            "/surface": surface(rng),
            "/contact": contact(rng),
            "/rolling": rolling(rng, laws, steps, time_step),
            "/spectra": spectra(rng, laws, steps * time_step),
        }
    )


def with_force(*series):
    """Tree whose laws, the first of them the main one, have these forces."""
    tree = report_tree(["areal", "shifted", "linear"][: len(series)], steps=len(series[0]))
    force, share = np.array(series), [float((each <= 0).mean()) for each in series]
    rolling = tree["rolling"].to_dataset()
    tree["rolling"] = rolling.assign(
        contact_force=(("law", "time"), force), contact_loss_share=("law", share)
    )
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
