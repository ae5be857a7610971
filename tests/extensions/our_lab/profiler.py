"""The files of our profiler: a word, two counts, the distance of points in µm, then heights in nm."""

import struct

import numpy as np

from asperity import HeightMap
from asperity.surfaces.readers import SurfaceFormat

WORD = b"OURPROF1"
HEADER = "<iif"


def read(path, hints):
    """A map of heights, m."""
    content = path.read_bytes()[len(WORD) :]
    nx, ny, distance = struct.unpack_from(HEADER, content)
    heights = np.frombuffer(content, "<f4", offset=struct.calcsize(HEADER))
    if nx < 1 or heights.size != nx * ny:
        raise ValueError(f"{heights.size} heights, where {nx} × {ny} are announced")
    return HeightMap(1e-9 * heights.reshape(nx, ny).astype(float), (1e-6 * distance,) * 2, path.name)


FORMAT = SurfaceFormat("profiler", read, begins=WORD)
