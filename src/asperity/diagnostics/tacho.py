"""What a tacho says of the speed of a record, and what is asked of it where lines say another."""

from dataclasses import dataclass

from asperity.written_numbers import count_of

AS_WHOLE = 0.01
"""Share of a pulse in a turn up to which pulses that lines ask for are taken for a whole number."""


@dataclass(frozen=True)
class Tacho:
    """A tacho, or a speed recorded beside a signal, that gives the speed of the shaft.

    Attributes
    ----------
    pulses : int
        That it is said to give in a turn; 0 of one that reads a speed.
    """

    pulses: int = 0

    @property
    def condition(self) -> str:
        """On which its speed is right; empty of one that reads a speed."""
        return f"if it gives {count_of(self.pulses, 'pulse')} in a turn" if self.pulses else ""

    @property
    def question(self) -> str:
        """What is asked where lines say another speed."""
        if self.pulses:
            return f"does the tacho give {count_of(self.pulses, 'pulse')} in a turn, and is it on this shaft?"
        return "is the speed beside the signal that of this shaft, and are its unit and the rate right?"

    def otherwise(self, ratio: float) -> str:
        """With how many pulses in a turn the speed were another one, over that told; empty of no whole
        number."""
        pulses = self.pulses / ratio
        if not pulses or abs(pulses - round(pulses)) > AS_WHOLE * pulses:
            return ""
        return f", as with {count_of(round(pulses), 'pulse')} in a turn"
