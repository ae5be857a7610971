"""Vectors of numbers as values of compiled code: one instruction works on all lanes.

Compilers do not find these vectors by themselves in a butterfly that reads and writes many rows, because the
rows might overlap. A vector holds 64 bytes; processors with shorter registers use several.
"""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable

BYTES = 64


def lanes(dtype: Any) -> int:
    """Count the numbers in a vector.

    Parameters
    ----------
    dtype : dtype
        float32 or float64.

    Returns
    -------
    int
        Numbers.
    """
    return BYTES // np.dtype(dtype).itemsize


def _compiled(generator: Any) -> Any:
    """Make a function of compiled code: its first parameter is filled in."""
    return intrinsic(generator)


class Lanes(types.Type):
    """Numba's type of a vector."""

    def __init__(self, element: types.Float) -> None:
        self.element = element
        self.width = BYTES * 8 // element.bitwidth
        super().__init__(name=f"Lanes({element})")


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Lanes) -> None:
        element = manager.lookup(kind.element).get_value_type()
        super().__init__(manager, kind, ir.VectorType(element, kind.width))


def _pointer(context: Any, builder: Any, kind: Any, value: Any, index: Any) -> tuple[Any, int]:
    """Pointer to the vector that starts at an element of a flat array, and its alignment."""
    data = context.make_array(kind)(context, builder, value).data
    vector = context.get_value_type(Lanes(kind.dtype))
    return builder.bitcast(builder.gep(data, [index]), ir.PointerType(vector)), kind.dtype.bitwidth // 8


def _broadcast(builder: Any, scalar: Any, width: int) -> Any:
    vector = ir.VectorType(scalar.type, width)
    single = builder.insert_element(ir.Constant(vector, ir.Undefined), scalar, cgutils.int32_t(0))
    return builder.shuffle_vector(single, single, _mask([0] * width))


def _mask(lanes: list[int]) -> Any:
    return ir.Constant(ir.VectorType(ir.IntType(32), len(lanes)), lanes)


@_compiled
def load(typing: Any, array: Any, index: Any) -> Any:
    """Vector of the elements from `index` on of a flat contiguous array."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = _pointer(context, builder, array, *arguments)
        return builder.load(pointer, align=alignment)

    return Lanes(array.dtype)(array, types.intp), generate


@_compiled
def store(typing: Any, array: Any, index: Any, vector: Any) -> Any:
    """Write a vector to the elements from `index` on of a flat contiguous array."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = _pointer(context, builder, array, *arguments[:2])
        builder.store(arguments[2], pointer, align=alignment)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), generate


def _operation(symbol: Any, instruction: str) -> None:
    """Give vectors an operator, between themselves and with a number on the left."""

    @type_callable(symbol)
    def typed(context: Any) -> Any:
        def typer(left: Any, right: Any) -> Any:
            if isinstance(right, Lanes) and left in (right, right.element):
                return right
            return None

        return typer

    @lower_builtin(symbol, Lanes, Lanes)
    @lower_builtin(symbol, types.Float, Lanes)
    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        left, right = arguments
        if not isinstance(signature.args[0], Lanes):
            left = _broadcast(builder, left, signature.args[1].width)
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
        width = Lanes(source.dtype).width
        rows = []
        for i in range(width):
            index = builder.add(start_, builder.mul(stride_, stride_.type(i)))
            pointer, alignment = _pointer(context, builder, source, read, index)
            rows.append(builder.load(pointer, align=alignment))
        for i, row in enumerate(_transposed(builder, rows)):
            index = builder.add(first_, builder.mul(step_, step_.type(i)))
            pointer, alignment = _pointer(context, builder, target, written, index)
            builder.store(row, pointer, align=alignment)
        return context.get_dummy_value()

    n = types.intp
    return types.void(source, n, n, target, n, n), generate


def _transposed(builder: Any, rows: list[Any]) -> list[Any]:
    """Swap blocks off the diagonal, from the largest to the smallest."""
    width = len(rows)
    block = width // 2
    while block:
        lower = [lane if not lane & block else width + lane - block for lane in range(width)]
        upper = [lane + block if not lane & block else width + lane for lane in range(width)]
        masks = _mask(lower), _mask(upper)
        for i in range(width):
            if not i & block:
                pair = rows[i], rows[i + block]
                rows[i], rows[i + block] = (builder.shuffle_vector(*pair, mask) for mask in masks)
        block //= 2
    return rows
