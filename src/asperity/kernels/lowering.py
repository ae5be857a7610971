"""How kernels become intermediate code: with little of it, as that is what compiling costs.

Numba keeps every variable in memory, writes zeros there where it ends, copies an array whole for each item
that is read, and takes tuples of arrays apart and puts them together again at every call. LLVM finds all that
to be needless, and takes most of its time for it. Here what is assigned once is a value; an item is an
address; a part of a tuple is what was put there; and what nothing uses is not written.

The code that is left computes the same. Of numba this needs the class that lowers a function; what of it is
not documented stands in `NEEDED`.
"""

from collections import Counter
from collections.abc import Iterable
from itertools import zip_longest
from typing import Any

from llvmlite.ir import Constant, Function, IntType, IRBuilder, Undefined
from llvmlite.ir.instructions import (
    CastInstr,
    ExtractValue,
    GEPInstr,
    ICMPInstr,
    InsertValue,
    LoadInstr,
    SelectInstr,
)
from numba.core import cgutils, types
from numba.core.analysis import compute_cfg_from_blocks, must_use_alloca
from numba.core.compiler_machinery import register_pass
from numba.core.ir import Assign
from numba.core.lowering import Lower
from numba.core.typed_passes import NativeLowering

WITHOUT_EFFECT = (CastInstr, ExtractValue, GEPInstr, ICMPInstr, InsertValue, LoadInstr, SelectInstr)
"""Instructions that may be left out where nothing uses what they give."""
NEEDED = (
    "_alloca_var", "_disable_sroa_like_opt", "_find_singly_assigned_variable", "delvar", "getvar", "init",
    "loadvar", "lower_expr", "lower_getitem", "lower_normal_function", "lower_setitem", "setup_function",
    "storevar",
)  # fmt: skip
"""Methods of `numba.core.lowering.Lower` that are called, or stand in another form here."""


class _Builder(IRBuilder):  # type: ignore[misc]
    """Writes instructions; what is taken out of a value is what was put in."""

    def extract_value(self, agg: Any, idx: Any, name: str = "") -> Any:
        """A member of an aggregate."""
        indices = [idx] if isinstance(idx, int) else list(idx)
        while indices and isinstance(agg, InsertValue):
            put = list(agg.indices)
            if indices[: len(put)] == put:
                agg, indices = agg.value, indices[len(put) :]
            elif put[: len(indices)] == indices:  # into a part of what is taken
                break
            else:
                agg = agg.aggregate
        return super().extract_value(agg, indices, name) if indices else agg


class LeanLower(Lower):
    """Numba's way from a function to intermediate code, without what no kernel needs."""

    def init(self) -> None:
        """Find what is assigned once."""
        super().init()
        self._lean = not (self.context.enable_nrt or self._disable_sroa_like_opt or self.generator_info)
        self._once = assigned_once(self.func_ir.blocks) if self._lean else set()
        self._values: dict[str, Any] = {}

    def setup_function(self, fndesc: Any) -> None:
        """Begin a function."""
        super().setup_function(fndesc)
        if self._lean:
            self.builder = _Builder(self.entry_block)
            self.call_helper = self.call_conv.init_call_helper(self.builder)

    def lower_normal_function(self, fndesc: Any) -> None:
        """Lower a function, and leave out what nothing uses."""
        super().lower_normal_function(fndesc)
        if self._lean:
            leave_out_unused(self.function)

    def loadvar(self, name: str) -> Any:
        """The value of a variable."""
        return self._values[name] if name in self._values else super().loadvar(name)

    def storevar(self, value: Any, name: str, argidx: int | None = None) -> None:
        """Let a variable have a value."""
        if name in self._once:
            self._values[name] = value
        elif not self._lean or name in self._singly_assigned_vars:
            super().storevar(value, name, argidx)
        else:
            self._alloca_var(name, self.typeof(name))
            self.builder.store(value, self.getvar(name))

    def delvar(self, name: str) -> None:
        """End a variable."""
        if not self._lean:
            super().delvar(name)

    def lower_expr(self, resty: Any, expr: Any) -> Any:
        """Lower an expression; shape and length of an array are parts of it."""
        found = None
        if self._lean and expr.op == "getattr" and expr.attr == "shape":
            found = self._shape(expr.value)
        elif self._lean and expr.op == "call" and self._is_length(expr.func):
            shape = self._shape(expr.args[0])
            found = shape and self.builder.extract_value(shape, 0)
        return found or super().lower_expr(resty, expr)

    def _is_length(self, function: Any) -> bool:
        """Whether a function is Python's `len`."""
        return getattr(self.typeof(function.name), "typing_key", None) is len

    def _shape(self, variable: Any) -> Any:
        """Shape of an array; None if it is another thing."""
        kind = self.typeof(variable.name)
        return (
            self._part(kind, self.loadvar(variable.name), "shape") if isinstance(kind, types.Array) else None
        )

    def _put_together(self, kind: Any, *members: Any) -> Any:
        """A value of several members."""
        value = Constant(self.context.get_value_type(kind), Undefined)
        for position, each in enumerate(members):
            value = self.builder.insert_value(value, each, position)
        return value

    def lower_getitem(self, resty: Any, expr: Any, value: Any, index: Any, signature: Any) -> Any:
        """Read an item of an array, or look at a row."""
        array = self.typeof(value.name)
        indices = self._indices(array, index)
        if indices is None:
            return super().lower_getitem(resty, expr, value, index, signature)
        pointer = self._address(array, self.loadvar(value.name), indices)
        if isinstance(resty, types.Array):
            return self._row(array, self.loadvar(value.name), len(indices), resty, pointer)
        align = None if array.aligned else 1
        item = self.context.unpack_value(self.builder, array.dtype, pointer, align=align)
        return self.context.cast(self.builder, item, array.dtype, resty)

    def lower_setitem(self, target_var: Any, index_var: Any, value_var: Any, signature: Any) -> Any:
        """Write an item of an array."""
        array = self.typeof(target_var.name)
        indices = self._indices(array, index_var)
        if indices is None or len(indices) < array.ndim:
            return super().lower_setitem(target_var, index_var, value_var, signature)
        given = self.typeof(value_var.name)
        value = self.context.cast(self.builder, self.loadvar(value_var.name), given, array.dtype)
        pointer = self._address(array, self.loadvar(target_var.name), indices)
        align = None if array.aligned else 1
        self.context.pack_value(self.builder, array.dtype, value, pointer, align=align)
        return None

    def _indices(self, array: Any, index: Any) -> list[tuple[Any, Any]] | None:
        """Values and types of indices into an array of numbers; None if it is another thing."""
        if not self._lean or self.context.enable_boundscheck or type(array) is not types.Array:
            return None
        kind = self.typeof(index.name)
        several = isinstance(kind, types.BaseTuple)
        kinds = kind.types if several else (kind,)
        if not (kinds and isinstance(array.dtype, (types.Number, types.Boolean))):
            return None
        if not all(isinstance(each, types.Integer) for each in kinds):
            return None
        value = self.loadvar(index.name)
        values = cgutils.unpack_tuple(self.builder, value, len(kinds)) if several else [value]
        return list(zip(values, kinds, strict=True))

    def _part(self, array: Any, value: Any, name: str) -> Any:
        """A part of an array, as its shape."""
        position = self.context.data_model_manager[array].get_field_position(name)
        return self.builder.extract_value(value, position)

    def _address(self, array: Any, value: Any, indices: list[tuple[Any, Any]]) -> Any:
        """Where an item lies."""
        builder = self.builder
        shape = cgutils.unpack_tuple(builder, self._part(array, value, "shape"), array.ndim)
        data = self._part(array, value, "data")
        steps = [self._from_start(*each, size) for each, size in zip(indices, shape, strict=False)]
        if array.layout == "C":
            position = steps[0]
            for step, size in zip_longest(steps[1:], shape[1:]):
                position = builder.mul(position, size)
                position = position if step is None else builder.add(position, step)
            return builder.gep(data, [position])
        strides = cgutils.unpack_tuple(builder, self._part(array, value, "strides"), array.ndim)
        offset = builder.mul(steps[0], strides[0])
        for step, stride in zip(steps[1:], strides[1:], strict=False):
            offset = builder.add(offset, builder.mul(step, stride))
        return cgutils.pointer_add(builder, data, offset)

    def _row(self, array: Any, value: Any, fixed: int, kind: Any, pointer: Any) -> Any:
        """What is left of an array where its first indices are fixed."""
        builder = self.builder
        shape, strides = (
            cgutils.unpack_tuple(builder, self._part(array, value, name), array.ndim)[fixed:]
            for name in ("shape", "strides")
        )
        count = shape[0]
        for size in shape[1:]:
            count = builder.mul(count, size)
        owner, parent, size = (self._part(array, value, name) for name in ("meminfo", "parent", "itemsize"))
        both = (cgutils.pack_array(builder, each) for each in (shape, strides))
        return self._put_together(kind, owner, parent, count, size, pointer, *both)

    def _from_start(self, index: Any, kind: Any, size: Any) -> Any:
        """An index, counted from the start: what is negative counts from the end."""
        builder = self.builder
        if not kind.signed:
            return self.context.cast(builder, index, kind, types.uintp)
        step = self.context.cast(builder, index, kind, types.intp)
        if isinstance(step, Constant) and 0 <= step.constant <= kind.maxval:  # -1 may be written 2**64 - 1
            return step
        zero = Constant(IntType(step.type.width), 0)
        return builder.select(builder.icmp_signed("<", step, zero), builder.add(step, size), step)


@register_pass(mutates_CFG=True, analysis_only=False)
class LeanLowering(NativeLowering):
    """The pass that does so."""

    _name = "lean_lowering"

    @property
    def lowering_class(self) -> Any:
        """What lowers a function."""
        return LeanLower


def assigned_once(blocks: dict[int, Any]) -> set[str]:
    """Names of variables that are assigned once, before each of their uses and in order of the blocks."""
    before = compute_cfg_from_blocks(blocks).dominators()
    times: Counter[str] = Counter()
    where: dict[str, int] = {}
    late: set[str] = set(must_use_alloca(blocks))
    for label, block in sorted(blocks.items()):
        for statement in block.body:
            names = [each.name for each in statement.list_vars()]
            if isinstance(statement, Assign):
                names.remove(statement.target.name)
            late |= {name for name in names if where.get(name) not in before[label]}
            if isinstance(statement, Assign):
                times[statement.target.name] += 1
                where[statement.target.name] = label
    return {name for name, count in times.items() if count == 1} - late


def leave_out_unused(function: Function) -> None:
    """Remove instructions without effect that nothing uses."""
    uses: Counter[int] = Counter()
    for block in function.blocks:
        for each in block.instructions:
            uses.update(map(id, _used_by(each)))
    for block in reversed(function.blocks):
        kept = []
        for each in reversed(block.instructions):
            if uses[id(each)] == 0 and isinstance(each, WITHOUT_EFFECT):
                uses.subtract(map(id, _used_by(each)))
            else:
                kept.append(each)
        block.instructions[:] = kept[::-1]


def _used_by(instruction: Any) -> Iterable[Any]:
    """What an instruction takes."""
    yield from instruction.operands
    yield from (value for value, _ in getattr(instruction, "incomings", ()))
