"""What a run of bodies on a structure will compute, and what of it is doubtful, before it is run."""

from asperity.progress import Progress
from asperity.scenarios.coverage import coverages
from asperity.scenarios.law_choice import LawChoice, advised_law, law_choice
from asperity.scenarios.preparing import Plan, ScanSize, Work, expect
from asperity.scenarios.reducing import STATES
from asperity.scenarios.scene import PreparedCase
from asperity.scenes.roundness import planned_roundness
from asperity.scenes.start_of_record import start_foreseen
from asperity.scenes.track import doubt_sound, planned_track
from asperity.scenes.validity import foreseen
from asperity.store import Store
from asperity.written_numbers import between, count_of, rounded


def planned_scene(prepared: PreparedCase, progress: Progress) -> Plan:
    """Plan a case: a few contacts of its samples are solved for that."""
    work = expect(prepared, progress)
    choice = law_choice(prepared)
    faults = [] if work.tried is None else foreseen(prepared, work.tried, choice)
    faults += start_foreseen(prepared)
    doubt_sound(prepared)
    return Plan(plan(prepared, work, choice), work, faults)


def plan(prepared: PreparedCase, work: Work, choice: LawChoice | None = None) -> list[tuple[str, str]]:
    """List what will be computed and how much work it is, from `asperity.scenarios.preparing.expect`."""
    case = prepared.case
    nx, ny = prepared.shape.body.shape
    contact = case.contact
    settling = case.settled_time
    states = STATES if contact.approaches is None else len(contact.approaches)
    first, last = case.rolled_range
    points = round((last - first) / contact.spacing) + 1
    offsets = prepared.scene.offsets
    places = f"{between(rounded(min(offsets)), rounded(max(offsets)))} m ahead of the position"
    run_in = f", and {settling:g} s before it" if settling else ""
    rows = [
        ("textures", prepared.textures.origin),
        *((f"bands of {each.key}", each.at(case.speed)) for each in coverages(case, prepared.textures)),
        ("path", f"{last - first:g} m from {first:g} m, {points} points {contact.spacing * 1e6:g} µm apart"),
        (
            "time",
            f"{case.rolled_time:g} s{run_in}, {work.steps} steps of {rounded(case.time_step * 1e6, 4)} µs",
        ),
        *([("contacts", f"{len(offsets)}, {places}")] if len(offsets) > 1 else []),
        *planned_track(prepared),
        ("laws", ", ".join(case.laws)),
        ("contact", f"{nx} × {ny} cells, {count_of(contact.samples, 'sample')}, {states} approaches"),
    ]
    if prepared.rims:
        rows.append(("cells at rims", f"{prepared.rim_cells}: {prepared.rims}"))
    if work.tried is not None:  # a sample
        share = f"about {100 * work.tried.pressed.area_ratio:.0f} % of the area of smooth bodies"
        rows.append(("real contact", share))
    rows += [*planned_roundness(prepared), *advised_law(prepared, choice)]
    scan = work.scans.get("path")
    for name, count in work.solutions.items():
        how = "up to about" if scan and scan.farther and name == "scan for the path" else "at most"
        rows.append((f"contact solutions, {name}", f"{how} {count}"))
    if scan:
        rows.append(("scan of the path", described_scan(scan)))
    return [*rows, ("work", work.told)]


def described_scan(scan: ScanSize) -> str:
    """Describe the scan of a path in a sentence: its size, disk use, and what an interruption costs."""
    root = Store().root
    size = f"{scan.bytes / 2**20:.1f} MiB"
    return (
        f"{scan.positions} positions × {scan.states} approaches, "
        f"about {scan.solutions} solutions, more where the motion goes farther, {size} in {root}; "
        "if interrupted or killed, it goes on after its last finished block"
    )
