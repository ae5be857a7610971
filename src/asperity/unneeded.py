"""What other libraries import to see whether it is in use, which it is not."""

from __future__ import annotations

import sys


def spare_pint() -> None:
    """Let xarray find that no array here is one of pint, without a tenth of a second for importing it.

    For processes of this program alone: xarray asks once.
    """
    import xarray

    if "pint" in sys.modules:
        return
    missing: dict[str, None] = {"pint": None}  # as the import system writes what cannot be imported
    sys.modules.update(missing)  # type: ignore[arg-type]
    try:
        xarray.Dataset(coords={"x": [0.0]})
    finally:
        del sys.modules["pint"]
