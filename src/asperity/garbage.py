"""Unused objects are sought seldom in processes of this program: imports make many, and few are unused."""

import gc

SOUGHT_AFTER = 1_000_000
"""New objects until unused ones are sought."""


def seek_seldom() -> None:
    """Let this process seek unused objects seldom: before its imports, of whose time that is a fifth."""
    gc.set_threshold(SOUGHT_AFTER)
