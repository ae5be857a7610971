"""What all tests share."""

import os
from pathlib import Path

# Kernels are compiled once, whichever cache a test uses. Set before they are imported.
os.environ.setdefault("ASPERITY_KERNELS", str(Path(__file__).parents[1] / ".pytest_cache" / "kernels"))
