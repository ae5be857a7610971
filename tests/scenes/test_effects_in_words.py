"""What named changes do, in words: a reason of several keys is told once, and nothing is ranked by chance."""

import numpy as np
import pytest
import xarray

from asperity.scenes.figures.effects import Effects, effects_table, said_once


def effects_of(effect, error, seeds=3):
    """Effects of changes a, b, … on a total alone."""
    both = {name: (("variant",), each) for name, each in (("effect", effect), ("effect_error", error))}
    level = ((), 80.0, {"long_name": "level", "units": "dB(A) re 1 pW"})
    held = {"level": level, "left_out": ("variant", [""] * len(effect)), **both}
    return Effects(
        xarray.Dataset(held, {"variant": list("abc")[: len(effect)]}, {"law": "areal", "seeds": seeds})
    )


@pytest.mark.parametrize(
    ("effect", "error", "told"),
    [
        ([-3.4, -2.8, -1.0], [0.3, 0.9, 0.3], "a, −3.4 dB(A); as much but for chance: b, −2.8. "),
        ([-3.4, -2.8, -1.0], [0.3, 0.3, 0.3], "a, −3.4 dB(A). "),
        ([-3.4, -2.8, -2.6], [0.9, 0.9, 0.1], "a, −3.4 dB(A); as much but for chance: b, −2.8; c, −2.6. "),
        ([-3.4, -2.8, -2.6], [9.0, 9.0, 0.1], ""),
        (
            [-3.4, -0.5, -0.4],
            [3.0, 0.9, 0.1],
            "a, −3.4 dB(A); as much but for chance: c, −0.4. ",
        ),  # b: not surely
        ([-3.4, -2.8, np.nan], [np.nan, np.nan, np.nan], "a, −3.4 dB(A). "),  # of one seed
    ],
)
def test_what_helps_most_is_not_told_apart_by_chance(effect, error, told):
    """Two differences within the root of the sum of the squares of their errors."""
    assert effects_of(effect, error).best.startswith(f"Helps most: {told}" if told else "")
    assert bool(effects_of(effect, error).best) == bool(told)


@pytest.mark.parametrize(("seeds", "name"), [(3, "as it is, mean of 3 seeds"), (1, "as it is")])
def test_the_level_of_several_seeds_is_not_that_of_the_run(seeds, name):
    table = effects_table(effects_of([-1.0], [0.1], seeds))
    assert [row[0].text for row in table.rows] == [name, "a"]


def test_a_reason_is_told_once_in_a_cell():
    twice = "the case has no wheel.added_damping, which goes with section"
    assert said_once(f"{twice}; {twice}.") == twice
    assert said_once("wheel.roughness is disc, not cast-iron. ") == "wheel.roughness is disc, not cast-iron"
    assert said_once(f"case: 2 errors\n  - {twice}\n  - {twice}") == f"case: 2 errors; {twice}"
