"""Bodies roll, one or many, over any structure: the scene with all its choices; and a wheel on a rail."""

import warnings
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from asperity import extensions
from asperity.arguments import require, shown
from asperity.case.beam import BeamKeys
from asperity.case.body import OF_SEVERAL, Rolling
from asperity.case.form import Inner, section
from asperity.case.rolled_over import RolledOver, StructureKeys, TrackKeys
from asperity.case.scene import Case
from asperity.case.sections import NoiseKeys
from asperity.case.sideways import SidewaysKeys
from asperity.case.speed import span_of
from asperity.case.surface import Surface
from asperity.case.time_steps import on_grid
from asperity.errors import InputError
from asperity.parameters import Choice, Problems, key
from asperity.speeds import covered
from asperity.structures.body import GRAVITY
from asperity.units import written

BUILT_IN = ("plane", "beam", "track", "structure")
"""What may be rolled over; but for the plane, each is a section of the case."""


def structures() -> tuple[str, ...]:
    """What may be rolled over, structures of packages beside this one last."""
    return (*BUILT_IN, *_installed_structures())


def _installed_structures() -> dict[str, Inner]:
    """Sections of structures that packages beside this one offer, by name."""
    return extensions.taken(extensions.STRUCTURES, _installed_structure)


def _installed_structure(name: str, model: Any) -> Inner:
    """Section of a structure that another package offers under a name."""
    right = isinstance(model, type) and issubclass(model, RolledOver)
    allowed = "a class of asperity.case.rolled_over.RolledOver"
    require(right, f'structure "{name}"', shown(model), allowed)
    free = name.isidentifier() and name not in {*Bodies.keys, *Bodies.inner, *BUILT_IN}
    require(free, f'structure "{name}"', "its name", "a word that is no other key or section of a case")
    meaning = model.summary()
    return Inner(model, f"{meaning[:1].lower()}{meaning[1:]}")


class OverTrack(Case):
    """A scene in which a track may be rolled over."""

    noise: NoiseKeys = section(
        NoiseKeys, "what radiates where a track is rolled over, and the train that passes", last=True
    )
    sideways: SidewaysKeys = section(
        SidewaysKeys, "where a rail is touched, and what moves sideways, by frequency", last=True
    )

    @classmethod
    def prepared(cls, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """Read the coefficient of friction by the name that it had as a key of a track, with a warning."""
        sideways = given.get("sideways")
        if not isinstance(sideways, Mapping) or "friction" not in sideways:
            return super().prepared(given)
        contact = given.get("contact") or {}
        if not isinstance(contact, Mapping) or "friction" in contact:
            raise Problems(
                [InputError("[sideways] friction", "with contact.friction", "contact.friction alone")]
            )
        warnings.warn("[sideways] friction is now contact.friction: write that.", FutureWarning, stacklevel=2)
        others = {name: value for name, value in sideways.items() if name != "friction"}
        moved = {"sideways": others, "contact": {**contact, "friction": sideways["friction"]}}
        return super().prepared({**given, **moved})


class Bodies(OverTrack):
    """Bodies roll, one or many, over a plane, a beam, a track, or any structure that is known by its modes.

    Numbers are in SI, or text with its unit. ``asperity new bodies`` writes these keys as a case file.

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
    WRITTEN_OUT: ClassVar = {
        "duration": '"0.12 s"',
        "settling": '"0.3 s"',
        "surface.rms": '"0.1 um"',
        "body.load": '"50 N"',
    }

    kind: str = key(Choice(("bodies",)), "bodies", "what rolls")
    over: str = key(
        Choice(structures),
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

    @classmethod
    def sections(cls) -> Mapping[str, Inner]:
        """Sections inside it, by name, those of structures of other packages last."""
        return {**super().sections(), **_installed_structures()}

    @property
    def section_names(self) -> tuple[str, ...]:
        """Sections that matter: a structure of another package where it is rolled over."""
        installed = self.over in _installed_structures()
        return (*super().section_names, self.over) if installed else super().section_names

    def problems(self) -> Iterator[InputError]:
        """Only what is rolled over is described, and it is; what must fit together across the sections."""
        for name in structures()[1:]:
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


# --- a wheel on a rail

STEPS_PER_PERIOD = 8  # of the highest frequency
CLOSE = 1.2  # a time step may be changed by this factor to bring positions onto the grid


class RailSurface(Surface):
    """Texture of a rail, laid out in strips: lines are known across, and every law can be rolled."""

    IN_STRIPS = True


DEFAULTS = {
    "speed": "56 m/s",
    "start": "0 m",
    "duration": "1 s",
    "settling": "0.3 s",
}


class WheelOnRail(OverTrack, defaults=DEFAULTS):
    """A wheel rolls on a rail of infinite length on discrete supports.

    Numbers are in SI, or text with its unit. ``asperity new wheel-on-rail`` writes these keys as a case file.
    Positions count along the rail, in m from a sleeper. Every law is allowed: textures are laid out in
    strips.

    Examples
    --------
    >>> from asperity import WheelOnRail
    >>> case = WheelOnRail(surface={"spectrum": "iso3095"}, track={"pad_stiffness": 150e6})
    >>> case.with_(speed="200 km/h").track.model().pad_stiffness
    150000000.0
    """

    TITLE = "A wheel rolls on an infinite track."
    ROLLING, OVER = "wheel", "track"
    DISPLACEMENTS = ("rail_displacement", "wheel_displacement")
    WRITTEN_OUT: ClassVar = {"surface.spectrum": '"iso3095"', "wheel.roughness": '"disc"'}
    SHOWN: ClassVar = {"wheel": tuple(name for name in Rolling.keys if name not in OF_SEVERAL)}

    kind: str = key(Choice(("wheel-on-rail",)), "wheel-on-rail", "what rolls")
    surface: Surface = section(
        RailSurface,
        "texture of the rail: measured or synthesised, with defects on top",
        lateral=1.0,
        continuation="refuse",
    )
    wheel: Rolling = section(
        Rolling,
        "the wheel that rolls",
        radius="0.46 m",
        mass="600 kg",
        load="65 kN",
        transverse_radius="inf",
        section="straight-web",
    )
    track: TrackKeys = section(TrackKeys, "the track that is rolled over")

    @property
    def title(self) -> str:
        """Say what rolls over what in this case."""
        return f"Wheel on rail at {span_of(self.speed, 'm/s', 'm/s')}"

    @property
    def usual_step(self) -> float:
        """Time step in s near 1/(8 f_max).

        Where that changes it by less than 20 %, the distance rolled in one step is a whole multiple, or a
        whole fraction, of ``contact.spacing``.
        """
        per_cell = self.contact.spacing / self.speed
        wanted = 1 / (STEPS_PER_PERIOD * self.numerics.highest_frequency)
        cells = round(wanted / per_cell)
        step = cells * per_cell if cells else on_grid(wanted, per_cell)
        return step if 1 / CLOSE <= step / wanted <= CLOSE else wanted

    def own_problems(self) -> Iterator[InputError]:
        """A load that asks for its unit, and a path that is long enough."""
        weight = GRAVITY * self.wheel.contact_mass
        if self.wheel.contact_load < weight * (1.0 - 1e-9):
            received = written(self.wheel.contact_load, "N", "kN")
            mass = self.wheel.contact_mass
            allowed = f"at least {written(weight, 'N', 'kN')}, the weight of {mass:g} kg on the contact"
            remedy = "Loads include the wheel's own weight: give the load in kN, or a lighter wheel."
            yield InputError("wheel.load", received, allowed, remedy)
        length = covered(self.speed, self.rolled_time)
        contact = self.contact
        least = max(contact.window, (contact.filter_taps or 0) * contact.spacing)
        if length < least:
            received = f"{self.rolled_time:g} s, in which {length * 1e3:.4g} mm are rolled"
            allowed = (
                f"at least contact.window, and contact.filter_taps spacings, {written(least, 'm', 'mm')}"
            )
            yield InputError("duration", received, allowed, "A path must be longer than window and filters.")
