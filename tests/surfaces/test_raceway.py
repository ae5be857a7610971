import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from surface_files import sdf_binary

from asperity.errors import InputError
from asperity.surfaces.faults import Fault, lay
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.raceway import AroundTexture, Raceway, raceway
from refusals import refusals

MM, UM = 1e-3, 1e-6
CELLS = (0.01 * MM, 0.02 * MM)
GRID = np.meshgrid(np.arange(-400, 401) * 2.5 * UM, np.arange(-400, 401) * 2.5 * UM, indexing="ij")


def made(texture, *faults, shape=(2000, 41), seed=1, followed=0.0):
    return raceway(texture, faults, shape, CELLS, seed=seed, followed=followed)


def trace(angle, height=lambda angle: UM * np.cos(3 * angle)):
    return np.column_stack([angle, height(angle)])


TURN = 2.0 * np.pi * np.arange(360) / 360


def test_waves_have_their_amplitudes_and_no_others():
    texture = AroundTexture(
        waves=(3, 40), amplitudes=(UM, 0.1 * UM), waviness=0.5 * UM, first_order=5, last_order=20, fall=1.5
    )
    wanted = np.zeros(1001)
    wanted[[3, 40]], wanted[5:21] = (UM, 0.1 * UM), 0.5 * UM * (np.arange(5, 21) / 5) ** -1.5
    found = made(texture)
    along = np.abs(np.fft.rfft(found.line + found.heights[:, 20])) / 1000
    assert_allclose(along, wanted, atol=1e-12 * UM)
    assert_array_equal(made(texture, seed=2).line == found.line, False)  # other phases


def test_long_waves_are_followed_and_short_ones_are_heights():
    texture = AroundTexture(waves=(10, 50), amplitudes=(UM, UM))
    found = made(texture, followed=0.5 * MM)  # 20 mm around: 40 waves
    assert_allclose(np.abs(np.fft.rfft(found.line))[[10, 50]] / 1000, [UM, 0.0], atol=1e-12 * UM)
    assert_allclose(np.abs(np.fft.rfft(found.heights[:, 7]))[[10, 50]] / 1000, [0.0, UM], atol=1e-12 * UM)
    assert not made(AroundTexture(waves=(10,), amplitudes=(UM,)), followed=0.5 * MM).heights.any()


def test_roughness_has_its_rms_and_no_seam():
    texture = AroundTexture(roughness=0.1 * UM, longest=0.4 * MM, shortest=0.06 * MM)
    heights = np.array([made(texture, seed=seed).heights for seed in range(30)])
    assert_allclose(np.sqrt(np.mean(heights**2)), 0.1 * UM, rtol=0.05)
    steps = np.sqrt(np.mean((np.roll(heights, -1, axis=1) - heights) ** 2, axis=(0, 2)))
    assert_allclose(steps[-1], steps.mean(), rtol=0.15)
    assert steps.max() < 1.2 * steps.mean()


@pytest.mark.parametrize("again", [False, True], ids=["one step less", "to where it began"])
def test_trace_keeps_its_waves_but_mean_and_centring(again):
    angle = np.append(TURN, 2 * np.pi) if again else TURN
    measured = trace(angle, lambda a: UM * (5.0 + 2.0 * np.cos(a) + np.cos(3 * a - 0.4)))
    found = made(AroundTexture(trace=measured), followed=0.01 * MM)
    place = 2.0 * np.pi * np.arange(2000) / 2000
    assert_allclose(found.line, UM * np.cos(3 * place - 0.4), atol=1e-5 * UM)


def test_likeness_of_a_measured_map_is_closed():
    heights = np.random.default_rng(1).normal(size=(128, 128)) * 0.05 * UM
    smooth = sum(np.roll(heights, (i, j), (0, 1)) for i in range(3) for j in range(3)) / 3.0
    found = made(AroundTexture(map=HeightMap(smooth, CELLS)), shape=(500, 31)).heights
    assert_allclose(found.std(), smooth.std(), rtol=0.15)
    assert np.abs(found[0] - found[-1]).max() < 1.2 * np.abs(np.diff(found, axis=0)).max()


def test_volumes_the_share_of_a_rim_and_the_slope_of_an_edge():
    volumes = {"pit": -np.pi, "spall": -4.0, "mark": -np.pi / 2, "particle": np.pi / 3, "dent": 0.0}
    for shape, volume in volumes.items():
        fault = Fault(shape, length=0.6 * MM, width=0.4 * MM, depth=UM)
        found = fault.heights(*GRID).sum() * (2.5 * UM) ** 2 / (0.3 * MM * 0.2 * MM * UM)
        assert_allclose(found, volume, rtol=0.01, atol=1e-3)
    half, none = (Fault("dent", length=0.4 * MM, depth=UM, rim=share).heights(*GRID) for share in (0.5, 0.0))
    assert_allclose(half.sum(), 0.5 * none.sum(), rtol=2e-3)
    assert half.max() > 0.0
    assert none.max() == 0.0
    assert half.min() == none.min() == -UM
    for shape in ("pit", "spall"):
        fault = Fault(shape, length=0.4 * MM, depth=UM, edge=0.1 * MM)
        assert_allclose(fault.heights([0.0, 0.15 * MM, 0.2 * MM], 0.0), [-UM, -0.5 * UM, 0.0], atol=1e-12)


def test_the_burr_of_a_hollow_has_its_height_and_volume_and_ends_with_its_size():
    """Closed forms of h sin²(πs/w) around a circle, π h w (R + w/2), and a rectangle, h w (L + B + 2w)."""
    length, width, high, wide = 0.6 * MM, 0.4 * MM, 0.5 * UM, 0.1 * MM
    around = {
        "pit": np.pi * high * wide * (0.5 * length + 0.5 * wide),
        "spall": high * wide * (length + width + 2 * wide),
    }
    for shape, volume in around.items():
        of = Fault(
            shape,
            length=length,
            width=None if shape == "pit" else width,
            depth=UM,
            burr=high,
            burr_width=wide,
        )
        found = of.heights(*GRID)
        assert_allclose(np.maximum(found, 0.0).sum() * (2.5 * UM) ** 2, volume, rtol=1e-3)
        assert found.max() == pytest.approx(high, rel=1e-9)
        assert_allclose([np.ptp(each[found != 0.0]) for each in GRID], of.size, atol=5.1 * UM)


def test_faults_lie_where_they_are_told_across_the_seam_and_all_around():
    one = Fault("mark", length=0.2 * MM, width=0.4 * MM, depth=UM, offset=0.1 * MM)
    found, edges = lay((one,), (2000, 41), CELLS)
    assert edges is None
    assert found[0, 25] == found.min() == -UM
    assert_allclose(found[-5, 25], found[5, 25], rtol=1e-12)
    assert_array_equal(np.flatnonzero(found.any(axis=1)), [*range(10), *range(1991, 2000)])
    four, _ = lay((Fault("mark", length=0.2 * MM, depth=UM, angle=0.5 * np.pi, count=4),), (2000, 41), CELLS)
    assert_allclose(np.roll(four, 500, axis=0), four, atol=1e-12 * UM)
    assert four[500, 20] == -UM
    assert four[250].any() is np.False_


def test_edges_of_faults_leave_the_area_that_is_sound():
    """Counted by shares of cells, wherever the fault lies; heights are those of the sound surface."""
    for shape, area in (("pit", np.pi / 4), ("spall", 1.0)):
        for angle, offset in ((0.0, 0.0), (1.0, 0.007 * MM)):
            fault = Fault(shape, length=0.23 * MM, width=0.31 * MM, depth=UM, angle=angle, offset=offset)
            heights, edges = lay((fault,), (2000, 41), CELLS)
            lost = (1.0 - edges.shares).sum() * CELLS[0] * CELLS[1] / (0.23 * MM * 0.31 * MM)
            assert lost == pytest.approx(area, rel=4e-3)
            assert_array_equal(heights[edges.sound], 0.0)
            assert_array_equal(heights[edges.distance < -0.02 * MM], -UM)
            crossed = np.abs(edges.places) < 0.45
            off = np.abs(edges.drop[crossed] - UM * (1.0 - edges.shares[crossed])) > 0.12 * UM
            assert off.sum() <= 4  # at the corners of a spall


def test_of_two_pits_each_cell_has_the_next_edge():
    one, other = (Fault("pit", angle=a, length=0.2 * MM, depth=UM) for a in (1.0, 1.07))
    (_, left), (_, right), (_, both) = (
        lay(each, (2000, 41), CELLS) for each in ((one,), (other,), (one, other))
    )
    assert_allclose(both.distance, np.minimum(left.distance, right.distance))
    met = left.with_others(right)
    assert_allclose(met.distance, both.distance)
    assert_allclose(met.drop, left.drop + right.drop)


def test_map_of_a_fault_lies_about_its_middle():
    x, y = (np.arange(9) - 4.0)[:, None], np.arange(7) - 3.0
    fault = Fault("map", map=HeightMap(UM * (x - 2 * y + 1), (0.02 * MM, 0.01 * MM)))
    assert fault.size == pytest.approx((0.18 * MM, 0.07 * MM), rel=1e-9, abs=0.0)
    assert fault.depth == pytest.approx(9 * UM, rel=1e-9, abs=0.0)
    found = fault.heights([0.0, 0.01 * MM, 1 * MM], 0.005 * MM)
    assert_allclose(found, UM * np.array([0, 0.5, 0]), atol=1e-12)


def test_maps_come_from_files(tmp_path):
    (tmp_path / "hole.sdf").write_bytes(sdf_binary(np.full((5, 7), -100.0), 7))  # nm
    fault = Fault("map", map=tmp_path / "hole.sdf")
    assert fault.size == pytest.approx((7 * 2 * UM, 5 * 3 * UM), rel=1e-9, abs=0.0)
    assert fault.heights([0.0], 0.0)[0] == pytest.approx(-0.1 * UM, rel=1e-9, abs=0.0)
    (tmp_path / "line.csv").write_text("x (mm), z (um)\n" + "".join(f"{i}, {i % 3}\n" for i in range(9)))
    with pytest.raises(InputError, match=r"map: received a line; .* as a trace"):
        made(AroundTexture(map=tmp_path / "line.csv"))


def pit(length, **where):
    return lambda: made(AroundTexture(), Fault("pit", length=length, depth=UM, **where))


test_what_is_wrong_is_said = refusals(
    (pit(MM, offset=2 * MM), "less than 0.91 mm"),
    (pit(3 * MM, count=9), "a circumference of 20"),
    (lambda: Fault("pit", length=MM), "depth of a fault, a pit: received nothing"),
    (lambda: Fault("map"), "map of a fault, a map: received nothing"),
    (lambda: Fault("hole", length=MM, depth=UM), 'shape of the fault: received .hole.; allowed: "pit"'),
    (pit(-MM), "length of the fault"),
    (
        lambda: Fault("dent", length=MM, depth=UM, burr=UM),
        "burr of a fault, a dent: .* only a pit or a spall",
    ),
    (lambda: AroundTexture(waves=(3, 4), amplitudes=(UM,)), "2 waves and 1 amplitude"),
    (lambda: AroundTexture(waves=(0,), amplitudes=(UM,)), r"waves of the around texture"),
    (lambda: AroundTexture(first_order=9, last_order=3), "9 to 3"),
    (lambda: AroundTexture(roughness=UM, map=HeightMap(np.eye(9), CELLS)), "a number and a map"),
    (lambda: AroundTexture(trace=trace(TURN, lambda a: UM * a)), "ends that differ by 6.27 um; .* drifted"),
    (lambda: AroundTexture(trace=trace(TURN[:300])), "received 299 deg"),
    (lambda: AroundTexture(trace=trace(TURN[::-1])), "falling angles"),
    (lambda: AroundTexture(trace=trace(TURN, lambda a: a * np.nan)), "finite angles"),
    (lambda: made(AroundTexture(waves=(1000,), amplitudes=(UM,))), "at most 999"),
    (lambda: made(AroundTexture(), shape=(2**20, 101)), "at most 67108864 points"),
    (lambda: Raceway(np.zeros((20, 4)), CELLS), "odd number of lines"),
    (lambda: Raceway(np.zeros((20, 5)), CELLS, np.zeros(19)), "line of the raceway"),
)
