"""The diagnosis in a sentence: the speed first where it is not confirmed, then the part, how sure, how
resolved."""

import math

from asperity.diagnostics.diagnosis import RESOLVED, Diagnosis
from asperity.diagnostics.hypotheses import Hypothesis
from asperity.diagnostics.tacho import Tacho
from asperity.written_numbers import capital, rounded

ASKED = "is the speed or the sampling rate wrong?"
ONCE_IN_A_TURN = "Blows come with the turns of the shaft, as of a rub; fainter ones may hide behind them."
TWICE_IN_A_TURN = "A shaft at {} that rubs would have these lines, too."
OF_BALLS = "How sure rests on records of ball bearings."


def diagnosis_sentence(found: Diagnosis, known: str | None = None) -> str:
    """A diagnosis in words, of one line.

    Parameters
    ----------
    found : Diagnosis
        As `asperity.diagnostics.diagnose` finds it.
    known : {"outer", "inner", "ball"}, optional
        Part that is known to have a fault: where the record holds no sign of it, that is said.

    Returns
    -------
    str
        What is not confirmed of the speed comes first; each verdict has its confidence.
    """
    words = [_beyond_belief(found)] if found.beyond_belief else []
    if found.tones_alone:
        words.append(_tones_alone(found))
    else:
        words += [_too_short(found)] if found.undecided else [*_of_speed(found), _of_parts(found)]
    named = {each.part for each in (*found.parts, *found.alike)}
    if known and known not in named:
        words.append(
            f"Of the fault of the {found.name(known)} that is known to be there, the record holds no sign."
        )
    if found.twice_in_a_turn:
        words.append(TWICE_IN_A_TURN.format(turns(2.0 * found.told)))
    if found.mains:
        words.append(f"What the mains feed has lines at {found.mains:.0f} Hz, too.")
    if found.element != "ball":
        words.append(OF_BALLS)
    return " ".join([*words, *found.doubts])


def turns(speed: float) -> str:
    """A speed, Hz, in both units."""
    return f"{rounded(speed, 4)} Hz ({rounded(60.0 * speed, 4)} 1/min)"


def faint_lines(found: Diagnosis) -> str:
    """What is said of lines that no fault is named for; empty where there are none."""
    if found.faint is None:
        return ""
    tone = _hertz(found.faint.blows, found)
    depth = 100.0 * found.faint.depth
    why = "too little for a fault"
    if found.faint.part == "outer":
        why = f"a sound bearing has them, too, as its {found.element}s pass through the load"
    where = f"Faint lines at {tone}, where the {found.name(found.faint.part)} has them"
    return f"{where}, move the envelope by {depth:.0f} %: {why}."


def _hertz(frequency: float, found: Diagnosis) -> str:
    """A frequency with as many digits as the record resolves."""
    return f"{frequency:.{max(0, math.ceil(-math.log10(found.resolution)))}f} Hz"


def _otherwise(found: Diagnosis) -> str:
    """What else lines of parts are, of a shaft at another speed."""
    other = found.otherwise
    if other is None:
        return ""
    return f"; they fit the {found.name(other.part)} of a shaft at {turns(other.speed)} better"


def _nearest(found: Diagnosis) -> str:
    """What blows of no part would be of a shaft at a speed near the one told."""
    near = found.nearest
    if near is None:
        return ""
    return f" Of a shaft at {turns(near.speed)} they would be those of the {found.name(near.part)}."


def _half(each: Hypothesis) -> str:
    """What is said of blows that are unlike in turn."""
    return " and at half of it (one ring strikes harder)" if each.every > 1 else ""


def _tones_alone(found: Diagnosis) -> str:
    """What is said of a record of a few tones."""
    at = " and ".join(_hertz(each, found) for each in found.tones_alone)
    lines = f"tone{'s' * (len(found.tones_alone) > 1)} at {at}"
    beside = "beside which it has no more than what rounding leaves"
    return f"The record holds the {lines} alone, {beside}: it says nothing of rings and {found.element}s."


def _beyond_belief(found: Diagnosis) -> str:
    """What is said of a speed at which hardly any such bearing runs."""
    asked = "is the speed in 1/min?" if found.tacho is None else found.tacho.question
    return f"Hardly any bearing of this size turns at {turns(found.told)}, {_by(found)}: {asked}"


def _by(found: Diagnosis) -> str:
    """What the speed is by."""
    return "as told" if found.tacho is None else "as the tacho says"


def _too_short(found: Diagnosis) -> str:
    """What is said of a record in which no part is found, nor could be."""
    held = (
        f"The record of {rounded(found.record.duration)} s holds {rounded(found.turns, 2)} turns of the shaft"
    )
    needed = f"{RESOLVED:.0f} turns, {rounded(RESOLVED / found.told, 2)} s, or more"
    by = "" if found.tacho is None else f", {_by(found)}"
    return f"{held} at {turns(found.told)}{by}: too short to tell whether there is a fault. Record {needed}."


def _of_speed(found: Diagnosis) -> list[str]:
    """What is said of the speed where its lines are not where it says, and of one by a tacho."""
    if found.tacho is not None:
        return _of_tacho(found, found.tacho)
    if found.speed_is == "contradicted":
        where = f"not at {turns(found.told)}, as told, but at {turns(found.speed)}"
        return [f"The line of the shaft is {where}: {ASKED}"]
    if found.speed_is == "confirmed":
        here = f"Lines of the shaft are at {turns(found.speed)}"
        return [f"{here}, but do not explain all blows: {ASKED}"] if found.blows else []
    if found.turns < RESOLVED:
        needed = f"which takes {rounded(RESOLVED / found.told, 2)} s"
        short = (
            f"The record of {rounded(found.record.duration)} s, {rounded(found.turns, 2)} turns, is too short"
        )
        line = f"for the line of the shaft at {turns(found.told)}, {needed}"
        return [f"{short} {line}: the speed is not confirmed."]
    if found.others and not found.blows:
        return [f"Lines of the shaft are at {turns(found.told)}; {_others(found)} would have them, too."]
    missed = f"The line of the shaft is not found at {turns(found.told)}"
    if found.blows:
        return [f"{missed}: {ASKED}"]
    return [f"{missed}: the speed is not confirmed."]


def _of_tacho(found: Diagnosis, tacho: Tacho) -> list[str]:
    """What is said of a speed by a tacho, and on which condition where lines do not confirm it."""
    if found.speed_is == "contradicted":
        where = f"not at {turns(found.told)}, {_by(found)}, but at {turns(found.speed)}"
        pulses = tacho.otherwise(found.speed / found.told)
        return [f"The line of the shaft is {where}{pulses}: {tacho.question}"]
    here = f"By the tacho the shaft turns at {turns(found.told)} on average"
    if found.blows:
        lines = "its lines are there, but do not explain all blows"
        lines = lines if found.speed_is == "confirmed" else "its line is not found there"
        return [f"{here}; {lines}: {tacho.question}"]
    if found.speed_is == "confirmed" or not tacho.condition:
        return [f"{here}."]
    too = f"; {_others(found)} would have its lines, too" if found.others else ""
    return [f"{here}, {tacho.condition}{too}."]


def _others(found: Diagnosis) -> str:
    """The two nearest shafts that have the same lines."""
    nearest = sorted(found.others, key=lambda each: abs(math.log(each / found.told)))[:2]
    return f"a shaft at {' or '.join(turns(each) for each in sorted(nearest))}"


def _condition(found: Diagnosis) -> str:
    """On which condition lines at a speed that is not confirmed are those of a part."""
    if found.tacho is None:
        return "if it is right"
    return "if it does" if found.tacho.pulses else ""


def _of_parts(found: Diagnosis) -> str:
    """What is said of the parts, and how sure that is."""
    resolved = f"resolved to {rounded(found.resolution, 2)} Hz"
    sure = f"{100.0 * found.confidence:.0f} % sure{', by made signals' * found.by_made_signals}"
    condition = _condition(found)
    if found.alike:
        both = " and the ".join(found.name(each.part) for each in (found.parts[0], *found.alike))
        lines = f"Lines at {_hertz(found.parts[0].blows, found)}, {resolved}"
        likelier = f"the {found.name(found.parts[0].part)} is likelier"
        return f"{lines}, agree with more than one part, the {both}; {likelier}: {sure}."
    if found.parts:
        there = " and ".join(
            f"lines of the {found.name(each.part)} at {_hertz(each.blows, found)}{_half(each)}"
            for each in found.parts
        )
        here = capital(f"{condition}, there are".removeprefix(", "))
        begin = {
            "confirmed": "There are",
            "measured": here,
            "unconfirmed": here,
            "contradicted": "At that speed there are",
        }[found.speed_is]
        foreign = ", or of another bearing" * (found.may_be_foreign and found.otherwise is None)
        return f"{begin} {there}, {resolved}{foreign}{_otherwise(found)}: {sure}."
    if found.blows:
        blows = (
            f"Blows at {_hertz(found.blows, found)}, {resolved}, are those of no part at this speed: {sure}."
        )
        return f"{blows}{_nearest(found)}"
    condition = "" if found.speed_is == "confirmed" or found.others else f" {condition}".rstrip()
    parts = f"rings or {found.element}s"
    hidden = f"{ONCE_IN_A_TURN} " if found.once_in_a_turn else ""
    return f"{hidden}No lines of {parts} stand out: no sign of a fault{condition}, {sure} that there is none."
