"""A ball bearing made finer setting by setting: time step, run-in and lobes of its outer ring."""

from xarray import DataTree

from asperity.case.ball_bearing import BearingUnderLoad
from asperity.scenarios.prepared_bearing import PreparedBearing
from asperity.scenarios.refining import Setting, Way
from asperity.schema.convergence import PATH_LENGTH
from asperity.units import written
from asperity.written_numbers import rounded

SHORTEST = 0.05
"""Run-in of a bearing that had none, s."""
MORE_LOBES = 2
"""By which a ring that bends is made softer."""
MOST_LOBES = 20
"""That a ring is computed with."""
BY_CONTACTS = "its cells follow from the contacts, the faults and the roughness"


def settings_of_bearing(prepared: PreparedBearing, result: DataTree) -> list[Setting]:
    """All settings of a bearing. Its record begins at the same place however long the run-in is."""
    case = prepared.case
    shorter = 0.5 * case.step
    steps = Way(f"{_time(case.step)} → {_time(shorter)}", {"time_step": shorter})
    half = Way(f"{rounded(case.duration)} s → its first half")
    return [
        Setting("grid", (), BY_CONTACTS),
        Setting("time step", (steps,)),
        _run_in(case),
        _lobes(case),
        Setting(PATH_LENGTH, (half,)),
    ]


def _run_in(case: BearingUnderLoad) -> Setting:
    """How long it turns before the record; a cage that slips would have slipped otherwise until then."""
    if max(case.cage_slip) > 0.0:
        return Setting("run-in", (), "the cage slips by chance, anew in another run-in")
    longer = max(2.0 * case.settling, SHORTEST)
    words = f"{written(case.settling, 's', 'ms')} → {written(longer, 's', 'ms')}"
    return Setting("run-in", (Way(words, {"settling": longer}),))


def _lobes(case: BearingUnderLoad) -> Setting:
    """In how many lobes the outer ring bends."""
    lobes = case.housing.lobes
    if lobes is None:
        return Setting("lobes", (), "the outer ring is rigid, or bends by given modes")
    if lobes == MOST_LOBES:
        return Setting("lobes", (), f"the ring bends in {lobes} lobes, the most there are")
    more = min(lobes + MORE_LOBES, MOST_LOBES)
    return Setting("lobes", (Way(f"{lobes} → {more}", {"housing.lobes": more}),))


def _time(seconds: float) -> str:
    return f"{rounded(1e6 * seconds, 4)} µs"
