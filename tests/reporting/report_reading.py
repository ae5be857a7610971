"""Reading a written report back, its page and its CSV files; results that lack something."""

from __future__ import annotations

import csv
from html.parser import HTMLParser

import numpy as np

HOSTILE = '"><script>alert(1)</script><img src=x onerror=alert(2)> & {{ 7*7 }} $\\frac$'


class Reader(HTMLParser):
    """Collects tags with their attributes, text and scripts, and checks that tags are closed in order."""

    VOID = frozenset({"meta", "br", "img", "link", "input", "hr"})

    def __init__(self, text):
        super().__init__()
        self.tags, self.text, self.scripts, self.open = [], [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] == ["script"]:
            self.scripts.append(data)
        elif self.open[-1:] != ["style"]:
            self.text.append(data)

    def all(self, name):
        return [attrs[name] for _, attrs in self.tags if name in attrs]


def read_csv(path):
    with path.open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    table = np.array([[float(field) if field else np.nan for field in row] for row in rows])
    return dict(zip(head, table.T, strict=True))


def without(tree, group, *names):
    """The result without some variables of a group."""
    tree = tree.copy()
    tree[group] = tree[group].to_dataset().drop_vars(names)
    return tree
