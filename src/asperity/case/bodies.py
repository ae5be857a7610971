"""Bodies roll, one or many, over any structure: the scene with all its choices."""

from collections.abc import Iterator
from typing import ClassVar

from asperity.case.beam import BeamKeys
from asperity.case.body import Rolling
from asperity.case.form import section
from asperity.case.rolled_over import RolledOver, StructureKeys, TrackKeys
from asperity.case.scene import Case
from asperity.case.sections import NoiseKeys
from asperity.case.sideways import CreepKeys, SidewaysKeys
from asperity.errors import InputError
from asperity.parameters import Choice, key

STRUCTURES = ("plane", "beam", "track", "structure")
"""What may be rolled over; but for the plane, each is a section of the case."""


class OverTrack(Case):
    """A scene in which a track may be rolled over."""

    noise: NoiseKeys = section(
        NoiseKeys, "what radiates where a track is rolled over, and the train that passes", last=True
    )
    sideways: SidewaysKeys = section(
        SidewaysKeys, "where a rail is touched, and what moves sideways, by frequency", last=True
    )
    creep: CreepKeys = section(CreepKeys, "how wheels creep on a rail, and whether they squeal", last=True)


class Bodies(OverTrack):
    """Bodies roll, one or many, over a plane, a beam, a track, or any structure that is known by its modes.

    Every length, time, force and so on is in SI here; units stand in the case file alone. Each key's meaning,
    default and allowed values are printed by ``asperity new bodies``.

    Examples
    --------
    >>> from asperity import Bodies
    >>> bogie = {"type": "bogie", "masses": [3000], "springs": [1.2e6], "distance": 2.5, "mass": 600}
    >>> case = Bodies(over="track", speed=30, body=bogie, surface={"rms": "5 um"})
    >>> case.body.offsets
    (0.0, 2.5)
    """

    TITLE = "Bodies roll over a structure."
    ROLLING = "body"
    WRITTEN_OUT: ClassVar = {"duration": '"0.12 s"', "surface.rms": '"0.1 um"', "body.load": '"50 N"'}

    kind: str = key(Choice(("bodies",)), "bodies", "what rolls")
    over: str = key(
        Choice(STRUCTURES),
        "beam",
        "what is rolled over: a rigid plane, or what the section of this name describes",
    )
    body: Rolling = section(Rolling, "what rolls")
    beam: BeamKeys = section(BeamKeys, "a beam that is rolled over")
    track: TrackKeys = section(TrackKeys, "a track that is rolled over")
    structure: StructureKeys = section(
        StructureKeys, "any other structure that is rolled over, by its modes or receptances"
    )

    @property
    def rolled_over(self) -> RolledOver:
        """What is rolled over; of a plane, the structure that has its material alone."""
        over: RolledOver = getattr(self, "structure" if self.over == "plane" else self.over)
        return over

    @property
    def over_name(self) -> str:
        """What is rolled over, in a word."""
        return self.over

    def problems(self) -> Iterator[InputError]:
        """Only what is rolled over is described, and it is; what must fit together across the sections."""
        for name in STRUCTURES[1:]:
            on_plane = {"material"} if (name, self.over) == ("structure", "plane") else set()
            named = getattr(self, name).given().keys() - on_plane
            if name != self.over and named:
                remedy = f"Remove a [{name}] that is not rolled over: {', '.join(sorted(named))}."
                yield InputError("over", f'"{self.over}"', f'"{name}", where it is described', remedy)
        if self.over == "structure" and not self.structure.is_known:
            remedy = 'As file = "guide.csv".'
            yield InputError("structure.file", "nothing", "the file of its modes, or receptances", remedy)
            return
        yield from super().problems()
