"""A ball rolls over a rough beam: a preset of the scene."""

from typing import ClassVar

from asperity.case.beam import BeamKeys
from asperity.case.body import Rolling
from asperity.case.form import section
from asperity.case.scene import Case
from asperity.case.surface import OF_RAILS, Surface
from asperity.parameters import Choice, key


class BallOnBeam(Case):
    """A ball rolls over a rough beam.

    Every length, time, force and so on is in SI here; units stand in the case file alone. Each key's meaning,
    default and allowed values are printed by ``asperity new ball-on-beam``; all keys of the body of
    ``asperity new bodies`` may stand in the section of the ball.

    Examples
    --------
    >>> from asperity import BallOnBeam
    >>> case = BallOnBeam(speed=2, surface={"rms": "0.5 um"}, ball={"load": 5})  # SI, or with units
    >>> case
    BallOnBeam(speed='2 m/s', surface={'rms': '0.5 um'}, ball={'load': '5 N'})
    >>> other = case.with_(seed=7, contact={"spacing": 4e-6}, **{"ball.load": None})
    >>> print(other.to_toml())
    kind = "ball-on-beam"
    speed = "2 m/s"
    seed = 7
    <BLANKLINE>
    [surface]
    rms = "0.5 um"
    <BLANKLINE>
    [contact]
    spacing = "4 um"
    <BLANKLINE>

    A measured map, or any array of heights, may stand where a case file names a file:

    >>> import numpy as np
    >>> heights = 1e-7 * np.random.default_rng(1).normal(size=(400, 100))
    >>> BallOnBeam(surface={"file": heights, "pixel": "8 um"}).surface.file.shape
    (400, 100)
    """

    TITLE = "A ball rolls over a rough beam."
    ROLLING, OVER = "ball", "beam"
    DISPLACEMENTS = ("beam_displacement", "ball_displacement")
    WRITTEN_OUT: ClassVar = {
        "duration": '"0.12 s"',
        "settling": '"50 ms"',
        "surface.rms": '"0.1 um"',
        "ball.load": '"50 N"',
    }
    SHOWN: ClassVar = {
        "surface": tuple(name for name in Surface.keys if name not in OF_RAILS),
        "ball": ("radius", "material", "mass", "load"),
        "numerics": ("highest_frequency", "time_step", "rtol", "force_accuracy"),
    }

    kind: str = key(Choice(("ball-on-beam",)), "ball-on-beam", "what rolls")
    ball: Rolling = section(Rolling, "the ball that rolls")
    beam: BeamKeys = section(BeamKeys, "the beam that is rolled over")

    @property
    def title(self) -> str:
        """Say what rolls over what in this case."""
        ball, beam = self.ball.material.name, self.beam.material.name
        article = "an" if beam[0].lower() in "aeiou8" else "a"
        return f"{ball[0].upper()}{ball[1:]} ball on {article} {beam} beam"
