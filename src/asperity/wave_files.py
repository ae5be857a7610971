"""WAV files that say what their samples stand for: a comment in the file tells the value of full scale."""

import io
import json
import struct
import wave
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np

from asperity.arguments import ArrayLike

LONGEST_COMMENT = 4096  # bytes
"""Of the comment in a file, longer ones are not ours."""


FORM, SAMPLES = b"fmt ", b"data"
"""Pieces that each WAV file has."""
BACKWARDS = b"RIFX", b"FFIR"
"""First letters of files whose numbers begin with their highest byte."""
_FORM = "HHIIHH"


def wave_bytes(
    samples: ArrayLike, rate: float, full_scale: float, unit: str, *, bits: int = 16, what: str = ""
) -> bytes:
    """Write a WAV file (PCM) of samples (n,), or of channels side by side (n, k), in a unit.

    Samples of `full_scale` become the largest number of so many bits, 16 or 24; larger ones are clipped. The
    comment of the file (chunk LIST, INFO, ICMT) says so as JSON: ``{"full_scale": 9.81, "at": 32767, "unit":
    "m/s2", "what": "…"}``.
    """
    values = np.asarray(samples, dtype=float).reshape(len(np.asarray(samples)), -1)
    most = 2 ** (bits - 1) - 1
    numbers = np.round(most * np.clip(values / full_scale, -1.0, 1.0)).astype("<i4")
    each = numbers.ravel().view(np.uint8).reshape(-1, 4)[:, : bits // 8]
    file = io.BytesIO()
    with wave.open(file, "wb") as sound:
        sound.setparams((values.shape[1], bits // 8, round(rate), 0, "NONE", "not compressed"))
        sound.writeframes(each.tobytes())
    told = {"full_scale": float(full_scale), "at": most, "unit": unit, "what": what}
    return _commented(file.getvalue(), json.dumps(told).encode())


def _commented(content: bytes, comment: bytes) -> bytes:
    """A WAV file with a comment at its end."""
    text = comment + b"\0" * (2 - len(comment) % 2)
    inside = b"INFO" + b"ICMT" + len(text).to_bytes(4, "little") + text
    whole = content + b"\0" * (len(content) % 2) + b"LIST" + len(inside).to_bytes(4, "little") + inside
    return whole[:4] + (len(whole) - 8).to_bytes(4, "little") + whole[8:]


def chunks_of(file: Path) -> Iterator[tuple[bytes, int, int]]:
    """Name of each chunk of a WAV file, the place of its content, and the length that its head tells."""
    with open(file, "rb") as opened:
        head = opened.read(12)
        order: Literal["big", "little"] = "big" if head[:4] in BACKWARDS else "little"
        place = len(head)
        size = file.stat().st_size
        long = 0
        while place + 8 <= size:
            opened.seek(place)
            name = opened.read(4)
            told = int.from_bytes(opened.read(4), order)
            if name == b"ds64":  # of a file beyond 4 GiB
                long = int.from_bytes(opened.read(16)[8:], order)
            if name == SAMPLES:
                told = long or told
            yield name, place + 8, told
            place += 8 + told + told % 2


def form_of(file: Path, place: int) -> tuple[int, ...]:
    """Numbers of the piece `FORM` at a place of a WAV file.

    The kind of its samples, channels, samples per second, bytes per second, bytes of a sample of all
    channels, and bits of one.
    """
    with open(file, "rb") as opened:
        order = ">" if opened.read(4) in BACKWARDS else "<"
        opened.seek(place)
        return struct.unpack(order + _FORM, opened.read(struct.calcsize(order + _FORM)).ljust(16, b"\0"))


def told_scale(file: Path) -> float | None:
    """Value that the number one stands for, in the unit that the comment of a file says; None without one."""
    for name, place, length in chunks_of(file):
        if name == b"LIST" and length <= LONGEST_COMMENT:
            with open(file, "rb") as opened:
                opened.seek(place)
                content = opened.read(length)
            _, mark, text = content.partition(b"ICMT")
            told = _told(text[4:].rstrip(b"\0")) if mark else None
            if told is not None:
                return told
    return None


def _told(text: bytes) -> float | None:
    try:
        told: Any = json.loads(text)
        scale = float(told["full_scale"]) / float(told["at"])
    except (ValueError, TypeError, KeyError, ZeroDivisionError):
        return None
    return scale if 0.0 < scale < np.inf else None
