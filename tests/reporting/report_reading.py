"""Reading a written report back, its page and its CSV files; results that lack something."""

import base64
import csv
import hashlib
import re
from html.parser import HTMLParser

import numpy as np
from xarray import DataTree

from asperity.reporting.payload import chart_script

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

    @property
    def shown(self):
        return "".join(self.text).replace("\u00a0", " ")


def computers_exponents(page):
    """Numbers on a page as a computer writes them, 3e-08; the keys of a case are as its file has them."""
    told = re.sub(r"(?s)<(script|style|pre|code)\b.*?</\1>|<div class=\"case\">.*?</div>", " ", page)
    return re.findall(r"(?<![\w.])\d[\d.]*e[-+−]?\d+\b", re.sub(r"<[^>]+>", " ", told))


def own_scripts(page):
    """Scripts of a page: its data and what its policy allows, no other; it loads nothing, and is whole."""
    reader = Reader(page)
    assert not reader.open
    assert not {"img", "link", "iframe", "object", "base"} & {tag for tag, _ in reader.tags}
    assert not reader.all("onerror")
    places = reader.all("src") + reader.all("href") + reader.all("xlink:href")
    names = reader.all("id")
    assert len(names) == len(set(names))
    for target in places + re.findall(r"url\(([^)]*)\)", page):
        assert re.fullmatch(r"[a-z_]+\.csv", target) or target.removeprefix("#") in names, target
    assert "@import" not in page
    scripts = [attrs for tag, attrs in reader.tags if tag == "script"]
    assert scripts[0] == {"type": "application/json", "id": "charts"}
    assert not any(scripts[1:])
    digests = [base64.b64encode(hashlib.sha256(s.encode()).digest()).decode() for s in reader.scripts[1:]]
    allowed = " ".join(f"'sha256-{digest}'" for digest in digests)
    (policy,) = [a["content"] for t, a in reader.tags if t == "meta" and "http-equiv" in a]
    assert "default-src 'none'" in policy
    assert f"script-src {allowed};" in policy
    assert reader.scripts[1] == chart_script()
    return reader.scripts


def read_csv(path):
    with path.open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    table = np.array([[float(field) if field else np.nan for field in row] for row in rows])
    return dict(zip(head, table.T, strict=True))


def without(tree, *variables):
    """The result without some variables, each by its group and name: copies of trees take twice as long."""
    held = {}
    for group, of in tree.children.items():
        names = [name for each, name in variables if each == group]
        held[f"/{group}"] = of.to_dataset(inherit=False).drop_vars(names)
    left = DataTree.from_dict(held)
    left.attrs = tree.attrs
    return left
