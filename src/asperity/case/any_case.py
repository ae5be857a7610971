"""The case of any kind: its keys in and out of TOML, other values for some; and what computes it."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol, Self, runtime_checkable

from asperity import files
from asperity.arguments import FilePath, file_path, nearest, require, shown
from asperity.case.beside import arrays_and_keys, refused
from asperity.case.documented import allowed_in
from asperity.case.form import Inner, Section, content, in_toml
from asperity.case.in_memory import described_value
from asperity.case.ready_lists import NamedChanges
from asperity.case.toml import toml_text, toml_value
from asperity.case.written_values import in_words
from asperity.errors import InputError
from asperity.laws import family_of, law_keys, names, spec_of
from asperity.parameters import (
    Choice,
    Key,
    Number,
    Origin,
    Problems,
    Quantity,
    Text,
    key,
)

_COLUMN = 32  # where comments of a commented case start, if the value leaves room


LAW = Choice(names)
"""A law of the contact force, built in or registered."""


class CaseKey(NamedTuple):
    """One key of a case."""

    dotted: str  # name with its section, as "contact.spacing"
    key: Key

    @property
    def section(self) -> str:
        """Name of the section that it stands in; empty at the top."""
        return self.dotted.rpartition(".")[0]

    @property
    def name(self) -> str:
        """Its name in the section."""
        return self.dotted.rpartition(".")[2]

    @property
    def unit(self) -> str | None:
        """SI unit where values are single numbers; None of any other key."""
        kind = self.key.kind
        return kind.dimension if isinstance(kind, Quantity) else "1" if isinstance(kind, Number) else None

    def read(self, value: object, origin: Origin) -> Any:
        """A value of the key in SI; an `InputError` says what is wrong with it."""
        try:
            return self.key.kind(value, origin)
        except Problems as problems:
            error = problems.errors[0]
        except InputError as wrong:
            error = wrong
        raise error.about(self.dotted)


def entries(model: type[Section], title: str = "") -> Iterator[CaseKey]:
    """List all keys of a kind of case, those of its sections after those at the top."""
    for name, own in model.keys.items():
        yield CaseKey(f"{title}.{name}".lstrip("."), own)
    for name, inner in model.sections().items():
        yield from entries(inner.model, name)


def entry_of(model: type[Section], dotted: str) -> CaseKey:
    """Find a key of a kind of case by its name with its section, as ``"contact.spacing"``."""
    title, _, name = dotted.rpartition(".")
    if (inner := model.section_at(title)) and name in inner.model.keys:
        return CaseKey(dotted, inner.model.keys[name])
    by_name = {entry.dotted: entry for entry in entries(model)}
    if dotted in by_name:
        return by_name[dotted]
    homes = [name for name, entry in by_name.items() if entry.name == dotted]
    remedy = f'Write it with its section, "{homes[0]}".' if homes else nearest(dotted, list(by_name))
    allowed = f'a key of a {model.keys["kind"].default} case, with its section, as "contact.spacing"'
    raise InputError(dotted, "an unknown key", allowed, remedy)


def commented(
    model: type[Section], written_out: Mapping[str, str], shown: Mapping[str, Sequence[str]] | None = None
) -> str:
    """Write a case in TOML: one line for each key with its value, meaning, what is allowed and default.

    Keys without a fixed default are commented out, but for those that are `written_out`; of some sections
    those that are `shown` alone are written.
    """
    lines: list[str] = []
    title = ""
    for entry in entries(model):
        if entry.name not in (shown or {}).get(entry.section, (entry.name,)):
            continue
        if entry.section != title:
            title = entry.section
            lines += ["", f"[{title}]{'':{_COLUMN - len(title) - 2}}# {model.sections()[title].meaning}"]
        lines.append(_commented_line(entry, written_out))
    return "\n".join(lines) + "\n"


def _commented_line(entry: CaseKey, written_out: Mapping[str, str]) -> str:
    key = entry.key
    value = written_out.get(entry.dotted)
    default = f"default: {key.otherwise}" if key.otherwise else "no default"
    if key.default is not None:
        usual = toml_value(key.default)
        default = "default" if value in (None, usual) else f"default: {usual}"
        value = usual if value is None else value
    lonely = key.goes_with and f"{entry.section}.{key.goes_with}" not in written_out
    if key.goes_with:
        default += f"; goes with {key.goes_with}"
    code = f"{entry.name} = {toml_value(key.example) if value is None else value}"
    if value is None or lonely:
        code = f"# {code}"
    return f"{code:{_COLUMN - 2}}  # {key.meaning} ({allowed_in(key)}; {default})"


_law_sections: dict[str, tuple[Mapping[str, Key], Inner]] = {}


def _sections_of_laws() -> dict[str, Inner]:
    """Sections of laws that have keys of their own, by name; each is made once."""
    keyed = law_keys()
    for name, keys in keyed.items():
        if _law_sections.get(name, (None,))[0] is not keys:
            model = type("LawKeys", (Section,), {"__doc__": f"Keys of the law {name}."}, parameters=keys)
            _law_sections[name] = keys, Inner(model, f"keys of the law {name}")
    return {name: _law_sections[name][1] for name in keyed}


class AnyCase(Section):
    """A case of any kind: a frozen section with a kind and other sections inside.

    It does not change; `with_` makes another one. Cases are equal if all their keys are.
    """

    TITLE: ClassVar[str]
    """One sentence: what rolls over what."""
    NEEDED: ClassVar[str] = "a source of texture, or smooth = true"
    """What a case cannot do without, beside its kind."""
    PREPARED_BY: ClassVar[str]
    """Function (case, source) that makes a `ReadyCase` of it, by module and name."""
    COMPUTED_BY: ClassVar[str]
    """Function (ready case, progress, warnings caught, brief=…) that makes its result."""
    PLANNED_BY: ClassVar[str]
    """Function (ready case, progress) that says what will be computed, a `scenarios.preparing.Plan`."""
    SCANNED_BY: ClassVar[str] = ""
    """Function (ready case) that sizes its scans, by what for; empty of a kind without long ones."""
    LAID_BY: ClassVar[str]
    """Function (ready case, name of a law, ring of a bearing) that lays a law out on its path."""
    REFINED_BY: ClassVar[str]
    """Function (ready case, its result) that lists the settings by which it is made finer."""
    PRESSED_BY: ClassVar[str]
    """Function (case) that lays out the contact which the page lets people press."""
    OPTIMISED_BY: ClassVar[str] = ""
    """How its texture is optimised, an `asperity.optimising.kinds.Optimisation`; empty of a kind without."""
    WRITTEN_OUT: ClassVar[Mapping[str, str]] = {}
    """Values, in TOML, of keys that have no default and shall stand in a commented case."""
    SHOWN: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    """Keys of some sections that a commented case shows; the others are for scenes of other kinds."""
    OFFERED: ClassVar[tuple[str, ...]] = ("parameters", "save", "text", "title", "to_toml", "with_")

    kind: str = key(Text(), "", "what rolls")

    if TYPE_CHECKING:  # each kind declares these
        laws: tuple[str, ...]
        seed: int

    @classmethod
    def sections(cls) -> Mapping[str, Inner]:
        """Sections inside it, by name, those of laws that have keys of their own first."""
        return {**_sections_of_laws(), **cls.inner}

    @property
    def section_names(self) -> tuple[str, ...]:
        """Sections that matter: those of laws that are rolled among them."""
        families = {family_of(law) for law in self.laws}
        return (*super().section_names, *(name for name in _sections_of_laws() if name in families))

    def law_parameters(self, law: str) -> dict[str, Any]:
        """Values of the keys that a law has of its own, by name."""
        return {name: getattr(getattr(self, family_of(law)), name) for name in spec_of(law).parameters}

    def problems_of_law_keys(self) -> Iterator[InputError]:
        """Keys of laws that are rolled alone."""
        for name in _sections_of_laws():
            if name not in self.section_names and getattr(self, name).given():
                received = "keys of a law that is not rolled"
                yield InputError(name, received, f'"{name}" in laws', "Remove them.")

    @property
    def title(self) -> str:
        """Say what runs, or rolls over what."""
        raise NotImplementedError

    @property
    def numbers_written(self) -> float:
        """How many numbers its result holds, at most."""
        raise NotImplementedError

    @property
    def steps_taken(self) -> int:
        """Time steps of each law, those before the record among them."""
        raise NotImplementedError

    @property
    def forces_evaluated(self) -> int:
        """How many forces its laws evaluate, of all contacts in all time steps."""
        raise NotImplementedError

    @property
    def points_laid(self) -> float:
        """Points of texture that are laid out before anything is computed, at most; none by default."""
        return 0.0

    @property
    def recorded_step(self) -> float:
        """Time between two samples of its records, s."""
        raise NotImplementedError

    @property
    def highest_frequency(self) -> float:
        """Highest frequency that its spectra hold, Hz."""
        raise NotImplementedError

    @property
    def cells_at_rims(self) -> tuple[str, ...]:
        """How cells at the rims of its contacts may count: several where that is chosen as it is prepared.

        Empty of a kind whose contacts are not compiled ahead, as of bearings.
        """
        return ()

    @classmethod
    def shared_keys(cls, cases: "Sequence[Self]") -> dict[str, float]:
        """Keys that were chosen otherwise for some of several cases than for others, fit for all of them."""
        return {}

    @property
    def helping_changes(self) -> NamedChanges:
        """Changes that may make it quieter, of which a study of what helps is made; none by default."""
        return {}

    def with_(self, **changes: Any) -> Self:
        """Return the same case with other values for some keys.

        Parameters
        ----------
        **changes
            Keys with their new values, in SI or as text with a unit; None takes a key out. A key of a section
            is written ``**{"contact.spacing": 4e-6}``, or in a mapping of keys of the section, of which the
            others stay: ``contact={"spacing": "4 um"}``. A list of sections replaces all of them, as
            ``fault=[{…}, {…}]``; the second is ``fault[2]``.

        Returns
        -------
        Case
            A new case of the same kind.

        Raises
        ------
        CaseError
            With all errors at once, if the keys are wrong or do not fit together.
        """
        data = self.given()
        for name, value in changes.items():
            title, _, key_in_section = name.rpartition(".")
            _change(data, {title: {key_in_section: value}} if title else {name: value})
        return type(self)(**data)

    def to_toml(self) -> str:
        """Write the case as a case file: its kind, and all keys that are not at their defaults.

        Returns
        -------
        str
            TOML that reads as the same case, to the last bit.

        Raises
        ------
        InputError
            If a surface or a table stands in memory, which no case file can hold.
        """
        return toml_text({"kind": self.kind, **in_toml(self, in_memory=refused)})

    def save(self, path: FilePath) -> Path:
        """Write the case as a case file, with the maps and lines that stand in memory beside it.

        Each of them is an array of heights in a file of its own, as ``case_surface_file.npy``, which the case
        names with the distance of its points: ``asperity run`` computes from it what Python did, to the last
        bit.

        Parameters
        ----------
        path : path
            The case file, ``….toml``; its folder is made if it is missing.

        Returns
        -------
        Path
            The case file.

        Raises
        ------
        InputError
            If something stands in memory that no array of heights holds: a table, modes, a map whose points
            are not as far apart along as across.
        ComputationError
            If a file cannot be written.

        Examples
        --------
        >>> case.save("saved/case.toml").name
        'case.toml'
        """
        allowed = 'the path of a case file, as "case.toml"'
        target = file_path("path", path, allowed)
        require(target.suffix.lower() == ".toml", "path", shown(str(target)), allowed)
        arrays, keys = arrays_and_keys(self, target.stem)
        with files.together(target.parent, last=target.name) as new:
            for name, content in arrays.items():
                files.write_bytes(new / name, content)
            files.write_bytes(new / target.name, toml_text({"kind": self.kind, **keys}).encode())
        return target

    @property
    def text(self) -> str:
        """The case in TOML; what stands in memory is described, with its digest."""
        keys = in_toml(self, in_memory=lambda _, value: described_value(value))
        return toml_text({"kind": self.kind, **keys})

    @property
    def in_memory(self) -> dict[str, str]:
        """What stands in memory, which no case file can hold, by its dotted key."""
        held: dict[str, str] = {}
        in_toml(self, in_memory=lambda key, value: held.setdefault(key, described_value(value)))
        return held

    def parameters(self) -> list[dict[str, Any]]:
        """List the keys that matter in this case, for people.

        Returns
        -------
        list of dict
            For each key: ``key`` (dotted), ``value`` and ``default`` (text with units), ``is_default`` and
            ``note`` (what the key is).
        """
        listed = []
        for title in ("", *self.section_names):
            section: Section = getattr(self, title) if title else self
            for name, own in section.keys.items():
                if not section.is_active(name):
                    continue
                value = getattr(section, name)
                usual = section.default_of(name)
                default = own.otherwise if usual is None else in_words(usual, own)
                same = value is None or content(value) == content(usual)
                if same and name not in self.SHOWN.get(title, (name,)):
                    continue
                if text := default if value is None else in_words(value, own):
                    told = {"key": f"{title}.{name}".lstrip("."), "value": text, "default": default}
                    listed.append(told | {"is_default": same, "note": own.meaning})
        return listed

    def _repr_html_(self) -> str:
        """What is set, as a table for notebooks."""
        rows = [
            f"<tr><td>{escape(each['key'])}</td><td>{escape(each['value'])}</td><td>{escape(each['note'])}</td></tr>"
            for each in self.parameters()
            if not each["is_default"]
        ]
        heading = "<tr><th>key</th><th>value</th><th>meaning</th></tr>"
        table = f"<table>{heading}{''.join(rows)}</table>" if rows else "<p>Every key is at its default.</p>"
        return f"<div><p><strong>{escape(self.title)}.</strong></p>{table}</div>"


@runtime_checkable
class ReadyCase(Protocol):
    """A case of any kind that can be computed."""

    @property
    def case(self) -> AnyCase:
        """The case."""
        ...

    @property
    def caught(self) -> tuple[warnings.WarningMessage, ...]:
        """Warnings met on the way."""
        ...

    @property
    def chosen(self) -> Mapping[str, str]:
        """Keys that were chosen for it as it was prepared, which fix them for others compared with it."""
        ...


def function_named(function: str) -> Any:
    """A function by its module and name, as a kind of case names those that compute it."""
    module, _, name = function.rpartition(".")
    return getattr(import_module(module), name)


def _change(data: dict[str, Any], changes: Mapping[str, Any]) -> None:
    """Put keys into the dicts of a case; None takes them out."""
    for name, value in changes.items():
        if isinstance(value, Mapping) and isinstance(inner := data.get(name, {}), dict):
            data[name] = inner = dict(inner)
            _change(inner, value)
            continue
        for each in [each for each in data if each == name or each.startswith(f"{name}[")]:
            del data[each]
        if value is not None:
            data[name] = value
