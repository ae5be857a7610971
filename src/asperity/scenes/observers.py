"""What is looked at in runs of this program, one file each, in the order in which results lay it out."""

from asperity.scenes import (
    along_rollers,
    bearing_at_rest,
    bearing_creepage,
    bearing_film,
    bearing_heard,
    bearing_levels,
    bearing_parts,
    bearing_wear,
    creep,
    rib_friction,
    roundness,
    run_up,
    sideways,
    track,
)

OVER_STRUCTURES = (
    roundness.OBSERVER,
    track.TRACK,
    track.RAIL,
    track.PASS_BY,
    sideways.OBSERVER,
    creep.OBSERVER,
)
"""Of bodies that roll over structures."""
OF_BEARINGS = (
    bearing_heard.OBSERVER,
    bearing_at_rest.OBSERVER,
    along_rollers.OBSERVER,
    bearing_levels.OBSERVER,
    bearing_film.OBSERVER,
    bearing_creepage.OBSERVER,
    creep.OF_BALLS,
    rib_friction.OBSERVER,
    bearing_wear.OBSERVER,
    run_up.OBSERVER,
    bearing_parts.OBSERVER,
)
"""Of bearings."""
