"""A format of measured surfaces that a package beside this one reads."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asperity.arguments import require, shown
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers.hints import Hints

Surface = HeightMap | Profile


@dataclass(frozen=True)
class SurfaceFormat:
    """A format of files with heights, which `asperity.read_surface` and cases then know.

    Parameters
    ----------
    name : str
        What it is called in messages, as ``"RAW of our profiler"``.
    read : callable
        ``read(path, hints)`` returns a `HeightMap` or `Profile`, or a list of them, of an ensemble. Heights
        are in m, peaks positive; `hints` is what the user says of the file (`Hints`). Whatever it raises is
        told as a damaged file.
    extensions : sequence of str
        Of its files, as ``(".raw",)``, which this program does not read itself.
    begins : bytes
        What its files begin with; where it is given, files are known by it alone.

    Raises
    ------
    InputError
        If any of it is wrong.
    """

    name: str
    read: Callable[[Path, Hints], Surface | list[Surface]]
    extensions: Sequence[str] = ()
    begins: bytes = b""

    def __post_init__(self) -> None:
        what = f"format {self.name}"
        require(callable(self.read), f"read of {what}", shown(self.read), "a function of path and hints")
        right = not isinstance(self.extensions, str) and all(_is_ending(each) for each in self.extensions)
        require(right, f"extensions of {what}", shown(self.extensions), 'small letters, as (".raw",)')
        known = bool(self.extensions or self.begins)
        require(known, what, "nothing that its files are known by", "extensions, or what they begin with")

    def has(self, extension: str, head: bytes) -> bool:
        """Whether a file with this extension, in small letters, that begins so is of this format."""
        return head.startswith(self.begins) if self.begins else extension in self.extensions

    def surfaces(self, path: Path, hints: Hints) -> list[Surface]:
        """Read all surfaces of a file."""
        found = self.read(path, hints)
        some = list(found) if isinstance(found, list | tuple) else [found]
        right = bool(some) and all(isinstance(each, Surface) for each in some)
        require(
            right, path.name, shown(found), f"a height map or profile, which the reader of {self.name} makes"
        )
        return some


def _is_ending(extension: Any) -> bool:
    return isinstance(extension, str) and extension.startswith(".") and extension == extension.lower()
