"""What is said of a record: whether its speed is confirmed, which parts are struck, and how sure that is."""

import math
from dataclasses import dataclass
from typing import Literal

from asperity.diagnostics.confidence import Basis, chance_elsewhere, own_share
from asperity.diagnostics.hypotheses import BearingRecord, Hypothesis
from asperity.diagnostics.prominence import LOWEST_PLACE
from asperity.diagnostics.shaft import MAINS, SURELY
from asperity.diagnostics.tacho import Tacho

RESOLVED = 2.0 * LOWEST_PLACE
"""Turns of a record from which on it holds the line of the shaft, and side bands at its speed apart from
what they stand beside."""
EVEN = 0.5
"""Confidence of a part, at least, that is named in a shorter record."""
Speed = Literal["confirmed", "measured", "unconfirmed", "contradicted"]
NAMES = {"outer": "outer ring", "inner": "inner ring", "ball": "ball"}
"""Of parts, as people say them."""
NOT_FOUND, ELSEWHERE = "fault, shaft not found", "elsewhere"
"""Kinds of a verdict on a part that no line of the shaft speaks for, and on one at another speed."""
CONFIRMED: Speed = "confirmed"
UNCONFIRMED: Speed = "unconfirmed"
MEASURED: Speed = "measured"
"""By a tacho: lines of the shaft neither confirm nor contradict it."""
CONTRADICTED: Speed = "contradicted"


def part_name(part: str, element: str) -> str:
    """A part of a bearing in which balls or rollers roll, as people say it."""
    return element if part == "ball" else NAMES[part]


@dataclass(frozen=True)
class Diagnosis:
    """What the lines of a record say.

    Attributes
    ----------
    told, speed : float
        Speed given, and by the lines of the shaft where they are there, Hz.
    speed_is : {"confirmed", "measured", "unconfirmed", "contradicted"}
        Whether lines of the shaft are where the speed given says, are not found, where a tacho gave it or
        nothing but words, or are elsewhere.
    parts : tuple of Hypothesis
        Parts that are struck, the clearest first; none of a record without the lines of a fault. More than
        one where several are struck.
    alike : tuple of Hypothesis
        Other parts that have the same lines.
    faint : Hypothesis or None
        Lines of a part that are too faint for a fault.
    blows : float
        Frequency of blows that are those of no part at this speed, Hz; 0 for none.
    others : tuple of float
        Speeds, Hz, that have the lines of the shaft as well as the one given: its half, its double, ….
    otherwise : Hypothesis or None
        What the lines of the parts are as well, of a shaft at another speed.
    nearest : Hypothesis or None
        What blows that are those of no part would be at a speed near the one given.
    tones_alone : tuple of float
        Frequencies, Hz, of a record that holds tones alone, against which no line stands out; none of others.
    once_in_a_turn : bool
        Whether there are deep blows of the shaft itself, as of a rub, which may hide those of parts.
    basis : Basis
        What this rests on.
    resolution : float
        Distance of two lines that are told apart, Hz: one over the duration, or that of the pieces of a long
        record.
    record : BearingRecord
        What was looked at.
    by_chance : float
        Chance that blows of something else lie where a part has them.
    doubts : tuple of str
        What is wrong with the recording, in sentences.
    fastest : float
        Speed beyond which hardly any such bearing runs, Hz.
    element : str
        What rolls in the bearing, ``"ball"`` or ``"roller"``.
    tacho : Tacho or None
        What gave the speed; None of one that was told.
    """

    told: float
    speed: float
    speed_is: Speed
    parts: tuple[Hypothesis, ...]
    alike: tuple[Hypothesis, ...]
    faint: Hypothesis | None
    blows: float
    others: tuple[float, ...]
    basis: Basis
    resolution: float
    record: BearingRecord
    doubts: tuple[str, ...] = ()
    fastest: float = math.inf
    element: str = "ball"
    otherwise: Hypothesis | None = None
    nearest: Hypothesis | None = None
    by_chance: float = 0.0
    tones_alone: tuple[float, ...] = ()
    once_in_a_turn: bool = False
    tacho: Tacho | None = None

    def name(self, part: str) -> str:
        """A part, as people say it."""
        return part_name(part, self.element)

    @property
    def turns(self) -> float:
        """Turns of the shaft in a piece of the record, at the speed given."""
        return self.record.duration * self.told

    @property
    def confidence(self) -> float:
        """That this is so, 0 to 1: less where another bearing may have the blows; even at most where that is
        doubted."""
        chance = self.by_chance if self.may_be_foreign else 0.0
        if self.basis.kind == ELSEWHERE:
            chance = chance_elsewhere(self.basis.support)
        sure = self.basis.confidence * own_share(chance)
        return min(sure, EVEN) if self.doubted else sure

    @property
    def doubted(self) -> bool:
        """Whether no such record is among those that confidence is calibrated on.

        Where the lines fit another speed better; of unlike blows at another speed, which any comb may be at
        some one; of tones alone, of a part that a rub may hide, and at a speed beyond belief.
        """
        unlike = self.basis.kind == ELSEWHERE and not self.parts[0].is_sure
        hidden = (self.once_in_a_turn and not self.parts) or self.twice_in_a_turn
        better = self.otherwise is not None
        return better or unlike or hidden or bool(self.tones_alone) or self.beyond_belief

    @property
    def twice_in_a_turn(self) -> bool:
        """Whether a comb of a part is that of a shaft which turns twice as fast, as of a rub, as well."""
        own = (each for each in self.parts if each.support < SURELY or not each.is_sure)
        return any(abs(each.tone - 2.0 * self.told) <= self.resolution for each in own)

    @property
    def may_be_foreign(self) -> bool:
        """Whether no line of the shaft speaks for the part: another bearing may have its blows."""
        return bool(self.parts) and self.basis.kind == NOT_FOUND

    @property
    def beyond_belief(self) -> bool:
        """Whether hardly any such bearing runs as fast as told: revolutions per minute given as hertz."""
        return self.told > self.fastest

    @property
    def undecided(self) -> bool:
        """Whether no part is named of a record that is too short for lines of the shaft and side bands."""
        return self.turns < RESOLVED and not self.parts and not self.blows

    @property
    def mains(self) -> float:
        """Line of the mains that is not told apart from the blows of the clearest part, Hz; 0 for none."""
        tone = self.parts[0].blows if self.parts else 0.0
        nearest = min(MAINS, key=lambda line: abs(line - tone))
        return nearest if abs(nearest - tone) <= 0.5 * self.resolution else 0.0

    @property
    def by_made_signals(self) -> bool:
        """Whether its confidence rests on made signals: none with a fault of a ball was measured."""
        return any(each.part == "ball" for each in self.parts)
