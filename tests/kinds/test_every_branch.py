"""Every way to say a texture, a wheel and a law, from a case file to numbers that theory expects."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.interpolate import CubicSpline

from asperity.cli import main
from asperity.laws.registry import names
from asperity.reference.cnossos import rail_roughness
from asperity.results import read_result
from asperity.running import run

LOAD, SPEED = 65e3, 56.0
RAIL = """
kind = "wheel-on-rail"
laws = {laws}
duration = "{duration}"
settling = "20 ms"
[surface]
{surface}
[wheel]
{wheel}
[contact]
spacing = "1 mm"
samples = 1
sample_length = "60 mm"
{contact}
[numerics]
highest_frequency = "2 kHz"
poles = 60
"""
BALL = """
kind = "ball-on-beam"
laws = {laws}
start = "0.45 m"
duration = "{duration}"
settling = "5 ms"
[surface]
rms = "0.1 um"
longest = "0.4 mm"
shortest = "60 um"
[ball]
load = "30 N"
[contact]
spacing = "20 um"
window = "0.66 mm"
samples = 1
sample_length = "1.4 mm"
{contact}
[numerics]
highest_frequency = "2 kHz"
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def from_file(text):
    """Write a case, and run it."""
    Path("case.toml").write_text(text, encoding="utf-8")
    return run("case.toml")


def rail(surface="smooth = true", wheel="", contact="", laws=("linear",), duration="40 ms"):
    keys = {"surface": surface, "wheel": wheel, "contact": contact, "duration": duration}
    return from_file(RAIL.format(laws=json.dumps(list(laws)), **keys))


def force(tree, law="linear"):
    return tree["rolling/contact_force"].sel(law=law, contact=1).values


@pytest.fixture(scope="module")
def smooth(tmp_path_factory):
    """Force of a smooth wheel on a smooth rail: its sleepers alone."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("smooth"))
        return force(rail())


# --- every law of every kind, with its report


@pytest.mark.parametrize(
    ("text", "load_on_contact"),
    [
        (
            RAIL.format(
                laws="{laws}", surface='spectrum = "iso3095"', wheel="", contact="", duration="12 ms"
            ),
            LOAD,
        ),
        (BALL.format(laws="{laws}", contact="", duration="12 ms"), 30.0),
    ],
    ids=["wheel-on-rail", "ball-on-beam"],
)
def test_every_law_rolls_and_is_reported(folder, text, load_on_contact):
    Path("case.toml").write_text(text.replace("{laws}", json.dumps(list(names()))), encoding="utf-8")
    done = CliRunner().invoke(main, ["run", "case.toml", "-o", "out"])
    assert done.exit_code == 0, done.output
    tree = read_result("out")
    found = tree["rolling/contact_force"]
    assert sorted(found.law.values) == sorted(names())
    assert np.isfinite(found.values).all()
    np.testing.assert_allclose(found.mean("time"), load_on_contact, rtol=0.15)
    assert (found.std("time") > 1e-3 * load_on_contact).all()
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    assert all(name in page for name in names())
    heads = [path.read_text(encoding="utf-8").splitlines()[0] for path in (folder / "out").glob("*.csv")]
    assert len(heads) >= 10
    assert any(all(name in head for name in names()) for head in heads)


# --- textures of a rail


def sine(points, wavelength=80e-3, amplitude=5e-6):
    """Heights 1 mm apart, m: the wheel meets a wave every 1.43 ms, 700 Hz."""
    return amplitude * np.sin(2 * np.pi * 1e-3 * np.arange(points) / wavelength)


def told(tree):
    return tree["surface"].attrs["source"]


def is_a_tone_of_the_sine(tree, smooth):
    """Texture is linear in a linear contact: what it adds to the smooth force has its frequency alone."""
    added = force(tree) - smooth
    level = np.abs(np.fft.rfft(added * np.hanning(len(added))))
    step = float(tree["rolling/time"][1] - tree["rolling/time"][0])
    frequency = np.fft.rfftfreq(len(added), step)
    assert frequency[np.argmax(level)] == pytest.approx(SPEED / 80e-3, abs=20.0)
    psd, reference = (tree["spectra"][name].values for name in ("force_psd", "linear_reference_psd"))
    at = np.argmin(np.abs(tree["spectra/frequency"].values - 700.0))
    near = slice(max(at - 3, 0), at + 4)
    ratio = psd[0, near].sum() / reference[..., near].sum()
    assert 10 * abs(math.log10(ratio)) < 2.0  # solved in the frequency domain, with the wheel at rest


def test_a_measured_map_of_a_rail(smooth):
    heights = np.repeat(sine(4000)[:, None], 24, axis=1)
    np.save("map.npy", heights)
    tree = rail('file = "map.npy"\nheight_unit = "m"\npixel = "1 mm"')
    assert "measured, map.npy" in told(tree)
    assert "path cut from the first" in told(tree)
    is_a_tone_of_the_sine(tree, smooth)


def test_a_measured_line_of_a_rail(smooth):
    rows = "\n".join(f"{x}\t{1e6 * z:.9f}" for x, z in enumerate(sine(4000)))
    Path("line.txt").write_text(f"x [mm]\tz [um]\n{rows}\n")
    tree = rail('line = "line.txt"\naccept_levels = true')  # but for its tone, it is smoother than rails are
    assert "line.txt" in told(tree)
    is_a_tone_of_the_sine(tree, smooth)


def test_a_rail_of_a_given_rms(smooth):
    """No waves shorter than it says, and twice the rms is twice the force that it adds."""
    keys = 'rms = "{} um"\nlongest = "0.1 m"\nshortest = "10 mm"'
    single, double = rail(keys.format(1)), rail(keys.format(2))
    line = single["surface/line"].values
    assert line.std() == pytest.approx(1e-6, rel=0.35)
    power = np.abs(np.fft.rfft((line - line.mean()) * np.hanning(len(line)))) ** 2
    wavenumber = np.fft.rfftfreq(len(line), 1e-3)
    assert power[wavenumber > 110.0].sum() < 1e-4 * power.sum()
    added = force(single) - smooth
    assert added.std() > 100.0
    np.testing.assert_allclose(force(double) - smooth, 2 * added, atol=1e-3 * added.std())


def test_a_table_as_spectrum_is_the_named_one():
    wavelength, level = rail_roughness("iso3095")
    rows = "\n".join(
        f"{100 * w!r}; {value!r}" for w, value in zip(wavelength.tolist(), level.tolist(), strict=True)
    )
    Path("limit.csv").write_text(f"wavelength (cm); level (dB re 1 um)\n{rows}\n")
    named, table = rail('spectrum = "iso3095"'), rail('spectrum = "limit.csv"')
    assert "limit" in told(table)
    np.testing.assert_allclose(force(table), force(named), rtol=1e-9)


# --- wheels


def test_a_wheel_by_its_modes_and_by_its_receptance():
    """Two modes on a rigid mass; the receptance is written from the textbook formula, and fitted again."""
    natural, ratio, mass = (600.0, 1400.0), (0.02, 0.01), (400.0, 300.0)
    rows = "\n".join(f"{f}, {z}, {m}" for f, z, m in zip(natural, ratio, mass, strict=True))
    Path("modes.csv").write_text(f"frequency (Hz), damping ratio, modal mass (kg)\n{rows}\n")
    frequency = np.arange(20.0, 3000.0, 5.0)
    omega = 2 * np.pi * frequency
    alpha = -1.0 / (600.0 * omega**2) + sum(
        1.0 / (m * ((2 * np.pi * f) ** 2 - omega**2 + 2j * z * 2 * np.pi * f * omega))
        for f, z, m in zip(natural, ratio, mass, strict=True)
    )
    rows = "\n".join(f"{f}, {a.real!r}, {a.imag!r}" for f, a in zip(frequency, alpha.tolist(), strict=True))
    Path("receptance.csv").write_text(f"frequency (Hz), real part (m/N), imaginary part (m/N)\n{rows}\n")
    surface = 'spectrum = "iso3095"'
    rigid, modes, receptance = (
        force(rail(surface, wheel)) for wheel in ("", 'modes = "modes.csv"', 'receptance = "receptance.csv"')
    )
    assert (modes - rigid).std() > 0.1 * rigid.std()
    assert (receptance - modes).std() < 0.05 * (modes - rigid).std()


# --- the stiffness of a linear contact


def stiffness_of(tree):
    """Slope of the force over the approach, with the texture that the contact meets held fixed."""
    rolling = tree["rolling"].to_dataset().sel(law="linear", contact=1)
    line, position = tree["surface/line"], rolling["position"].values
    texture = np.interp(position - position[0], line["distance"].values, line.values)
    columns = np.column_stack([rolling["relative_displacement"].values, texture, np.ones(texture.size)])
    scale = columns.std(axis=0)
    scale[-1] = 1.0
    found, *_ = np.linalg.lstsq(columns / scale, rolling["contact_force"].values, rcond=None)
    return float(found[0] / scale[0])


@pytest.mark.parametrize("kind", ["wheel-on-rail", "ball-on-beam"])
def test_a_linear_contact_has_the_stiffness_of_the_rough_one(kind):
    """dF/dr of the loading curve in the result; that of smooth bodies is 3/2 F^(1/3) K^(2/3).

    They are stiffer than short asperities; the long waves of a rail bend one sample to either side.
    """
    found = {}
    for linearise in ("rough", "hertz"):
        contact, laws = f'linearise = "{linearise}"', ["areal", "linear"]
        if kind == "wheel-on-rail":
            tree = rail(
                'spectrum = "iso3095"\nlevel = "+10 dB"', contact=contact, laws=laws, duration="20 ms"
            )
        else:
            tree = from_file(BALL.format(laws=json.dumps(laws), contact=contact, duration="10 ms"))
        found[linearise] = stiffness_of(tree)
    contact = tree["contact"]
    load_on_contact, constant = contact.attrs["working_load"], contact.attrs["hertz_constant"]
    assert found["hertz"] == pytest.approx(1.5 * load_on_contact ** (1 / 3) * constant ** (2 / 3), rel=1e-3)
    states, forces = contact["approach"].values, contact["force"].values
    approach = np.interp(load_on_contact, forces, states)
    assert found["rough"] == pytest.approx(float(CubicSpline(states, forces)(approach, 1)), rel=0.03)
    assert abs(found["rough"] / found["hertz"] - 1.0) > 0.01
    if kind == "ball-on-beam":
        assert found["rough"] < 0.96 * found["hertz"]
