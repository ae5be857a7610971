"""What named changes do, in words: a reason of several keys is told once."""

from asperity.scenes.figures.effects import said_once


def test_a_reason_is_told_once_in_a_cell():
    twice = "the case has no wheel.added_damping, which goes with section"
    assert said_once(f"{twice}; {twice}.") == twice
    assert said_once("wheel.roughness is disc, not cast-iron. ") == "wheel.roughness is disc, not cast-iron"
    assert said_once(f"case: 2 errors\n  - {twice}\n  - {twice}") == f"case: 2 errors; {twice}"
