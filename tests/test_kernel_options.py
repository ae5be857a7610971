"""Kept kernels: none outlives a change of any kernel's source."""

import importlib.util
import pkgutil

import asperity.kernels
from asperity.kernels import options

MODULE = """
from asperity.kernels.options import LOOP, compiled

@compiled(**LOOP)
def twice(x):
    return 2.0 * x
"""


def fresh(path):
    """Kernel of a module that is imported anew, called once."""
    spec = importlib.util.spec_from_file_location("kept_kernel", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.twice(2.0) == 4.0
    return module.twice.stats


def test_a_kept_kernel_is_dropped_when_another_source_changes(tmp_path, monkeypatch):
    path = tmp_path / "kept_kernel.py"
    path.write_text(MODULE)
    assert sum(fresh(path).cache_misses.values()) == 1
    assert sum(fresh(path).cache_hits.values()) == 1
    monkeypatch.setattr(options, "SOURCES", b"of another version")
    changed = fresh(path)
    assert sum(changed.cache_hits.values()) == 0
    assert sum(changed.cache_misses.values()) == 1


def test_all_kernels_that_are_kept_are_stamped_by_all_sources():
    kept = 0
    for found in pkgutil.iter_modules(asperity.kernels.__path__):
        module = importlib.import_module(f"asperity.kernels.{found.name}")
        for kernel in vars(module).values():
            file = getattr(getattr(kernel, "_cache", None), "_cache_file", None)
            if file is not None:
                kept += 1
                assert file._source_stamp == options.SOURCES
    assert kept > 20
