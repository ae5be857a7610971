"""Measured lines of rail and wheel on the path of a case."""

import json

import numpy as np
import pytest

from asperity.case.cases import parse_case
from asperity.errors import InputError, ShortRecordWarning
from asperity.scenarios.textures import textures_of
from like_measured import either, wheel_lines

CASE = """
kind = "wheel-on-rail"
laws = ["areal", "linear"]
speed = "56 m/s"
duration = "{duration}"
settling = "50 ms"
contact = {{spacing = "1 mm", samples = 2, sample_length = "60 mm"}}
numerics = {{highest_frequency = "4 kHz", poles = 60}}
[surface]
{surface}
[wheel]
section = "rigid"
{wheel}
"""
LINES = 'line = "lines.npz"\nline_unit = "um"\nline_spacing = "1 mm"\n'
APART = 'line_distance = "5 mm"\n'


def case(folder, surface="smooth = true", wheel="", duration="40 ms"):
    return parse_case(CASE.format(surface=surface, wheel=wheel, duration=duration), folder / "case.toml")


def laid(folder, lines, surface="smooth = true", wheel="", duration="40 ms"):
    """Textures of a case with measured lines, µm."""
    np.savez(folder / "lines.npz", lines=np.atleast_2d(lines))
    return textures_of(case(folder, surface, wheel, duration))


def all_of(path):
    return path.rows(0, path.shape[0])


def turn(points, seed=0):
    """Smooth noise in µm that closes on itself."""
    noise = np.random.default_rng(seed).standard_normal(points)
    return np.convolve(np.concatenate([noise, noise[:24]]), np.hanning(25), "valid")


class TestRail:
    def test_a_line_is_the_same_all_across_and_goes_on_as_the_case_says(self, tmp_path):
        rows = "\n".join(f"{a}\t{b:.6f}" for a, b in enumerate(turn(2000)))
        (tmp_path / "line.txt").write_text(f"x [mm]\tz [um]\n{rows}\n")
        for how, again in (("mirror", slice(1998, 998, -1)), ("repeat", slice(1000))):
            found = textures_of(case(tmp_path, f'line = "line.txt"\ncontinuation = "{how}"'))
            np.testing.assert_allclose(np.ptp(all_of(found.path), axis=1), 0.0, atol=1e-15)
            assert np.std(found.line) == pytest.approx(1e-6 * np.std(turn(2000)), rel=0.1)
            np.testing.assert_allclose(found.line[2000:3000], found.line[again], atol=1e-12)
            for said in ("EN 15610", "spikes kept", f"{how}ed"):
                assert said in found.origin
        with pytest.raises(InputError, match="rail's record: received 2 m"):
            textures_of(case(tmp_path, 'line = "line.txt"\ncontinuation = "refuse"'))

    def test_several_lines_lie_beside_each_other(self, tmp_path):
        lines = [turn(6000, seed) for seed in range(3)]
        found = laid(tmp_path, lines, LINES + APART)
        assert np.ptp(all_of(found.path), axis=1).max() > 0.0
        with pytest.raises(InputError, match=r"surface\.line_distance: received no distance for 3 lines"):
            laid(tmp_path, lines, LINES)

    def test_gaps_are_refused_until_they_are_to_be_filled(self, tmp_path):
        gap = np.where(np.arange(6000) == 3000, np.nan, turn(6000))
        with pytest.raises(InputError, match="missing points inside"):
            laid(tmp_path, gap, LINES)
        assert "1 point filled" in laid(tmp_path, gap, LINES + 'processing = ["fill"]').origin


class TestWheel:
    def test_turn_of_the_record_is_the_turn_of_the_wheel(self, tmp_path):
        wheel = laid(tmp_path, turn(2870), wheel=LINES, duration="80 ms").parts["wheel"]
        np.testing.assert_array_equal(wheel[2870:], wheel[:-2870])
        with pytest.raises(InputError, match=r"wheel\.line: received 2\.5 m"):
            laid(tmp_path, turn(2500), wheel=LINES)

    def test_short_lines_are_left_out(self, tmp_path):
        lines = np.stack([turn(2890, seed) for seed in range(3)])
        lines[1, 2000:] = np.nan
        with pytest.warns(ShortRecordWarning, match="1 of 3 lines of the wheel"):
            laid(tmp_path, lines, wheel=LINES + APART)


@either
def test_flat_of_a_measured_wheel_is_found(tmp_path, runs, measured):
    flat = wheel_lines(0.6, measured=measured)
    np.savez(tmp_path / "lines.npz", flat=flat, other=np.zeros((10, 2880)))
    wheel = f'radius = "0.459 m"\n{LINES}{APART}line_array = "flat"\nprocessing = ["curvature"]'
    found = runs(case(tmp_path, wheel=wheel, duration="0.11 s"))
    force = found["rolling/contact_force"].sel(law="areal", contact=1)
    assert float(force.max()) > 2 * 65e3
    struck = found["rolling/position"].values[force.values > 0.9 * float(force.max())]
    turns = np.round((struck - struck[0]) / (2 * np.pi * 0.459))
    np.testing.assert_allclose(struck - struck[0], turns * 2.88, atol=0.1)  # once a turn, at one place
    assert int(found["rolling/contact_loss_events"].sel(law="areal", contact=1)) >= 2
    assert "rolled over with a circle" in found["surface"].attrs["source"]
    assert json.loads(found.attrs["warnings"])
