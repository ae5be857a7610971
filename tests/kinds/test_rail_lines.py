"""Measured lines of rail and wheel on the path of a case."""

import json

import numpy as np
import pytest

from asperity.case.cases import parse_case
from asperity.errors import InputError, ShortRecordWarning
from asperity.running import prepare_case, run
from asperity.scenarios.laws import working_point
from asperity.scenarios.linear_force import force_transfer
from asperity.scenarios.textures import textures_of
from asperity.scenes.compute import compute
from like_measured import either, wheel_lines, where_measured
from one_contact import first_contact

CASE = """
kind = "wheel-on-rail"
laws = ["areal", "linear"]
speed = "56 m/s"
duration = "{duration}"
settling = "50 ms"
[surface]
{surface}
[wheel]
{wheel}
[contact]
spacing = "1 mm"
samples = 2
sample_length = "60 mm"
[numerics]
highest_frequency = "4 kHz"
poles = 60
"""
LINE = 'line = "line.txt"\ncontinuation = "{}"'
LINES = 'line = "lines.npz"\nline_unit = "um"\nline_spacing = "1 mm"\n'


def case(folder, surface="smooth = true", wheel="", duration="40 ms"):
    return parse_case(CASE.format(surface=surface, wheel=wheel, duration=duration), folder / "case.toml")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    return tmp_path


def write_line(folder, length):
    z = turn(round(length / 1e-3))
    rows = "\n".join(f"{a}\t{b:.6f}" for a, b in enumerate(z))
    (folder / "line.txt").write_text("x [mm]\tz [um]\n" + rows + "\n")


def turn(points, seed=0):
    """Smooth noise in µm that closes on itself."""
    rng = np.random.default_rng(seed)
    kernel = np.hanning(25)
    noise = rng.standard_normal(points)
    return np.convolve(np.concatenate([noise, noise[:24]]), kernel, "valid")


class TestRail:
    def test_line_is_the_same_all_across(self, folder):
        write_line(folder, 6.0)
        found = textures_of(case(folder, LINE.format("refuse")))
        np.testing.assert_allclose(np.ptp(found.path.rows(0, found.path.shape[0]), axis=1), 0.0, atol=1e-15)
        assert np.std(found.line) == pytest.approx(1e-6 * np.std(turn(6000)), rel=0.1)
        assert "EN 15610" in found.origin
        assert "spikes kept" in found.origin

    def test_record_shorter_than_the_run_is_refused_by_default(self, folder):
        write_line(folder, 2.0)
        with pytest.raises(InputError, match="rail's record: received 2 m"):
            textures_of(case(folder, LINE.format("refuse")))

    @pytest.mark.parametrize("how", ["mirror", "repeat"])
    def test_record_goes_on_as_the_case_says(self, folder, how):
        write_line(folder, 2.0)
        found = textures_of(case(folder, LINE.format(how)))
        first = found.line[:2000]
        again = found.line[2000:3000] if how == "repeat" else found.line[1998:998:-1]
        expected = first[:1000] if how == "repeat" else found.line[2000:3000]
        np.testing.assert_allclose(again, expected, atol=1e-12)
        assert f"{how}ed" in found.origin

    def test_several_lines_need_their_distance(self, folder):
        np.savez(folder / "lines.npz", rail=np.stack([turn(6000, s) for s in range(3)]))
        with pytest.raises(InputError, match=r"surface\.line_distance: received no distance for 3 lines"):
            textures_of(case(folder, LINES))
        found = textures_of(case(folder, LINES + 'line_distance = "5 mm"'))
        assert np.ptp(found.path.rows(0, found.path.shape[0]), axis=1).max() > 0.0

    def test_wrong_unit_asks(self, folder):
        np.savez(folder / "lines.npz", rail=turn(6000)[None])
        surface = LINES.replace('"um"', '"m"')
        with pytest.raises(InputError, match="Is the unit right"):
            textures_of(case(folder, surface))
        assert textures_of(case(folder, surface + "accept_levels = true")).line.std() > 0.1

    def test_gaps_are_refused_unless_filled(self, folder):
        line = turn(6000)
        line[3000] = np.nan
        np.savez(folder / "lines.npz", rail=line[None])
        with pytest.raises(InputError, match="missing points inside"):
            textures_of(case(folder, LINES))
        found = textures_of(case(folder, LINES + 'processing = ["fill"]'))
        assert "1 points filled" in found.origin


class TestWheel:
    def test_turn_of_the_record_is_the_turn_of_the_wheel(self, folder):
        np.savez(folder / "lines.npz", wheel=turn(2870)[None])
        found = textures_of(case(folder, wheel=LINES, duration="80 ms"))
        wheel = found.parts["wheel"]
        np.testing.assert_array_equal(wheel[2870:], wheel[:-2870])
        assert found.line is not None

    def test_line_shorter_than_a_turn_is_refused(self, folder):
        np.savez(folder / "lines.npz", wheel=turn(2500)[None])
        with pytest.raises(InputError, match=r"wheel\.line: received 2\.5 m"):
            textures_of(case(folder, wheel=LINES))

    def test_short_lines_are_left_out(self, folder):
        lines = np.stack([turn(2890, s) for s in range(3)])
        lines[1, 2000:] = np.nan
        np.savez(folder / "lines.npz", wheel=lines)
        with pytest.warns(ShortRecordWarning, match="1 of 3 lines of the wheel"):
            textures_of(case(folder, wheel=LINES + 'line_distance = "5 mm"'))

    def test_lines_measured_to_and_fro_are_brought_into_register(self, folder):
        same = turn(2890)
        np.savez(folder / "lines.npz", wheel=np.stack([same, same[::-1], np.roll(same, 7)]))
        found = textures_of(case(folder, wheel=LINES + 'line_distance = "5 mm"'))
        assert "2 brought into register (1 turned round)" in found.origin
        inside = found.path.rows(0, found.path.shape[0])[:, 5:-5]
        np.testing.assert_allclose(np.ptp(inside, axis=1), 0.0, atol=1e-7)


@either
def test_flat_of_a_measured_wheel_is_found(folder, measured):
    np.savez(folder / "wheels.npz", flat=wheel_lines(0.6, measured=measured), other=np.zeros((10, 2880)))
    wheel = (
        'radius = "0.459 m"\nline = "wheels.npz"\nline_array = "flat"\nline_unit = "um"\n'
        'line_spacing = "1 mm"\nline_distance = "5 mm"\nprocessing = ["curvature"]'
    )
    found = run(case(folder, wheel=wheel, duration="0.11 s"))
    force = found["rolling/contact_force"].sel(law="areal", contact=1)
    assert float(force.max()) > 2 * 65e3
    struck = found["rolling/position"].values[force.values > 0.9 * float(force.max())]
    turns = np.round((struck - struck[0]) / (2 * np.pi * 0.459))
    np.testing.assert_allclose(struck - struck[0], turns * 2.88, atol=0.1)  # once a turn, at one place
    assert int(found["rolling/contact_loss_events"].sel(law="areal", contact=1)) >= 2
    assert "rolled over with a circle" in found["surface"].attrs["source"]
    assert json.loads(found.attrs["warnings"])


@pytest.mark.parametrize(
    ("measured", "speed"), [(False, 56), *(pytest.param(True, v, marks=where_measured) for v in (20, 80))]
)
def test_impact_of_a_measured_flat_is_that_of_the_receptances(folder, measured, speed):
    np.savez(folder / "wheels.npz", flat=wheel_lines(0.4, measured=measured))
    text = CASE.replace("56 m/s", f"{speed} m/s").replace('"areal", "linear"', '"linear"')
    text = text.replace("1 mm", "0.5 mm").replace("samples = 2", "samples = 1").format(
        surface="smooth = true", duration=f"{3.2 / speed:g} s",
        wheel='line = "wheels.npz"\nline_array = "flat"\nline_unit = "um"\nline_spacing = "1 mm"\n'
        'line_distance = "5 mm"\nprocessing = ["curvature"]',
    )  # fmt: skip
    prepared = prepare_case(parse_case(text, folder / "case.toml"))
    computed = compute(prepared, lambda done, total, message: None)
    chain = computed
    wheel = first_contact(chain.runs["linear"])
    # the middle lines are lowest at 0.267 m; the wheel strikes where it reaches the flat's far end
    struck = float(wheel.position[np.argmax(wheel.contact_force)])
    assert 0.267 < struck % 2.88 < 0.30
    at = chain.textures.start + chain.shape.spacing[0] * np.arange(len(chain.textures.followed))
    texture = np.interp(wheel.position, at, chain.textures.followed)
    mirrored = np.concatenate([texture, texture[::-1]])
    _, stiffness = working_point(computed.case.contact, chain.shape, chain.reduction)
    step = computed.case.time_step
    transfer = force_transfer(
        np.fft.rfftfreq(len(mirrored), step), computed.scene.first, computed.track, stiffness, [struck % 0.6]
    )
    still = 65e3 + np.fft.irfft(np.fft.rfft(mirrored) * transfer[0], len(mirrored))[: len(texture)]
    assert wheel.contact_force.max() == pytest.approx(still.max(), rel=0.1)
