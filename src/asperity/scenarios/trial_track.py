"""Short moving kernels of a track, computed and timed, so that its whole kernels can be expected."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from asperity.progress import Progress
from asperity.scenarios.trial import timed
from asperity.structures.moving_kernel import SHORTEST, STARTS, moving_kernel
from asperity.structures.track import Track

POLE_TIME = 6e-3
"""Time of fitting a pole, s."""
SHORT_KERNEL, FEW = 0.03, (4, 12)
"""Length, s, and start positions of the moving kernels that are tried."""


@dataclass(frozen=True, eq=False)
class TrackTrial:
    """Times of what the rail adds, on one core, s."""

    length: float  # of the moving kernel, s
    kernel: float  # the moving kernel, with the shorter ones before it
    last: float = 0.0  # the longest of them alone, as for each distance of two contacts


def try_track(track: Track, speed: float, step: float, progress: Progress) -> TrackTrial:
    """Compute short moving kernels of a track at a speed, m/s, and with a time step, s."""
    message = "trying the track"
    progress(0, 3, message)
    sparse, _ = timed(lambda: moving_kernel(track, speed, step, positions=2))
    length = sparse.weights.shape[1] * step
    progress(1, 3, message)
    tried = partial(moving_kernel, track, speed, step, duration=SHORT_KERNEL)
    times = [timed(partial(tried, positions=count))[1] for count in FEW]
    progress(2, 3, message)
    bays = speed / track.sleeper_spacing  # a second
    each = (times[1] - times[0]) / ((FEW[1] ** 2 - FEW[0] ** 2) * SHORT_KERNEL * (bays * SHORT_KERNEL + 2))
    shared = max(times[0] - each * FEW[0] ** 2 * SHORT_KERNEL * (bays * SHORT_KERNEL + 2), 0.0) / SHORT_KERNEL
    lengths, kernel = [SHORTEST], 0.0
    while lengths[-1] < 0.99 * length:
        lengths.append(1.6 * lengths[-1])
    for each_length in lengths:
        kernel += shared * each_length + each * STARTS**2 * each_length * (bays * each_length + 2)
    progress(3, 3, message)
    return TrackTrial(length, kernel, shared * length + each * STARTS**2 * length * (bays * length + 2))
