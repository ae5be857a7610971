"""Vectors of numbers as values of compiled code: one instruction works on all lanes.

Compilers do not find these vectors by themselves in a butterfly that reads and writes many rows, because the
rows might overlap. A vector holds eight numbers; processors with shorter registers use several.
"""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable

LANES = 8
"""Numbers in a vector."""


def _compiled(generator: Any) -> Any:
    """Make a function of compiled code: its first parameter is filled in."""
    return intrinsic(generator)


class Lanes(types.Type):
    """Numba's type of a vector."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


VECTOR = ir.VectorType(ir.DoubleType(), LANES)
KIND = Lanes()


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Lanes) -> None:
        super().__init__(manager, kind, VECTOR)


def _pointer(context: Any, builder: Any, kind: Any, value: Any, index: Any) -> Any:
    """Pointer to the vector that starts at an element of a contiguous array, counted flat."""
    data = context.make_array(kind)(context, builder, value).data
    return builder.bitcast(builder.gep(data, [index]), ir.PointerType(VECTOR))


def _broadcast(builder: Any, scalar: Any) -> Any:
    single = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), scalar, cgutils.int32_t(0))
    return builder.shuffle_vector(single, single, _mask([0] * LANES))


def _mask(lanes: list[int]) -> Any:
    return ir.Constant(ir.VectorType(ir.IntType(32), LANES), lanes)


@_compiled
def load(typing: Any, array: Any, index: Any) -> Any:
    """Vector of the elements from `index` on of a flat contiguous array."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_pointer(context, builder, array, *arguments), align=8)

    return KIND(array, types.intp), generate


@_compiled
def store(typing: Any, array: Any, index: Any, vector: Any) -> Any:
    """Write a vector to the elements from `index` on of a flat contiguous array."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[2], _pointer(context, builder, array, *arguments[:2]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), generate


def _operation(symbol: Any, instruction: str) -> None:
    """Give vectors an operator, between themselves and with a number on the left."""

    @type_callable(symbol)
    def typed(context: Any) -> Any:
        def typer(left: Any, right: Any) -> Any:
            return KIND if right == KIND and left in (KIND, types.float64) else None

        return typer

    @lower_builtin(symbol, Lanes, Lanes)
    @lower_builtin(symbol, types.float64, Lanes)
    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        left, right = arguments
        if not isinstance(signature.args[0], Lanes):
            left = _broadcast(builder, left)
        # "contract": a product and a sum may become one instruction
        return getattr(builder, instruction)(left, right, flags=("contract",))


_operation(operator.add, "fadd")
_operation(operator.sub, "fsub")
_operation(operator.mul, "fmul")


@_compiled
def transpose(typing: Any, source: Any, start: Any, stride: Any, target: Any, first: Any, step: Any) -> Any:
    """Transpose a square of numbers: its rows lie `stride` apart in the source, `step` in the target."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        read, start_, stride_, written, first_, step_ = arguments
        rows = []
        for i in range(LANES):
            index = builder.add(start_, builder.mul(stride_, stride_.type(i)))
            rows.append(builder.load(_pointer(context, builder, source, read, index), align=8))
        for i, row in enumerate(_transposed(builder, rows)):
            index = builder.add(first_, builder.mul(step_, step_.type(i)))
            builder.store(row, _pointer(context, builder, target, written, index), align=8)
        return context.get_dummy_value()

    n = types.intp
    return types.void(source, n, n, target, n, n), generate


def _transposed(builder: Any, rows: list[Any]) -> list[Any]:
    """Swap blocks off the diagonal, from the largest to the smallest."""
    block = LANES // 2
    while block:
        lower = [lane if not lane & block else LANES + lane - block for lane in range(LANES)]
        upper = [lane + block if not lane & block else LANES + lane for lane in range(LANES)]
        masks = _mask(lower), _mask(upper)
        for i in range(LANES):
            if not i & block:
                pair = rows[i], rows[i + block]
                rows[i], rows[i + block] = (builder.shuffle_vector(*pair, mask) for mask in masks)
        block //= 2
    return rows
