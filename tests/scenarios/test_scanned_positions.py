"""How far apart positions of a scan lie."""

from types import SimpleNamespace

import pytest

from asperity.scenarios.scanned_positions import edge_stride, table_stride


def prepared(half_axis, highest, defects=None):
    """A path on cells of 0.1 mm, rolled at 10 m/s."""
    shape = SimpleNamespace(class_axes=(half_axis, 1.0), spacing=(1e-4, 1e-4))
    numerics = SimpleNamespace(highest_frequency=highest)
    case = SimpleNamespace(speed=10.0, numerics=numerics)
    return SimpleNamespace(shape=shape, case=case, textures=SimpleNamespace(defects=defects))


@pytest.mark.parametrize(
    ("half_axis", "highest", "defects", "stride"),
    [
        (8e-3, 1e3, None, 20),  # a quarter of the patch
        (8e-3, 1.25e3, None, 16),  # a fifth of a wave of 8 mm
        (8e-3, 1e4, None, 10),  # an eighth of the patch, however short waves are
        (8e-3, 1e3, [0.0], 10),  # as edges ask for
        (1e-4, 1e3, None, 1),
    ],
)
def test_positions_are_as_far_apart_as_patch_and_waves_let_them_be(half_axis, highest, defects, stride):
    case = prepared(half_axis, highest, defects)
    assert table_stride(case) == stride
    assert edge_stride(case.shape) == max(1, round(half_axis / 8e-4))
