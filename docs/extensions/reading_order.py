"""Pages that run cells are dealt out evenly: pages beside each other are read by one process, one by one."""

from __future__ import annotations


def deal(app, env, names):
    """Put pages with cells at even distances among the others."""
    running = [name for name in names if "{code-cell}" in env.doc2path(name).read_text(encoding="utf-8")]
    others = [name for name in names if name not in running]
    place = {name: (n + 0.5) / len(pages) for pages in (running, others) for n, name in enumerate(pages)}
    names.sort(key=place.__getitem__)


def setup(app):
    """Tell Sphinx."""
    app.connect("env-before-read-docs", deal)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
