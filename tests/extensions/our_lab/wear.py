"""How deep a record wears what is rolled over: by J. F. Archard, at a small share of sliding.

A contact that rolls under a force F and slides by a share s of its way removes k s F per metre, from a track
as wide as the smooth contact, 2 b. A raceway is passed again and again, anything else once.
"""

import numpy as np

from asperity.errors import Finding, Grade
from asperity.scenes.observer import Observer
from asperity.schema import Entry

GROUP = "wear"
LAW = Entry(GROUP, "law", "1", "contact law")
CONTACT = Entry(
    GROUP, "contact", "1", "number of the contact; of a bearing balls on the inner ring, then outer"
)
DEPTH = Entry(GROUP, "depth(law, contact)", "m", "mean depth of wear along the track of a contact")
WEAR, SLIDING = 1e-15, 0.005  # volume by work, m³/(N m), of mild wear; share of the way that slides
DEEPEST = 1e-9  # m


def half_widths_and_passes(computed):
    """Half the width of the track of each contact, m, and how often the record passes a place of it."""
    if "bearing" not in computed.quantities:
        return computed.shape.semi_axes[1], 1.0
    balls, turning = computed.bearing.balls, computed.case.kinematics
    time = next(iter(computed.runs.values())).time
    duration = time[1] * len(time)
    passes = [abs(turning.cage - ring) * duration for ring in (turning.inner, turning.outer)]
    widths = [smooth.semi_axes(smooth.approach(load))[1] for smooth, load in computed.case.contacts]
    return np.repeat(widths, balls), np.repeat(passes, balls)


def observe(computed):
    """Depths of each law and contact."""
    force = computed.stacked("contact_force")
    half_width, passes = half_widths_and_passes(computed)
    depth = WEAR * SLIDING * force.mean(axis=-1) * passes / (2.0 * half_width)
    return {LAW: list(computed.runs), CONTACT: 1 + np.arange(force.shape[1]), DEPTH: depth}


def findings(computed):
    """A profile that wears deeper than this within the record is not the one that was rolled over."""
    depth = observe(computed)[DEPTH].max()
    worn = Grade.WARNING if depth > DEEPEST else None
    words = "The record is that of unworn surfaces.", "Shorten the record, or wear the surfaces first."
    return [Finding("depth of wear, at most", f"{depth:.1e} m", f"up to {DEEPEST:g} m", worn, *words)]


OBSERVER = Observer(
    GROUP,
    (LAW, CONTACT, DEPTH),
    observe,
    needs=["contact_force"],
    findings=findings,
    sources=["J. F. Archard, J. Appl. Phys. 24 (1953) 981 (wear)."],
)
