"""What helps: what named changes of a case do to what radiates, as a table and in words."""

import re
from typing import Any

import numpy as np
import xarray

from asperity.arguments import Array
from asperity.reporting import data, headline, tables
from asperity.scenes import schema
from asperity.scenes.figures.sources import WHOLE, Sources

HEARD = 0.05
"""Change of a level, dB, below which none is told."""


class Effects:
    """Effects of variants on the parts of what is heard, from `asperity.effects`.

    By variant (v) and part (p), the whole first: `level` of the case as it is and its `deviation` by chance
    (p,), `effect` and `error`, half of its confidence interval, dB (v, p), and why a variant was `left_out`.
    What is unknown goes; any other level has one part without a name.
    """

    def __init__(self, found: xarray.Dataset) -> None:
        level = found[schema.EFFECT_LEVEL.name]
        chance = found.get(schema.EFFECT_LEVEL_DEVIATION.name)
        names = list(map(str, found[level.dims[0]].values)) if level.dims else [""]
        chance = level * 0.0 if chance is None else chance
        named = (level, chance, found[schema.EFFECT.name], found[schema.EFFECT_ERROR.name])
        numbers = [np.atleast_1d(each.values).reshape(-1, len(names)) for each in named]
        known = np.flatnonzero(np.isfinite(numbers[0][0])).tolist()
        order = sorted(known, key=lambda n: names[n] != WHOLE)  # the whole first
        (self.level,), (self.deviation,), self.effect, self.error = (each[:, order] for each in numbers)
        self.parts = [names[n] for n in order]
        self.variants = list(map(str, found[schema.EFFECT_VARIANT.name].values))
        self.left_out = list(map(str, found[schema.LEFT_OUT.name].values))
        self.what = str(level.attrs["long_name"])
        self.units = data.written_units(str(level.attrs["units"]))
        reason = str(level.attrs.get("wheel", "computed"))
        self.silent = "" if reason == "computed" else f"The {WHOLE} is without the wheel: {reason}."
        self.law = str(found.attrs[schema.EFFECT_LAW.name])
        self.seeds = int(found.attrs[schema.EFFECT_SEEDS.name])

    @property
    def in_words(self) -> dict[str, str]:
        """What each variant does: ``"Rail 2.1 dB down, sleepers 1.0 up."``"""
        return {
            name: f"Left out: {said_once(why)}." if why else self._words(effect, error)
            for name, why, effect, error in zip(
                self.variants, self.left_out, self.effect, self.error, strict=True
            )
        }

    @property
    def best(self) -> str:
        """What helps most; empty where nothing surely helps."""
        helps = self.effect[0, 0] < -np.nan_to_num(self.error[0, 0])
        how = (
            f"{data.signed(self.effect[0, 0])} {'dB(A)' if 'dB(A)' in self.units else 'dB'}{self._as_much()}"
        )
        words = f"Helps most: {self.variants[0]}, {how}. {self.in_words[self.variants[0]]} {self.silent}"
        return words.rstrip() if helps else ""

    def _as_much(self) -> str:
        """Variants that help no less than the best one but by chance; empty where it is alone."""
        (effect, *others) = self.effect[:, 0]
        (error, *of_others) = self.error[:, 0]
        told = [
            f"{name}, {data.signed(other)}"
            for name, other, own in zip(self.variants[1:], others, of_others, strict=True)
            if other < -own and other - effect <= np.hypot(error, own)
        ]
        return f"; as much but for chance: {'; '.join(told)}" if told else ""

    def _words(self, effect: Array, error: Array) -> str:
        own = np.array([part != WHOLE for part in self.parts])
        sure = own & (np.abs(effect) >= HEARD) & ~(np.abs(effect) <= error)
        order = sorted(np.flatnonzero(sure).tolist(), key=lambda n: -abs(effect[n]))
        told = [
            f"{self.parts[n]} {abs(effect[n]):.1f}{'' if k else ' dB'} {'down' if effect[n] < 0.0 else 'up'}"
            for k, n in enumerate(order)
        ]
        sentence = ", ".join(told).strip() or "no change that is sure"
        before = self.loudest()
        after = self.loudest(effect)
        return f"{sentence[:1].upper()}{sentence[1:]}{f'; loudest then: {after}' if after != before else ''}."

    def loudest(self, effect: Array | float = 0.0) -> str:
        """The loudest body, or those about equal, with an effect; nothing where parts are not told apart."""
        level = (self.level + np.nan_to_num(effect)).tolist()
        parts = {part: each for part, each in zip(self.parts, level, strict=True) if part not in ("", WHOLE)}
        chance = dict(zip(self.parts, np.nan_to_num(self.deviation).tolist(), strict=True))
        names = Sources(0.0, parts, chance).loudest
        return (
            names[0] if len(names) < 2 and names else f"{' and '.join(names)}, about equal" if names else ""
        )

    @property
    def document(self) -> dict[str, Any]:
        """What programs are told: levels as the case is, and of each change the differences, dB."""
        words = self.in_words
        changes = [
            {
                "change": name,
                "effect": dict(zip(self.parts, effect, strict=True)),
                "error": dict(zip(self.parts, error, strict=True)),
                "left_out": why or None,
                "in_words": words[name],
            }
            for name, why, effect, error in zip(
                self.variants, self.left_out, self.effect, self.error, strict=True
            )
        ]
        level = dict(zip(self.parts, self.level, strict=True))
        return {"law": self.law, "seeds": self.seeds, "units": self.units, "level": level, "changes": changes}


def said_once(reasons: str) -> str:
    """Reasons of several keys, each once: what two keys lack for one reason is told as one."""
    told = (each.strip(" .-") for each in re.split(r";|\n|\. (?=[A-Z])", reasons))
    return "; ".join(dict.fromkeys(filter(None, told)))


def effects_table(of: Effects) -> tables.ReportTable:
    """What each variant does, the quietest first, in numbers and in words."""
    base = f"as it is, mean of {of.seeds} seeds" if of.seeds > 1 else "as it is"
    columns = {"change": tables.text_cells([base, *of.variants], "name")}
    for p, part in enumerate(of.parts):
        cells = [_cell(*pair) for pair in zip(of.effect[:, p], of.error[:, p], strict=True)]
        columns[part or "level"] = [tables.Cell(f"{of.level[p]:.1f}", "number"), *cells]
    first = f"Loudest: {of.loudest()}." if of.loudest() else ""
    columns["in words"] = tables.text_cells([first, *of.in_words.values()])
    sure = ", of one texture, the same in all runs: with several seeds it is known how sure a difference is."
    if of.seeds > 1:
        sure = f": means over {of.seeds} seeds, each within one texture, ± confidence interval of 95 %."
    note = f"{of.what}, by {of.law}, as it is, in {of.units}; below, differences in dB{sure}"
    note += " In grey and in brackets: not surely any change." * (of.seeds > 1)
    note += f" {of.silent}" if of.silent else ""
    return tables.table("effects", "What each change does, the quietest first", columns, note)


def _cell(effect: float, error: float) -> tables.Cell:
    if not np.isfinite(effect):
        return tables.Cell("–", "number")
    text = data.signed(effect) + (f" ± {error:.1f}" if np.isfinite(error) else "")
    return tables.Cell(f"({text})", "number faint") if abs(effect) <= error else tables.Cell(text, "number")


# --- in the report of a run


def effects_of_run(tree: xarray.DataTree) -> Effects | None:
    """Effects that a run holds, if it was asked."""
    return (
        Effects(tree[schema.EFFECT.group].to_dataset()) if data.present(tree, schema.EFFECT_LEVEL) else None
    )


def what_helps_table(tree: xarray.DataTree) -> tables.ReportTable | None:
    """What each change does, if it was asked."""
    effects = effects_of_run(tree)
    return None if effects is None else effects_table(effects)


def what_helps_answers(tree: xarray.DataTree) -> headline.Answers | None:
    """What helps most, if it was asked."""
    effects = effects_of_run(tree)
    return None if effects is None else headline.Answers(more=effects.best)
