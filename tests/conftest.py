"""Fixtures and guards for all tests."""

from pathlib import Path

import asperity.kernels


def pytest_sessionstart():
    """Drop compiled kernels older than any kernel's source: numba looks at the caller's own file alone."""
    folder = Path(asperity.kernels.__file__).parent
    newest = max(source.stat().st_mtime for source in folder.glob("*.py"))
    for compiled in (folder / "__pycache__").glob("*.nb?"):
        if compiled.stat().st_mtime < newest:
            compiled.unlink(missing_ok=True)
