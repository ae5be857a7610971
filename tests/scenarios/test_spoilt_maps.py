"""A measured map with 5 % of its points missing and with spikes has the k_c of the clean one."""

from pathlib import Path

import numpy as np
import pytest

from asperity import HeightMap
from asperity.case.cases import as_case
from asperity.contact.scan import first_touch
from asperity.reduction.stiffness import stiffness_ensemble
from asperity.running import prepare_case
from asperity.scenarios.records import read_maps
from asperity.scenarios.reducing import samples_of
from asperity.surfaces.synthesis import self_affine

pytestmark = pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")  # of what is filled
DATA = Path(__file__).parents[3] / "shared" / "data"
LIGHTEST = 0.02  # least mean force of a state that counts, in working loads: below, few peaks carry it


def spoilt(surface, side, seed=3):
    """Remove 5 % of the points in squares of some points, and put spikes on 0.2 % of them."""
    rng, bad = np.random.default_rng(seed), np.array(surface.heights)
    at = rng.choice(bad.size, bad.size // 500, replace=False)
    bad.flat[at] += rng.choice([-1, 1], at.size) * rng.uniform(5, 20, at.size) * bad.std()
    missing = np.zeros(bad.shape, dtype=bool)
    while np.count_nonzero(missing) < 0.05 * missing.size:
        i, j = (rng.integers(0, n - side + 1) for n in bad.shape)
        missing[i : i + side, j : j + side] = True
    bad[missing] = np.nan
    return HeightMap(bad, surface.spacing, surface.source)


CONTACT = {"spacing": "4 um", "window": "0.4 mm", "samples": 3, "sample_length": "0.8 mm"}


def loaded(surface, approaches=None, load="10 N", lightest=LIGHTEST, contact=CONTACT, **keys):
    """Approaches, force F and k_c = F/r of the samples that a case takes from a map, in states with load."""
    case = {
        "kind": "ball-on-beam", "laws": ["shifted"], "duration": "1 ms", "start": "0.45 m",
        "settling": "1 ms", "surface": {"file": surface} | keys, "ball": {"load": load}, "contact": contact,
    }  # fmt: skip
    prepared = prepare_case(as_case(case))
    shape = prepared.shape
    samples = samples_of(prepared.case, shape, prepared.textures.maps, shape.semi_axes)
    half_space, chosen = shape.half_space(None), approaches is None
    touch = min(float(first_touch(s, shape.body).min()) for s in samples)
    if chosen:
        pressed = [half_space.solve(shape.body - s, load=shape.load) for s in samples]
        working = np.mean([contact.approach for contact in pressed])
        approaches = touch + (working - touch) * np.linspace(0.3, 1.4, 8)
    found = stiffness_ensemble(samples, half_space, shape.body, approaches, 0.0)
    kept = found.mean_force > (lightest * shape.load if chosen else 0.0)
    assert np.count_nonzero(kept) >= 5
    return approaches[kept], found.mean_force[kept], (found.mean_force / (approaches - touch))[kept]


@pytest.fixture(scope="module")
def clean():
    band = {"longest": 0.4e-3, "shortest": 16e-6}
    texture = self_affine((300, 300), (4e-6, 4e-6), rms=0.2e-6, hurst=0.8, seed=1, **band)
    return texture, *loaded(texture)


def test_points_that_dropped_out_are_mended_and_without_the_detector_spikes_carry_the_ball(clean):
    texture, approaches, force, stiffness = clean
    _, _, mended = loaded(spoilt(texture, 1), approaches, spikes=True, fill=True)
    np.testing.assert_allclose(mended, stiffness, rtol=0.02)
    # so much do they matter: filled points alone leave spikes on which the ball stands
    _, wrong, _ = loaded(spoilt(texture, 1), approaches, fill=True)
    assert np.abs(wrong / force - 1.0).max() > 0.1


def test_a_map_in_a_file_is_mended_as_one_in_memory(clean, tmp_path):
    bad = spoilt(clean[0], 1)
    np.save(tmp_path / "map.npy", bad.heights)
    keys = {
        "file": str(tmp_path / "map.npy"),
        "pixel": "4 um",
        "height_unit": "m",
        "spikes": True,
        "fill": True,
    }
    (found,) = read_maps(as_case({"kind": "ball-on-beam", "surface": keys}).surface)
    np.testing.assert_allclose(found.heights, bad.without_spikes().filled().heights, rtol=1e-12)


def test_holes(clean):
    """Holes may take the highest peak, from which r counts; the force at an approach hardly needs it."""
    texture, approaches, force, _ = clean
    _, mended, _ = loaded(spoilt(texture, 5), approaches, spikes=True, fill=True)
    np.testing.assert_allclose(mended[1:], force[1:], rtol=0.02)


@pytest.mark.parametrize(("name", "lightest"), [("polished", LIGHTEST), ("bb20", 0.05)])
def test_measured_map(name, lightest):
    """On bb20, whose peaks are the highest, k_c misses by 2.04 % at a fortieth of the load."""
    file = DATA / "aa5754_um.npz"
    if not file.exists():
        pytest.skip(
            "the measured maps of AA5754 are not here (docs/surfaces/real_surfaces.md: where they are from)"
        )
    surface = HeightMap(1e-6 * np.load(file)[name][0], 1.5625e-6)
    grid = {"spacing": "5 um", "window": "0.5 mm", "samples": 6, "sample_length": "1 mm"}
    keys = {"load": "20 N", "contact": grid, "shortest": "20 um"}
    approaches, _, clean = loaded(surface, lightest=lightest, spikes=True, fill=True, **keys)
    _, _, mended = loaded(spoilt(surface, 1), approaches, spikes=True, fill=True, **keys)
    np.testing.assert_allclose(mended, clean, rtol=0.02)
