"""Vectors of numbers as values of compiled code: one instruction works on all lanes.

Compilers do not find these vectors by themselves in a butterfly that reads and writes many rows, because the
rows might overlap. A vector holds eight numbers, sixteen in single precision; processors with shorter
registers use several.
"""

import operator
from typing import Any

import numpy as np
from llvmlite import binding, ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable
from numpy.typing import DTypeLike, NDArray

VECTOR_BYTES = 64
"""Size of a vector, and of a line of a processor's cache."""
EIGHT = 8
"""Numbers in a vector, at least."""


def width(dtype: DTypeLike) -> int:
    """Numbers in a vector, of type float64 or float32."""
    return VECTOR_BYTES // np.dtype(dtype).itemsize


def holds_vectors() -> bool:
    """Whether a register of the processor holds a whole vector."""
    try:
        return bool(binding.get_host_cpu_features().get("avx512f", False))
    except RuntimeError:  # it cannot be told everywhere
        return False


def aligned(count: int, dtype: DTypeLike) -> NDArray:
    """Zeros that begin with a line of the cache: a vector that lies on two is read twice."""
    size = count * np.dtype(dtype).itemsize
    room = np.zeros(size + VECTOR_BYTES, np.uint8)
    first = -room.ctypes.data % VECTOR_BYTES
    return room[first : first + size].view(dtype)


_compiled: Any = intrinsic  # makes a function of compiled code, whose first parameter is filled in
_compiled_for: Any = intrinsic(prefer_literal=True)  # likewise, for each number that is written in a call


class Lanes(types.Type):
    """Numba's type of a vector of numbers of a type."""

    def __init__(self, number: Any) -> None:
        self.number = number
        self.count = VECTOR_BYTES * 8 // number.bitwidth
        super().__init__(name=f"Lanes({number})")


def _vector(kind: Any) -> Any:
    return ir.VectorType(ir.DoubleType() if kind.number == types.float64 else ir.FloatType(), kind.count)


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Lanes) -> None:
        super().__init__(manager, kind, _vector(kind))


def _pointer(context: Any, builder: Any, kind: Any, value: Any, index: Any) -> Any:
    """Pointer to the vector that starts at an element of a contiguous array, counted flat."""
    data = context.make_array(kind)(context, builder, value).data
    return builder.bitcast(builder.gep(data, [index]), ir.PointerType(_vector(Lanes(kind.dtype))))


def _broadcast(builder: Any, scalar: Any, kind: Lanes) -> Any:
    undefined = ir.Constant(_vector(kind), ir.Undefined)
    single = builder.insert_element(undefined, scalar, cgutils.int32_t(0))
    return builder.shuffle_vector(single, single, _mask([0] * kind.count))


def _mask(lanes: list[int]) -> Any:
    return ir.Constant(ir.VectorType(ir.IntType(32), len(lanes)), lanes)


@_compiled
def lanes(typing: Any, array: Any) -> Any:
    """Numbers in a vector of an array's, known to the compiler."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return context.get_constant(types.intp, Lanes(array.dtype).count)

    return types.intp(array), generate


@_compiled
def load(typing: Any, array: Any, index: Any) -> Any:
    """Vector of the elements from `index` on of a flat contiguous array."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_pointer(context, builder, array, *arguments), align=array.dtype.bitwidth // 8)

    return Lanes(array.dtype)(array, types.intp), generate


@_compiled
def store(typing: Any, array: Any, index: Any, vector: Any) -> Any:
    """Write a vector to the elements from `index` on of a flat contiguous array."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer = _pointer(context, builder, array, *arguments[:2])
        builder.store(arguments[2], pointer, align=array.dtype.bitwidth // 8)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), generate


def _operation(symbol: Any, instruction: str) -> None:
    """Give vectors an operator, between themselves and with a number on the left, which takes their type."""

    @type_callable(symbol)
    def typed(context: Any) -> Any:
        def typer(left: Any, right: Any) -> Any:
            fits = isinstance(right, Lanes) and (left == right or isinstance(left, types.Float))
            return right if fits else None

        return typer

    @lower_builtin(symbol, Lanes, Lanes)
    @lower_builtin(symbol, types.Float, Lanes)
    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        left, right = arguments
        kind = signature.args[1]
        if not isinstance(signature.args[0], Lanes):
            left = _broadcast(builder, context.cast(builder, left, signature.args[0], kind.number), kind)
        # "contract": a product and a sum may become one instruction
        return getattr(builder, instruction)(left, right, flags=("contract",))


_operation(operator.add, "fadd")
_operation(operator.sub, "fsub")
_operation(operator.mul, "fmul")


@_compiled_for
def sum_beside(typing: Any, before: Any, vector: Any, after: Any, distance: Any) -> Any:
    """Sum of what lies a distance before and behind each lane, in three vectors one after the other.

    The distance is written in the call, and at most a vector.
    """
    count, far = before.count, distance.literal_value

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        first, middle, last, _ = arguments
        behind = builder.shuffle_vector(middle, last, _mask(list(range(far, count + far))))
        ahead = builder.shuffle_vector(first, middle, _mask(list(range(count - far, 2 * count - far))))
        return builder.fadd(ahead, behind)

    return before(before, vector, after, distance), generate


@_compiled
def transpose(typing: Any, source: Any, start: Any, stride: Any, target: Any, first: Any, step: Any) -> Any:
    """Transpose a square of numbers: its rows lie `stride` apart in the source, `step` in the target."""

    kind = Lanes(source.dtype)
    align = kind.number.bitwidth // 8

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        read, start_, stride_, written, first_, step_ = arguments
        rows = []
        for i in range(kind.count):
            index = builder.add(start_, builder.mul(stride_, stride_.type(i)))
            rows.append(builder.load(_pointer(context, builder, source, read, index), align=align))
        for i, row in enumerate(_transposed(builder, rows)):
            index = builder.add(first_, builder.mul(step_, step_.type(i)))
            builder.store(row, _pointer(context, builder, target, written, index), align=align)
        return context.get_dummy_value()

    n = types.intp
    return types.void(source, n, n, target, n, n), generate


@_compiled
def write_places(typing: Any, target: Any, index: Any, table: Any, row: Any, first: Any) -> Any:
    """Write eight places, those in a row of a table of bytes and a first one added up, from an index on."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        written, index_, table_, row_, first_ = arguments
        few, many = (ir.VectorType(ir.IntType(bits), EIGHT) for bits in (8, 32))
        source = context.make_array(table)(context, builder, table_).data
        source = builder.gep(source, [builder.mul(row_, row_.type(EIGHT))])
        places = builder.load(builder.bitcast(source, ir.PointerType(few)), align=1)
        start = builder.trunc(first_, ir.IntType(32))
        single = builder.insert_element(ir.Constant(many, ir.Undefined), start, cgutils.int32_t(0))
        starts = builder.shuffle_vector(single, single, _mask([0] * EIGHT))
        data = context.make_array(target)(context, builder, written).data
        data = builder.bitcast(builder.gep(data, [index_]), ir.PointerType(many))
        builder.store(builder.add(builder.zext(places, many), starts), data, align=4)
        return context.get_dummy_value()

    n = types.intp
    return types.void(target, n, table, n, n), generate


@_compiled
def columns(typing: Any, source: Any, places: Any, start: Any, target: Any, first: Any, step: Any) -> Any:
    """Read a row of the source at each place of a vector of them; write eight columns, `step` apart."""

    kind = Lanes(source.dtype)
    align = kind.number.bitwidth // 8

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        read, known, start_, written, first_, step_ = arguments
        place = context.make_array(places)(context, builder, known).data
        rows = []
        for i in range(kind.count):
            index = builder.load(builder.gep(place, [builder.add(start_, start_.type(i))]))
            rows.append(builder.load(_pointer(context, builder, source, read, index), align=align))
        for i, row in enumerate(_transposed(builder, rows)[:EIGHT]):
            index = builder.add(first_, builder.mul(step_, step_.type(i)))
            builder.store(row, _pointer(context, builder, target, written, index), align=align)
        return context.get_dummy_value()

    n = types.intp
    return types.void(source, places, n, target, n, n), generate


def _transposed(builder: Any, rows: list[Any]) -> list[Any]:
    """Swap blocks off the diagonal, from the largest to the smallest."""
    count = len(rows)
    block = count // 2
    while block:
        lower = [lane if not lane & block else count + lane - block for lane in range(count)]
        upper = [lane + block if not lane & block else count + lane for lane in range(count)]
        masks = _mask(lower), _mask(upper)
        for i in range(count):
            if not i & block:
                pair = rows[i], rows[i + block]
                rows[i], rows[i + block] = (builder.shuffle_vector(*pair, mask) for mask in masks)
        block //= 2
    return rows
