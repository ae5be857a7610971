"""The textures of a case: samples that are reduced, and the path that is rolled over, under each contact."""

import math
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from asperity.arguments import Array
from asperity.case.in_memory import name_of
from asperity.case.rolling_case import SETTLED
from asperity.case.scene import Case
from asperity.case.sections import ContactKeys
from asperity.case.surface import Surface
from asperity.errors import InputError, OutOfRangeWarning, ShortRecordWarning, TruncatedContactWarning
from asperity.laws import spec_of
from asperity.scenarios import records
from asperity.scenarios.defects import Defects
from asperity.scenarios.geometry import Geometry, cells_over, window_cells
from asperity.scenarios.records import Grid, Record
from asperity.spectra import lowest_band
from asperity.speeds import SpeedCourse
from asperity.surfaces import levelling, statistics, synthesis
from asperity.surfaces.cell_means import PressedStrip, pressed_heights
from asperity.surfaces.defects import corrugation
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.second_rows import SecondRows
from asperity.surfaces.strip import PIECE, LongStrip, Raised, Rows, Strip, raised, turning
from asperity.threads import in_order
from asperity.written_numbers import count_of, rounded

STRIP_WINDOWS = 16
"""Length of a strip for the filters, in windows: few bins of its spectra span the fall of a filter else."""
FEWEST_WINDOWS = 4
"""Least length of maps that strips are cut from, in windows, where the case does not ask for more."""
READ_POINTS = 2**18
"""Points of a path that are read in one go (2 MiB)."""
MOST_POINTS = 2.0**27
"""Points of a path that a measured map is mirrored or repeated along (1 GiB)."""
SAMPLED_LENGTH = 5.0
"""Samples of a synthesised rail are cut from so much of it at least, from where the record starts, m."""
EQUAL = 1e-9
"""Relative difference of loads that are the same."""


@dataclass(frozen=True, eq=False)
class Textures:
    """Everything rough in a case, on the grid of the contact solution."""

    maps: tuple[HeightMap, ...]  # samples for the stiffness; empty where only a line is given
    strips: tuple[HeightMap, ...]  # (n, ny) each, for the filters, as wide as the window
    # (rows, ny), texture of the path with its neighbourhood; None where the path is a line
    path: Strip | None
    line: Array  # (rows,), texture of the path, m, peaks positive
    start: float  # position of the first row, m
    before: int  # rows of the path before the place where the record starts
    beyond: int  # rows beyond its end
    missing_share: float  # of points without a height in the measured file
    origin: str  # where samples and path come from, in one sentence
    # line textures that `line` is the sum of, by the body that bears them, m
    parts: dict[str, Array] = field(default_factory=dict)
    defects: Defects | None = None  # on the path, neither in `line` nor in `path`
    trajectory: Array | None = None  # (rows,), height of the rolling body's centre over them, m
    # whether heights beside the line are a texture of their own, not carried over from lines
    areal: bool = True
    # measured ones that a texture is interpolated between, by the body that bears them, m
    lines: dict[str, tuple[Profile, ...]] = field(default_factory=dict)
    # what the random numbers of each part belong to: parts for which it is the same were drawn alike
    drawn: dict[str, str] = field(default_factory=dict)
    untouched: "Textures | None" = None  # as they were before running-in; None where they still are
    points: "Textures | None" = None  # at the points of the grid, where these are those of covered cells

    def over_cells(self) -> "Textures":
        """The same with heights of covered cells of what is pressed; what is followed as a line stays."""
        maps = tuple(_pressed(each) for each in self.maps)
        strips = maps if self.strips is self.maps else tuple(_pressed(each) for each in self.strips)
        path = None if self.path is None else PressedStrip(self.path)
        return replace(self, maps=maps, strips=strips, path=path, points=self)

    def on_long_cells(self) -> "Textures":
        """The same, with every second row of the path, that where the record starts among them."""
        assert self.path is not None
        first = self.before % 2
        return replace(
            self,
            path=SecondRows(self.path, first),
            line=self.line[first::2],
            start=self.start + first * self.path.spacing[0],
            before=self.before // 2,
            beyond=self.beyond // 2,
        )

    @property
    def averaged(self) -> "Textures":
        """Those that are averaged under a patch: heights at points where they are known, not means of means.

        What has run in is known as means alone.
        """
        return self if self.points is None or self.untouched is not None else self.points

    @property
    def rms_slope(self) -> float:
        """Rms slope of the samples on the contact grid."""
        return float(np.sqrt(np.mean([statistics.rms_slope(sample) ** 2 for sample in self.maps])))

    @property
    def recorded(self) -> slice:
        """Rows over which the record runs."""
        return slice(self.before, len(self.line) - self.beyond)

    @property
    def followed(self) -> Array:
        """Line texture with the trajectory over defects, m, peaks positive, shape (rows,)."""
        return self.line if self.trajectory is None else self.line + self.trajectory

    @property
    def surface(self) -> Strip:
        """The path with its defects, shape (rows, ny)."""
        assert self.path is not None
        if self.defects is None:
            return self.path
        spacing, _ = self.path.spacing
        rows = self.rows_along(spacing)
        if self.points is None:
            return raised(self.path, self.defects.heights(rows))
        return raised(self.path, self.defects.mean_heights(rows, spacing))

    def rows_along(self, spacing: float) -> Array:
        """Positions (rows,) along the path, m, of rows of a spacing, m."""
        return self.start + spacing * np.arange(len(self.line), dtype=np.float64)

    def with_defects(self, case: Case, contact: int) -> "Textures":
        """The same with the defects that a case has under a contact, where any of them is on the path."""
        defects = Defects(case, contact)
        spacing = case.contact.spacing
        rows = self.rows_along(spacing)
        if not defects.heights(rows).any():
            return replace(self, defects=None, trajectory=None)
        return replace(self, defects=defects, trajectory=defects.trajectory(rows, spacing))


def textures_of(case: Case) -> Textures:
    """Read or synthesise the textures of a case: what is rolled over, and the first body on it.

    Heights of both add up; those of the body repeat with its circumference, rounded to whole cells, and its
    turn begins where the record starts. Samples and strips are those of the surface, or cut from the path
    before defects are put on it: where the surface has none, and where what rolls is rough itself. What is
    synthesised counts from where the record starts and depends on spectrum and seed alone, see
    `asperity.surfaces.tiles`.
    """
    contact = case.contact
    spacing = case.contact.spacing
    margin = window_cells(case.contact)
    lead = cells_over(-case.rolled_in(-case.settled_time), spacing)
    recorded = cells_over(case.rolled_in(case.rolled_time) + max(case.rolling.offsets), spacing) + 1
    before = margin + lead
    grid = Grid(before + recorded + margin, margin, spacing)
    seeds = [int(s) for s in np.random.SeedSequence(case.seed).generate_state(contact.samples + 3)]
    own = seeds[3:] if case.surface.IN_STRIPS else seeds[1:-2]
    maps, strips, missing, sampled = _samples(case, own)
    over = _path(case, grid, maps, seeds[0], lead)
    turn = _turn(case, 0, grid, seeds[1])
    strip = turning(over.strip, turn.heights, -before) if turn.heights.any() else over.strip
    is_line = case.surface.has_line
    if not is_line and (not maps or turn.heights.any()):
        maps = strips = _cut(case, strip, before)
        sampled = f"{count_of(len(strips), 'sample')} cut from the path"
    line = middle_line(over.strip)  # of a measured one, the run may end before the grid
    waves = _corrugation(case, len(line), before, recorded, seeds[2])
    drawn = {"surface": over.draw, case.ROLLING: turn.draw, "corrugation": waves.draw}
    around = turn.heights[:, turn.heights.shape[1] // 2]
    along = np.arange(len(line)) - before
    parts = {"rail": line + waves.heights, "wheel": around[along % len(around)]}
    lines = {name: body.lines for name, body in (("rail", over), ("wheel", turn)) if body.lines}
    origins = (
        sampled,
        f"path: {over.origin}",
        f"{case.ROLLING}: {turn.origin}" * bool(turn.origin),
        waves.told,
    )
    path = raised(strip, waves.heights) if waves.heights.any() else strip
    textures = Textures(
        maps,
        strips,
        None if is_line else path,
        parts["rail"] + parts["wheel"],
        case.record_start - before * spacing,
        before,
        margin,
        missing,
        "; ".join(filter(None, origins)),
        parts,
        areal=is_line or ((over.areal or turn.areal) and not lines),
        lines=lines,
        drawn={name: draw for name, draw in drawn.items() if draw},
    )
    return textures.with_defects(case, 0)


class _Corrugation(NamedTuple):
    """Corrugation along the path: its heights (rows,), m, how it is drawn, and its rms in words."""

    heights: Array
    draw: str = ""
    told: str = ""


def _corrugation(case: Case, rows: int, before: int, recorded: int, seed: int) -> _Corrugation:
    """Corrugation of a case over so many cells, of which the record begins after some."""
    keys = case.surface
    wave = keys.corrugation_wavelength
    if keys.corrugation is None or wave is None:
        return _Corrugation(np.zeros(rows))
    width = keys.corrugation_bandwidth
    how: dict[str, Any] = {"bandwidth": width, "seed": seed, "before": before}
    found = corrugation(rows, case.contact.spacing, wavelength=wave, amplitude=keys.corrugation, **how)
    if width is None:
        return _Corrugation(found.heights)
    here = rounded(1e6 * float(found.heights[before : before + recorded].std()))
    stated = rounded(1e6 * keys.corrugation / math.sqrt(2.0))
    told = f"corrugation: {here} µm rms over this record, {stated} µm in the long run"
    return _Corrugation(found.heights, f"{wave:.6g} m, {width:g} octaves, seed {seed}", told)


def _pressed(sample: HeightMap) -> HeightMap:
    return replace(sample, heights=pressed_heights(sample.heights))


def other_contacts(case: Case, loads: Array) -> tuple[list[int], list[tuple[int, float]]]:
    """Which of the contacts differ from the first: for each, which one it equals; and those that differ.

    Loads (c,), N. Zero stands for the first contact, k for the k-th of the others: whose texture it bears,
    see `textures_under`, and its load, N.
    """
    rolling = case.rolling
    which = list[int]()
    known = [(0, float(loads[0]))]
    for contact, load in enumerate(loads):
        flats = rolling.flat is not None and {contact + 1, 1} & set(rolling.flat_contacts)
        texture = contact if rolling.has_own_texture or flats else 0
        alike = (bearing == texture and math.isclose(at, load, rel_tol=EQUAL) for bearing, at in known)
        which.append(next((k for k, same in enumerate(alike) if same), len(known)))
        if which[-1] == len(known):
            known.append((texture, float(load)))
    return which, known[1:]


def textures_under(case: Case, contact: int, first: Textures) -> Textures:
    """Textures under a contact, from those under the first: the turn of its own body is there."""
    rows = len(first.line)
    before = first.before
    if contact == 0 or not case.rolling.has_own_texture:
        return first.with_defects(case, contact)
    grid = Grid(rows, window_cells(case.contact), case.contact.spacing)
    seed = int(np.random.SeedSequence(case.seed).generate_state(2)[1])
    turns = [_turn(case, each, grid, seed).heights for each in (0, contact)]
    change = turns[1] - turns[0]
    middle = turns[0].shape[1] // 2
    points = first.points
    if points is not None:
        if points.path is not None:
            points = replace(points, path=turning(points.path, change, -before))
        change = pressed_heights(np.pad(change, ((2, 2), (0, 0)), mode="wrap"))[2:-2]
    along = np.arange(rows) - before
    added = (turns[1][:, middle] - turns[0][:, middle])[along % len(change)]
    path = None if first.path is None else turning(first.path, change, -before)
    parts = first.parts | {"wheel": first.parts["wheel"] + added}
    turned = replace(first, path=path, line=first.line + added, parts=parts, points=points)
    return turned.with_defects(case, contact)


def recorded_time(case: Case, textures: Textures) -> float:
    """Time of the record, s: that of the case, or until its line ends."""
    cells = len(textures.line[textures.recorded]) - 1
    if isinstance(case.speed, SpeedCourse):
        room = cells * case.contact.spacing - max(case.rolling.offsets)
        return min(case.rolled_time, case.speed.reached(room))
    pace = case.contact.spacing / case.speed
    ahead = max(case.rolling.offsets) / case.speed
    return min(case.rolled_time, cells * pace - ahead)


def lowest_recorded(case: Case, record: float) -> float:
    """Centre of the lowest one-third octave of a record that is this long, s, in Hz."""
    samples = math.floor(record / case.time_step * (1.0 + 1e-12)) + 1
    return lowest_band(samples, case.time_step)


def warn_of_textures(case: Case, shape: Geometry, textures: Textures) -> None:
    """Warn of a record that holds the start, and of laws and windows that do not see a defect."""
    settling = case.settled_time
    if settling < SETTLED * (1 - 1e-9):
        least = f"{rounded(SETTLED * 1e3)} ms"
        remedy = f"Take a settling of {least} or more{', with room for it' * (case.room is not None)}."
        if case.settling is None:
            remedy = "So that there is time for settling, shorten the duration or start farther along."
        ShortRecordWarning.warn(
            f"the record starts {rounded(settling * 1e3)} ms after rest, less than {least}: its levels hold "
            f"the start. {remedy}"
        )
    if not case.has_defect:
        return
    seen = [law for law in case.laws if spec_of(law).sees_heights]
    if case.laws[0] not in seen:
        OutOfRangeWarning.warn(
            f"{case.laws[0]} follows the path of the {case.ROLLING}'s centre over a flat or a joint, not "
            "their shape: peaks of the force come out up to a quarter too high, and levels above 1.6 kHz up "
            "to 6 dB. Take direct, or table, as the first law."
        )
    length = case.defect_length
    window = case.contact.window
    a = shape.semi_axes[0]
    if seen and length and length + 2 * a > window:
        TruncatedContactWarning.warn(
            f"the flat is {rounded(length * 1e3)} mm long and the contact {rounded(2e3 * a)} mm, together "
            f"more than contact.window = {rounded(window * 1e3)} mm: where the {case.ROLLING} stands on "
            f"the flat's ends, {' and '.join(seen)} cut the contact off. Enlarge the window."
        )


# --- samples and path


def _samples(case: Case, seeds: list[int]) -> tuple[tuple[HeightMap, ...], tuple[HeightMap, ...], float, str]:
    """Samples and strips that the surface section names; none where they are to be cut from the path."""
    surface = case.surface
    contact = case.contact
    if surface.file is not None:
        maps, missing = records.measured_maps(surface, contact.spacing)
        strips, origin = strips_of(maps, contact, seeds)
        measured = f"{count_of(len(maps), 'sample')} measured, {name_of(surface.file)}"
        if surface.direction:
            measured += f", rolled over at {math.degrees(surface.direction):.4g}° to their x axis"
        return maps, strips, missing, f"{measured}; {origin}"
    if surface.rms is not None:
        shape = (strip_rows(contact), window_cells(contact))
        spacing = (contact.spacing, contact.spacing)
        keys = self_affine_keys(surface)
        strips = tuple(synthesis.self_affine(shape, spacing, **keys, seed=seed) for seed in seeds)
        return strips, strips, 0.0, "samples synthesised: self-affine, Gaussian"
    return (), (), 0.0, ""


def _path(case: Case, grid: Grid, maps: tuple[HeightMap, ...], seed: int, lead: int) -> Record:
    """Texture of what is rolled over, all along the path."""
    surface = case.surface
    shape = (grid.rows, grid.lines)
    margin = grid.lines
    before = margin + lead
    if surface.spectrum is not None:
        lateral = surface.lateral
        if lateral is None:
            grid = replace(grid, lines=1)
            lateral = math.inf
        spectrum = surface.spectrum, surface.level
        return records.spectrum_record(*spectrum, grid, lateral=lateral, seed=seed, before=before)
    if surface.line is not None:
        if not surface.has_line:
            return records.lines_across(surface, grid)
        record = replace(grid, rows=grid.rows - lead)
        may_shorten = case.duration is None
        return records.single_line(surface, record, lead, 2 * margin + 2, may_shorten=may_shorten)
    if surface.rms is not None:
        keys = self_affine_keys(surface)
        spacing = (grid.spacing, grid.spacing)
        strip = synthesis.long_self_affine(shape, spacing, **keys, seed=seed, before=before)
        return Record(strip, "self-affine, Gaussian", draw=strip.draw)
    if maps:
        run_in = 0 if surface.IN_STRIPS else lead
        path, origin = path_of(maps, shape, seed, run_in, before, surface.continuation)
        return Record(path, origin, draw=path.draw if isinstance(path, LongStrip) else "")
    return Record(Rows(np.zeros(shape), (grid.spacing, grid.spacing)), "smooth", areal=False)


def _cut(case: Case, strip: Strip, before: int) -> tuple[HeightMap, ...]:
    """Cut samples from the path; of a synthesised one from a stretch that depends on no duration or speed."""
    contact = case.contact
    lower = strip.strip if isinstance(strip, Raised) else strip
    if not isinstance(lower, LongStrip):
        return cut_from(strip, contact, case.rolled_time)
    rows = contact.samples * strip_rows(contact)
    if case.surface.IN_STRIPS:
        rows = max(math.ceil(SAMPLED_LENGTH / contact.spacing), rows)
    longer: Strip = replace(lower, shape=(before + rows, lower.shape[1]))
    if isinstance(strip, Raised):
        longer = Raised(longer, strip.added)
    return cut_from(longer, contact, case.rolled_time, first=before)


def _turn(case: Case, contact: int, grid: Grid, seed: int) -> Record:
    """One turn of what rolls on a contact, closed on itself, (rows, lines or 1); `seed` is the first's."""
    rolling = case.rolling
    surface = case.surface
    turn = replace(grid, rows=round(rolling.circumference / grid.spacing))
    if rolling.line is not None:
        if rolling.line_distance is not None or (surface.IN_STRIPS and len(rolling.offsets) == 1):
            return records.lines_around(rolling, case.ROLLING, turn)
        return records.line_around(rolling, case.ROLLING, contact, turn)
    if rolling.roughness is None:
        return Record(Rows(np.zeros((turn.rows, 1))), "", areal=False)
    if contact or not surface.IN_STRIPS:
        seed = int(np.random.SeedSequence([case.seed, 1, contact]).generate_state(1)[0])
    made_by = partial(records.spectrum_around, rolling.roughness, rolling.roughness_level, seed=seed)
    if surface.IN_STRIPS:
        lateral = math.inf if surface.lateral is None else surface.lateral
        return made_by(turn, rolling.circumference, lateral=lateral)
    made = made_by(replace(turn, lines=2), rolling.circumference, lateral=math.inf)  # lines that are alike
    return replace(made, strip=Rows(made.heights[:, :1]))


def strip_rows(contact: ContactKeys) -> int:
    """Rows of the contact grid in a strip for the filters."""
    wanted = contact.sample_length
    return STRIP_WINDOWS * window_cells(contact) if wanted is None else math.ceil(wanted / contact.spacing)


def strips_of(
    maps: tuple[HeightMap, ...], contact: ContactKeys, seeds: list[int]
) -> tuple[tuple[HeightMap, ...], str]:
    """Take strips for the filters from measured maps, one for each seed, and say how.

    Cut from the maps where these are long enough, else synthesised in their likeness.
    """
    rows = strip_rows(contact)
    ny = window_cells(contact)
    longest, narrowest = (min(sizes) for sizes in zip(*(m.shape for m in maps), strict=True))
    if contact.sample_length is None and longest >= FEWEST_WINDOWS * ny:
        rows = min(rows, longest)
    if longest < rows or narrowest < ny:
        strips = tuple(levelling.level(synthesis.from_map(maps, (rows, ny), seed)) for seed in seeds)
        return strips, "filter strips synthesised in their likeness"
    cut = list[HeightMap]()
    of_each = math.ceil(len(seeds) / len(maps))
    for i in range(len(seeds)):
        heights = maps[i % len(maps)].heights
        first = round((i // len(maps) + 0.5) / of_each * (heights.shape[1] - ny))
        cut.append(
            levelling.level(HeightMap(heights[:rows, first : first + ny], maps[0].spacing, maps[0].source))
        )
    return tuple(cut), "filter strips cut from them"


def cut_from(path: Strip, contact: ContactKeys, duration: float, *, first: int = 0) -> tuple[HeightMap, ...]:
    """Cut strips for stiffness and filters from a path, spread evenly; one flat one if all are.

    The path of a run of a duration, s, from row `first` on.
    """
    rows = strip_rows(contact)
    length = path.shape[0] - first
    if length < rows:
        raise InputError(
            "duration",
            f"{duration:g} s, a path of {length * contact.spacing:.4g} m with its run-in",
            f"at least {rows * contact.spacing:.4g} m, the strips from which filters are estimated",
            "Roll longer, or lower contact.sample_length.",
        )
    count = contact.samples
    spacing = (contact.spacing, contact.spacing)
    firsts = first + np.linspace(0, length - rows, count + 2)[1:-1].round().astype(int)
    cut = in_order(lambda begin: path.rows(begin, begin + rows), firsts.tolist())
    found = tuple(levelling.level(HeightMap(heights, spacing)) for heights in cut)
    return found if any(strip.heights.any() for strip in found) else found[:1]


def path_of(
    maps: tuple[HeightMap, ...],
    shape: tuple[int, int],
    seed: int,
    run_in: int,
    before: int,
    continuation: str | None,
) -> tuple[Strip, str]:
    """Take the path (rows, ny) from measured maps, and say how.

    Cut from the first map where it is large enough, but for the run-in, whose rows are mirrored where it is
    too short. Else the first map is mirrored, or repeated, from behind the run-in on, where the case asks for
    that `continuation`; or the path is synthesised in their likeness, the same at every speed from the row
    `before` on, where the record starts.
    """
    rows, ny = shape
    first = maps[0]
    middle = max((first.shape[1] - ny) // 2, 0)
    heights = first.heights[:rows, middle : middle + ny]
    heights = heights - heights.mean()
    long = first.shape[0] >= rows - run_in
    wide = first.shape[1] >= ny
    if not (long and wide):
        if continuation not in ("mirror", "repeat"):
            like = synthesis.long_strip_like(maps, shape, seed, before=before)
            return like, "path synthesised in their likeness"
        if not wide or rows * ny > MOST_POINTS:
            narrow = f"{first.size[1] * 1e3:.4g} mm across" * (not wide)
            allowed = f"a map as wide as the window, and paths of at most {rounded(MOST_POINTS, 2)} points"
            received = narrow or f"{rounded(rows * ny, 2)} points"
            raise InputError("surface.continuation", received, allowed, "Leave it out, or roll shorter.")
    fade = min(ny, len(heights) // 2)  # a repeated one closes over a window
    laid, how = records.behind_run_in(heights, rows, run_in, continuation, fade)
    return HeightMap(laid, first.spacing, first.source), f"path cut from the first{how}"


def middle_line(strip: Strip) -> Array:
    """Take the line (rows,) in the middle of a strip, m: of a drawn one without what lies beside it.

    Pieces are read on threads; their number changes no digit.
    """
    if isinstance(strip, LongStrip):
        strip = replace(strip, shape=(strip.shape[0], 1))
    rows, ny = strip.shape

    def middle_of(first: int) -> Array:
        return strip.rows(first, min(first + piece, rows))[:, ny // 2].copy()

    piece = min(max(1, READ_POINTS // ny), PIECE)
    return np.concatenate(list(in_order(middle_of, range(0, rows, piece))))


def self_affine_keys(surface: Surface) -> dict[str, Any]:
    """What a section says of the self-affine texture that is drawn, as `SelfAffine` takes it."""
    names = ("rms", "hurst", "anisotropy", "lay", "longest", "shortest")
    return {name: getattr(surface, name) for name in names}
