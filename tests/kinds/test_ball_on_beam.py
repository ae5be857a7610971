"""The whole chain on small cases: groups and names of the result, resuming, refusing."""

import json

import numpy as np
import pytest

from asperity.case.cases import parse_case
from asperity.errors import CoarseSamplingWarning, InputError
from asperity.laws.layout import force
from asperity.reporting.tables import homogeneity_table
from asperity.running import prepare_case, run
from asperity.scenarios.geometry import geometry_of
from asperity.scenarios.textures import textures_of
from asperity.scenes import compute as ball_on_beam

pytestmark = pytest.mark.usefixtures("cache_of_module")

CASE = """
kind = "ball-on-beam"
laws = {laws}
start = "0.45 m"
duration = "20 ms"
settling = "0 s"
[surface]
{surface}
[contact]
spacing = "20 um"
window = "0.66 mm"
samples = 2
sample_length = "1.4 mm"
{contact}
[ball]
load = "30 N"
[numerics]
highest_frequency = "2 kHz"
"""
ALL = [
    "areal", "shifted", "printed", "table", "direct", "hertz", "linear", "hertz-filtered", "linear-filtered",
]  # fmt: skip
SYNTHETIC = 'rms = "0.04 um"\nlongest = "0.4 mm"\nshortest = "60 um"'


def case(surface=SYNTHETIC, contact="", laws=ALL, source="case.toml", **replace):
    text = CASE.format(surface=surface, contact=contact, laws=json.dumps(laws))
    for old, new in replace.items():
        lines = [f"{old} = {new}" if line.startswith(f"{old} =") else line for line in text.splitlines()]
        text = "\n".join(lines)
    return parse_case(text, source)


@pytest.fixture(scope="module")
def tree():
    return run(case())


class TestTextures:
    def map_file(self, tmp_path, shape=(80, 80), pixel=10e-6, hole=False):
        rng = np.random.default_rng(0)
        z = np.cumsum(np.cumsum(rng.standard_normal((2, *shape)), 1), 2)
        z = 0.05 * (z - z.mean()) / z.std()
        if hole:
            z[0, 3, 4] = np.nan
        np.savez(tmp_path / "maps.npz", patch=z)
        return f'file = "maps.npz"\narray = "patch"\nheight_unit = "um"\npixel = "{pixel * 1e6} um"'

    def test_measured_maps_are_the_samples_and_the_path_is_like_them(self, tmp_path):
        surface = self.map_file(tmp_path, pixel=20e-6)
        found = run(case(surface, laws=["areal", "linear"], source=tmp_path / "case.toml"))
        assert "2 samples measured, maps.npz" in found["surface"].attrs["source"]
        assert "path synthesised in their likeness" in found["surface"].attrs["source"]
        assert found["contact"].attrs["samples"] == 2
        assert found["surface/psd_path"].dims == ("surface_wavenumber",)

    def test_long_map_is_the_path_itself(self, tmp_path):
        surface = self.map_file(tmp_path, (1100, 40), pixel=20e-6)
        found = run(case(surface, laws=["areal", "linear"], source=tmp_path / "case.toml"))
        assert "path cut from the first" in found["surface"].attrs["source"]
        assert "mirror image" not in found["surface"].attrs["source"]
        longer = case(surface, laws=["areal"], source=tmp_path / "case.toml", settling='"10 ms"')
        mirrored = textures_of(longer)
        path, lead = mirrored.path.rows(0, mirrored.path.shape[0]), mirrored.path.shape[0] - 1100
        assert lead > 400
        assert np.array_equal(path[:lead], path[2 * lead : lead : -1])
        assert "path cut from the first, its mirror image for the run-in" in mirrored.origin

    def test_measured_maps_are_tested_for_being_the_same_everywhere(self, tmp_path):
        rng = np.random.default_rng(5)
        texture = rng.normal(size=(5, 120, 120))
        even = self.homogeneity(tmp_path, texture)
        assert even["surface/homogeneity_p"].sizes == {"sample": 5}
        assert even["surface/tile_rms"].dims == ("sample", "tile_x", "tile_y")
        assert not self.inhomogeneous(even)
        assert homogeneity_table(even).rows[0][-1].text == "as far as chance tells"
        trend = self.homogeneity(tmp_path, texture * np.linspace(0.3, 1.7, 120)[:, None])
        np.testing.assert_allclose(trend["surface/homogeneity_p"], 1 / 40)
        assert "5 of 5 measured maps are not the same everywhere (p ≤ 0.05)" in self.inhomogeneous(trend)
        assert [row[-1].text for row in homogeneity_table(trend).rows] == ["no"] * 5
        assert {"Str", "Std"} <= {s["symbol"] for s in json.loads(trend["surface"].attrs["statistics"])}

    def homogeneity(self, tmp_path, maps):
        np.savez(tmp_path / "maps.npz", patch=0.02 * maps)
        surface = 'file = "maps.npz"\narray = "patch"\nheight_unit = "um"\npixel = "20 um"'
        return run(case(surface, laws=["linear"], source=tmp_path / "case.toml"))

    def inhomogeneous(self, tree):
        found = json.loads(tree.attrs["warnings"])
        return " ".join(w["message"] for w in found if w["category"] == "InhomogeneousWarning")

    def test_synthesised_samples_are_not_tested(self, tree):
        assert "homogeneity_p" not in tree["surface"]
        assert homogeneity_table(tree) is None

    def test_missing_points_are_refused_unless_filled(self, tmp_path):
        surface = self.map_file(tmp_path, pixel=20e-6, hole=True)
        with pytest.raises(InputError, match="Set fill = true"):
            run(case(surface, laws=["areal"], source=tmp_path / "case.toml"))
        filled = run(case(surface + "\nfill = true", laws=["areal"], source=tmp_path / "case.toml"))
        assert "MissingPointsWarning" in {w["category"] for w in json.loads(filled.attrs["warnings"])}

    def test_measured_maps_are_band_limited_on_request(self, tmp_path):
        surface = self.map_file(tmp_path, pixel=20e-6)
        bare = run(case(surface, laws=["linear"], source=tmp_path / "case.toml"))
        limited = run(case(surface + '\nlongest = "0.4 mm"', laws=["linear"], source=tmp_path / "case.toml"))
        rms = [float(found["surface/sample_heights"].std()) for found in (bare, limited)]
        assert rms[1] < 0.7 * rms[0]

    def test_a_map_is_rolled_over_in_the_direction_asked_for(self, tmp_path):
        """Grooves across the x axis: rough along it, smooth along the lay, in between with longer waves."""
        x = np.arange(240) * 10e-6
        noise = np.random.default_rng(0).normal(size=(240, 200))
        np.savez(tmp_path / "map.npz", patch=0.04 * np.cos(2 * np.pi * x / 200e-6)[:, None] + 1e-4 * noise)
        surface = 'file = "map.npz"\nheight_unit = "um"\npixel = "10 um"\n'

        def textures(direction):
            key = f'direction = "{direction}"'
            return prepare_case(case(surface + key, laws=["linear"], source=tmp_path / "case.toml")).textures

        bare, across, along, slanted = (textures(f"{angle} deg") for angle in (0, 180, 90, 60))
        turned = across.maps[0].heights[::-1, ::-1]
        np.testing.assert_allclose(turned, bare.maps[0].heights, atol=1e-15)
        np.testing.assert_allclose(np.rot90(along.maps[0].heights), bare.maps[0].heights, atol=1e-15)
        slopes = [np.std(np.diff(found.maps[0].heights, axis=0)) for found in (along, bare)]
        assert slopes[0] < 0.02 * slopes[1]
        spectrum = np.abs(np.fft.rfft(slanted.maps[0].heights[:, 20], 4096))
        longest = 4096 * 20e-6 / np.argmax(spectrum)
        assert longest == pytest.approx(200e-6 / np.cos(np.radians(60)), rel=0.03)
        assert slanted.maps[0].size == pytest.approx((1.15e-3, 1.99e-3), abs=20e-6)  # 2.4 mm × 2 mm, turned
        assert "rolled over at 60° to their x axis, on the largest rectangle inside: 1.1" in slanted.origin
        assert "rolled over" not in bare.origin

    def test_map_smaller_than_the_window_is_refused(self, tmp_path):
        surface = self.map_file(tmp_path, (24, 24), pixel=20e-6)
        with pytest.raises(
            InputError, match=r"contact\.window: received 660 um; allowed: at most the measured map, 480 um"
        ):
            run(case(surface, laws=["areal"], source=tmp_path / "case.toml"))

    def test_measured_line(self, tmp_path):
        x = np.arange(4000) * 10e-6
        z = 0.05 * np.sin(2 * np.pi * x / 0.7e-3)
        lines = "\n".join(f"{a * 1e3:.5f}\t{b:.6f}" for a, b in zip(x, z, strict=True))
        (tmp_path / "line.txt").write_text("x [mm]\tz [um]\n" + lines + "\n")
        surface = SYNTHETIC + '\nline = "line.txt"'
        found = run(case(surface, laws=["shifted", "linear"], source=tmp_path / "case.toml"))
        assert "path: measured, line.txt" in found["surface"].attrs["source"]
        peak = found["spectra/force_psd"].sel(law="linear").idxmax("frequency")
        assert float(peak) == pytest.approx(1.0 / 0.7e-3, abs=60)
        long = case(surface, laws=["linear"], source=tmp_path / "case.toml", duration='"50 ms"')
        with pytest.raises(InputError, match=r"surface\.line: received 0\.04 m; allowed: at least"):
            run(long)

    def test_spectrum_of_a_rail_as_the_path(self):
        surface = 'spectrum = "iso3095"\nlevel = "-10 dB"'
        found = run(case(surface, laws=["hertz", "linear", "linear-filtered"]))
        assert "path: iso3095, -10 dB" in found["surface"].attrs["source"]
        assert "filter" in found["contact"]


class TestLimits:
    def shape_of(self, **replace):
        small = case(laws=["areal"], **replace)
        return geometry_of(small)

    def test_contact_beyond_the_half_space(self):
        with pytest.raises(InputError, match="at most R/3"):
            self.shape_of(load='"5 MN"')

    @pytest.mark.parametrize("side", ["width", "height"])
    def test_a_beam_that_is_smaller_than_its_contact(self, side):
        half = (3 * 30.0 * 25e-3 / (4 * 210e9 / (2 * 0.91))) ** (1 / 3)
        self.shape_of(load=f'"30 N"\n[beam]\n{side} = "{2.01 * half} m"')
        with pytest.raises(InputError, match=rf"beam\.{side}: received 337 um; allowed: at least 339 um"):
            self.shape_of(load=f'"30 N"\n[beam]\n{side} = "{1.99 * half} m"')

    def test_approach_beyond_the_half_space(self):
        beyond = case(laws=["areal"], contact='approaches = ["0 um", "4 mm"]')
        with pytest.raises(InputError, match="an approach of 4e\\+03 µm"):
            geometry_of(beyond)

    def test_approaches_must_reach_the_load(self):
        shallow = case(laws=["areal"], contact='approaches = ["-0.1 um", "0.1 um", "0.3 um"]')
        with pytest.raises(InputError, match=r"contact\.approaches: received up to 0\.3 um"):
            run(shallow)

    def test_approaches_as_given_are_the_states(self):
        given = case(laws=["areal", "printed"], contact='approaches = ["-0.1 um", "0.4 um", "1 um", "2 um"]')
        np.testing.assert_allclose(run(given)["contact/approach"], [-1e-7, 4e-7, 1e-6, 2e-6])

    def test_window_must_hold_the_contact(self):
        with pytest.raises(InputError, match=r"contact\.window: received"):
            self.shape_of(load='"300 N"')

    def test_coarse_grid_warns(self):
        with pytest.warns(CoarseSamplingWarning, match="an eighth of the contact radius"):
            self.shape_of(load='"10 N"')


class TestRunIn:
    TEXT = """
    kind = "ball-on-beam"
    laws = ["hertz-filtered"]
    start = "0.45 m"
    duration = "15 ms"
    seed = {seed}
    {settling}
    [surface]
    rms = "0.06 um"
    shortest = "60 um"
    [ball]
    load = "20 N"
    [contact]
    spacing = "20 um"
    window = "0.66 mm"
    samples = 1
    """

    def thirds(self, settling=""):
        """Rms of the force in thirds of the record, over twelve paths."""
        runs = [run(parse_case(self.TEXT.format(seed=seed, settling=settling))) for seed in range(12)]
        force = np.concatenate([tree["rolling/contact_force"].values[0] for tree in runs]) - 20.0
        return [float(np.sqrt(np.mean(part**2))) for part in np.array_split(force, 3, axis=1)]

    def test_a_record_is_stationary(self):
        first, _, last = self.thirds()
        assert first == pytest.approx(last, rel=0.15)

    def test_without_a_run_in_it_is_not(self):
        """What the test above can see: the start from rest makes the first third quiet."""
        first, _, last = self.thirds('settling = "0 s"')
        assert first < 0.6 * last

    def test_a_record_that_holds_the_start_is_marked(self):
        found = run(parse_case(self.TEXT.format(seed=1, settling='settling = "10 ms"')))
        messages = [w["message"] for w in json.loads(found.attrs["warnings"])]
        assert any("the record starts 10 ms after rest, less than 50 ms" in m for m in messages)

    def test_thirds_of_the_record_are_told(self):
        found = run(parse_case(self.TEXT.format(seed=1, settling="")))
        told = {entry["name"]: entry["value"] for entry in json.loads(found["scenario"].attrs["numerics"])}
        force = found["rolling/contact_force"].values[0, 0]
        expected = ", ".join(f"{part.std():.3g}" for part in np.array_split(force, 3))
        name = "rms of the contact force in thirds of the record, hertz-filtered"
        assert told[name] == f"{expected} N"
        assert float(found["rolling/time"][-1]) == pytest.approx(0.015)
        assert float(found["rolling/position"][0]) == pytest.approx(0.45)

    def test_before_a_measured_line_lies_its_mirror_image(self, tmp_path):
        heights = np.random.default_rng(0).normal(0, 0.05, 2000)
        np.savetxt(tmp_path / "line.txt", np.c_[np.arange(2000) * 0.02, heights], header="x [mm]\tz [um]",
                   comments="", delimiter="\t")  # fmt: skip
        text = self.TEXT.format(seed=1, settling="").replace('rms = "0.06 um"', 'line = "line.txt"')
        text = text.replace('shortest = "60 um"', "")
        found = textures_of(parse_case(text, tmp_path / "case.toml"))
        lead = found.before - 33
        rows = len(found.line)
        assert (lead, rows) == (pytest.approx(2500, abs=1), pytest.approx(lead + 750 + 1 + 66, abs=1))
        assert np.array_equal(
            found.line[rows - 2000 - 40 : rows - 2000], found.line[rows - 2000 + 40 : rows - 2000 : -1]
        )
        # a window beyond the contact is looked at: where the first point of the file lies, and is said to lie
        first = found.start + lead * 20e-6
        assert first == pytest.approx(0.45 - 33 * 20e-6)
        assert "from 0.66 mm before the record on, its mirror image for the run-in" in found.origin
        assert found.start == pytest.approx(0.45 - found.before * 20e-6)


@pytest.mark.filterwarnings("ignore:the record starts 0 ms", "ignore:in .* contact solutions")
class TestLinear:
    def laws(self, linearise, laws=("linear-filtered", "linear"), surface=SYNTHETIC):
        small = case(surface, laws=list(laws), contact=f'linearise = "{linearise}"')
        return ball_on_beam.compute(prepare_case(small), lambda done, total, message: None)

    def test_the_filtered_linear_contact_is_linear(self):
        """The force grows with the approach by k alone, everywhere: the filter does not follow the state."""
        law = self.laws("hertz").laws["linear-filtered"]
        x = np.linspace(0.45, 0.46, 50)
        near, far = (force(law, x, approach) for approach in (law.approach, law.approach + 1e-6))
        np.testing.assert_allclose(far - near, law.stiffness * 1e-6, rtol=1e-9)
        assert np.ptp(near) > 0.0

    def test_secant_is_force_over_state(self):
        """k_c = F/r of Eq. 2.3, where r counts from the datum."""
        chain = self.laws("secant")
        ensemble, load = chain.reduction.ensemble, chain.shape.load
        approach = float(ensemble.curve.inverse(load))
        for law in chain.laws.values():
            assert law.stiffness == pytest.approx(load / (approach + ensemble.datum), rel=1e-12)
            assert law.approach == pytest.approx(approach)
        assert law.stiffness < 0.8 * float(ensemble.curve.stiffness(approach))

    def test_secant_of_smooth_bodies_is_two_thirds_of_the_tangent(self):
        line = 'spectrum = "iso3095"'
        secant, tangent = (self.laws(kind, surface=line).laws["linear"] for kind in ("secant", "hertz"))
        assert secant.stiffness == pytest.approx(2 / 3 * tangent.stiffness, rel=1e-9)
