"""Pages that run cells are dealt out evenly: pages beside each other are read by one process, one by one."""

from __future__ import annotations

from itertools import accumulate


def deal(app, env, names):
    """Put pages with cells among the others so that equal parts of all pages have about as many cells."""
    cells = {name: env.doc2path(name).read_text(encoding="utf-8").count("{code-cell}") for name in names}
    others = [name for name in names if not cells[name]]
    place = {name: (n + 0.5) / len(others) for n, name in enumerate(others)}
    total = sum(cells.values())
    for name, end in zip(names, accumulate(cells.values()), strict=True):
        if cells[name]:
            place[name] = (end - 0.5 * cells[name]) / total
    names.sort(key=place.__getitem__)


def setup(app):
    """Tell Sphinx."""
    app.connect("env-before-read-docs", deal)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
