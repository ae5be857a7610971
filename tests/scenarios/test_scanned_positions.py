"""How far apart positions of a scan lie."""

import math
from types import SimpleNamespace

import pytest

from asperity.case.rolled_over import TrackKeys
from asperity.scenarios.scanned_positions import edge_stride, table_stride


def prepared(half_axis, highest, defects=None, roughness=math.inf, over=None):
    """A path on cells of 0.1 mm, rolled at 10 m/s."""
    shape = SimpleNamespace(class_axes=(half_axis, 1.0), spacing=(1e-4, 1e-4))
    numerics = SimpleNamespace(highest_frequency=highest)
    case = SimpleNamespace(speed=10.0, numerics=numerics)
    return SimpleNamespace(
        shape=shape,
        case=case,
        textures=SimpleNamespace(defects=defects),
        roughness=roughness,
        scene=SimpleNamespace(over=over),
    )


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


def test_fewer_positions_do_on_a_track_where_the_texture_is_smooth():
    """On what rings they do not: there forces that are a little off stand out."""
    on_track = {"over": TrackKeys(name="x2000").model(5e3), "roughness": 0.01}
    assert table_stride(prepared(8e-3, 100.0, **on_track)) == 32
    assert table_stride(prepared(8e-3, 1.25e3, **on_track)) == 16
    assert table_stride(prepared(8e-3, 100.0, over=on_track["over"])) == 20
    assert table_stride(prepared(8e-3, 100.0, roughness=0.01)) == 20
    assert table_stride(prepared(8e-3, 100.0, [0.0], **on_track)) == 10
