"""What reports are made of: a real small run, with laws, forces and facts of a test's choosing."""

import json
from functools import cache

import numpy as np
import xarray as xr

import asperity
from asperity.laws import spec_of
from asperity.scenes.report import CHAPTERS
from asperity.schema import VERSION, spectra
from small_cases import BALL, changed

LAWS = BALL["laws"]
REFERENCE = spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE.name


PARTS = {figure.name: figure for chapter in CHAPTERS for figure in chapter.figures}
"""All figures that a result may have, by name."""


def dumped(keys, *rows):
    return json.dumps([dict(zip(keys, row, strict=True)) for row in rows])


ROOT = {
    "title": "Steel ball on a steel beam",
    "asperity_version": "0.1.0",
    "schema_version": VERSION,
    "created": "2026-01-02T03:04:05+00:00",
    "case": 'kind = "ball-on-beam"\nspeed = "1 m/s"\n\n[ball]\nradius = "25 mm"\nmaterial = "steel"\n',
    "seed": 1,
    "citations": json.dumps(["O. Lundberg, licentiate thesis, 2014.", "A. E. H. Love, Phil. Trans., 1929."]),
    "verdict": "The ball keeps contact for 97.9 % of the time; areal lies within 1.3 dB of table.",
    "warnings": dumped(
        ("category", "message", "count"),
        ("ExtrapolationWarning", "Approach 3.2 µm left the computed range. Add a larger approach.", 12),
        ("ShortRecordWarning", "1 s holds 63 periods of the lowest band. Roll longer.", 1),
    ),
}


@cache
def rolled():
    """A ball with one contact, whose record is long enough for all of its bands."""
    tree = xr.DataTree.from_dict(asperity.run(changed("ball-on-beam")).to_dict())
    for group in ("rolling", "spectra"):
        held = tree[group].to_dataset().drop_vars(["offset", "static_load"], errors="ignore")
        tree[group] = held.squeeze("contact", drop=True).drop_dims("degree")
    tree["spectra"] = tree["spectra"].to_dataset().drop_vars("start_share")
    tree["spectra/band_time_product"].values[:] = 0.23 * tree["spectra/band"]
    tree.attrs, tree["contact"].attrs["validity"] = ROOT, "[]"
    return tree


def of_laws(tree, *laws):
    """A result of these laws, which have the numbers of others where the run was without them."""
    there = tree["rolling/law"].values.tolist()
    taken = [law if law in there else there[n] for n, law in enumerate(laws)]
    for group in ("rolling", "spectra"):
        tree[group] = tree[group].to_dataset().sel(law=taken).assign_coords(law=list(laws))
    if "table" not in laws:
        tree["spectra"] = tree["spectra"].to_dataset().drop_vars(REFERENCE, errors="ignore")
    known = [law for law in laws if law.replace("-", "").isalpha()]
    tree["scenario"].attrs["laws"] = json.dumps([spec_of(law).entry() for law in known])
    return tree


def report_tree(laws=LAWS):
    """The result of a run, to be changed at will."""
    return of_laws(rolled().copy(deep=True), *laws)


def with_force(*series):
    """Tree whose laws, the first of them the main one, have these forces."""
    tree = report_tree(["areal", "shifted", "linear"][: len(series)])
    force, share = np.array(series), [float((each <= 0).mean()) for each in series]
    held = tree["rolling"].to_dataset().isel(time=slice(force.shape[1]))
    tree["rolling"] = held.assign(contact_force=(("law", "time"), force), contact_loss_share=("law", share))
    return tree


def uncertain(share, laws=("areal", "table", "linear-filtered", "linear")):
    """Tree in which B T reaches ten after a share of the bands."""
    tree = report_tree(laws)
    bands = tree["spectra"].sizes["band"]
    product = 10.0 * 10 ** ((np.arange(bands) - share * bands) / 10)
    tree["spectra"]["band_time_product"].values[:] = product
    return tree, product < 10.0


def laws_in(chart):
    """Laws that can be shown or not."""
    found = {getattr(mark, "law", "") for panel in chart.panels for mark in panel.marks}
    return found - {""}
