"""Signals of a bearing are written at fewer samples than it was stepped with."""

import numpy as np
import pytest

from asperity.scenes.computed_bearing import thinned


def test_thinned_signals_hold_what_fewer_samples_hold_and_nothing_more():
    time = np.arange(80_000) / 400e3
    kept, lost = (np.sin(2.0 * np.pi * frequency * time) for frequency in (5e3, 36e3))
    inside = slice(100, -100)
    assert thinned(kept, 8)[inside] == pytest.approx(kept[::8][inside], abs=2e-3)
    assert np.abs(thinned(lost, 8)[inside]).max() < 2e-3  # it would be seen at 14 kHz
    assert thinned(kept, 1) is kept
