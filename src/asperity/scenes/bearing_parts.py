"""Which part of a bearing makes its vibration: velocities with what is on each part alone, and on none."""

import numpy as np

from asperity.arguments import Array
from asperity.diagnostics import band_deviations, band_velocities
from asperity.scenes.computed_bearing import BY_PARTS, ComputedBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values, bearing


def parts_group(computed: ComputedBearing) -> Values:
    """Lay out velocities with what is on each part alone, and on none, by `BY_PARTS`."""
    rate = computed.case.sampling_rate
    velocities = list[Array]()
    by_chance = list[Array]()
    for signal, *_ in computed.alone.values():
        velocities.append(band_velocities(signal, rate, quantity="acceleration"))
        by_chance.append(band_deviations(signal, rate))
    return {
        bearing.SOURCE: list(computed.alone),
        bearing.ALONE_VELOCITY: bearing.ALONE_VELOCITY.variable(np.array(velocities), law=BY_PARTS),
        bearing.ALONE_DEVIATION: by_chance,
    }


OBSERVER = Observer(
    "bearing_parts",
    DECLARED,
    parts_group,
    needs=("bearing",),
    asked_of=lambda computed: bool(computed.alone),
)
