"""Kernels compute what Python computes, whatever their variables and indices are, with little code."""

import sys
from typing import NamedTuple

import numba
import numpy as np
import pytest
from llvmlite import ir
from numba.core.codegen import CPUCodeLibrary
from numba.core.compiler import run_frontend

from asperity.kernels import options
from asperity.kernels.lowering import _Builder, assigned_once, leave_out_unused
from asperity.kernels.options import CALLED, INNER, LOOP, compiled

GREATEST = np.uint64(2**64 - 1)
"""Of as many bits as -1, which it is as a number with a sign."""


class Two(NamedTuple):
    """What kernels are called with."""

    first: np.ndarray
    second: np.ndarray


@compiled(**INNER)
def swapped(two):
    return Two(two.second, two.first)


@compiled(**CALLED)
def difference(two, i):
    return two.first[i] - two.second[i]


def of_parts(two, i):
    other = Two(two.second, two.first)
    return other.first[i] - other.second[i]


@compiled(**LOOP)
def of_parts_called(two, i):
    return difference(swapped(two), i)


def from_both_ends(a, b, k):
    a[-1] = a[0] + a[k] + a[-k]
    b[k, -1] = b[-k, k] + b[-1, -1] + len(a) * b.shape[0] + b.shape[1]


def of_a_row(a, b, k):
    row = b[k]
    row[0] = a[2] + row[-1]
    a[0] = row.shape[0]


def assigned_in_branches(a, b, k):
    if k > 1:
        x = a[0]
    else:
        x = a[1]
    y = x
    for i in range(k):
        y = y * 2.0 + x
        x = a[i] - y
        last = i
    a[0] = x + y + last


def carried_over(a, b, k):
    before = a[0]
    for i in range(1, len(a)):
        now = a[i]
        a[i] = before
        before = now + b[i % b.shape[0], 0]
    a[0] = before


def until_broken(a, b, k):
    i = 0
    while True:
        here = a[i]
        i += 1
        if here > a[k] or i == len(a):
            break
    a[0] = here + i


def exchanged(a, b, k):
    for i in range(len(a) // 2):
        a[i], a[-1 - i] = a[-1 - i], a[i]
    x, y = a[0], a[1]
    x, y = y, x
    a[k] = x - y


def of_another_type(a, b, k):
    number = np.uint64(k)
    a[number] = 3
    b[number, number] = number
    a[np.int8(-1)] = b[np.int32(-1), 0] + (k > 1)


def from_the_end_by_a_constant(a, b, k):
    a[np.int64(GREATEST)] = b[np.int64(GREATEST), k] + a[0]


def of_a_tuple(a, b, k):
    at = (k, k - 3)
    pair = (a[k], b[at])
    for i in range(2):
        pair = (pair[1], pair[0] + i)
    b[at] = pair[0] - 2.0 * pair[1]


def over_ranges(a, b, k):
    total = 0.0
    for i in range(-k, k + 1):
        for j in range(len(a) - 1, 0, -k):
            total = 0.5 * total + a[i] * a[j]
    for _ in range(k, k - 3):
        total += 100.0
    for i in range(1, 5, k):
        if i == 3:
            continue
        total += i
    a[0] = total + i


def of_rows_of_rows(a, b, k):
    stacked = b.reshape((2, 2, 3))
    for i in range(-1, 1):
        rows = stacked[i]
        rows[k - 1, -1] += rows.shape[1] * len(rows) + len(rows[1]) + rows.size + stacked[0, 1][k]
        for j in range(2):
            rows[0][j] = rows[-1][1 + j] * 2.0


def with_rows_filled(a, b, k):
    b[k] = a[0]
    b[-1, :k] = a[k]


@compiled(**CALLED)
def refused_below(x, k):
    if x < 0.0:
        raise ValueError("less than nothing")
    return x + k


def through_exceptions(a, b, k):
    """Jumps from the middle of what stands in `try`."""
    for i in range(len(a)):
        before = a[i]
        try:
            x = refused_below(before, k)
            after = 3.0 * x
            a[i] = after - refused_below(b[i % 4, k], k)
        except Exception:
            a[i] = before - 1.0


FUNCTIONS = [
    from_both_ends, of_a_row, assigned_in_branches, carried_over, until_broken, exchanged, of_another_type,
    from_the_end_by_a_constant, of_a_tuple, over_ranges, with_rows_filled,
    through_exceptions,
]  # fmt: skip
LAID_OUT = {
    "in rows": lambda b: b.copy(),
    "in columns": lambda b: np.asfortranarray(b),
    "with gaps": lambda b: np.repeat(b, 2, axis=1)[:, ::2],
    "backwards": lambda b: b.copy()[::-1, ::-1],
}


@pytest.mark.parametrize("layout", LAID_OUT)
@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda each: each.__name__)
def test_a_kernel_computes_what_python_computes(function, layout):
    random = np.random.default_rng(1)
    a, b = random.normal(size=5), random.normal(size=(4, 3))
    results = []
    for each in (function, compiled(_nrt=False)(function)):
        x, y = a.copy(), LAID_OUT[layout](b)
        each(x, y, 2)
        results.append(np.concatenate([x, y.ravel()]))
    assert not np.array_equal(results[0], np.concatenate([a, LAID_OUT[layout](b).ravel()]))
    np.testing.assert_array_equal(*results)


def test_rows_of_rows_are_parts_of_the_whole():
    results = []
    for each in (of_rows_of_rows, compiled(_nrt=False)(of_rows_of_rows)):
        b = np.random.default_rng(2).normal(size=(4, 3))
        each(b[0].copy(), b, 2)
        results.append(b)
    np.testing.assert_array_equal(*results)
    assert not np.array_equal(results[0], np.random.default_rng(2).normal(size=(4, 3)))


def test_numbers_of_all_types_are_read_and_written():
    def moved(x):
        x[1, 0, -1] = x[0, 1, 1]

    for dtype in (bool, np.int8, np.uint16, np.int64, np.float32, np.float64, np.complex128):
        x = np.arange(8).reshape(2, 2, 2).astype(dtype)
        x[0, 1, 1], x[1, 0, 1] = 1, 0
        compiled(_nrt=False)(moved)(x)
        assert x[1, 0, 1] == 1


def put_at(a, i):
    a[i] = 1.0


def first_from_last(records):
    values = records.value
    values[0] = values[-1]


def total_of_doubles(x):
    y = np.zeros(len(x))
    for i in range(len(x)):
        y[i] = 2.0 * x[i]
    z = x[1:]
    return y.sum() + 0.0 * z[0]


def from_one_to_the_next(x):
    before = x[0]
    for i in range(1, len(x)):
        now = x[i]
        yield now - before
        before = now


def test_what_is_left_to_numba_computes_the_same():
    x = np.array([1.0, 4.0, 2.0])
    assert list(compiled(_nrt=False)(from_one_to_the_next)(x)) == [3.0, -2.0]
    holders = sys.getrefcount(x)
    assert compiled()(total_of_doubles)(x) == 14.0
    assert sys.getrefcount(x) == holders


def test_what_lies_beyond_an_array_is_refused_where_numba_is_told_to_look(monkeypatch):
    monkeypatch.setattr(numba.config, "BOUNDSCHECK", 1)
    a = np.ones(5)
    for index in (5, -6):
        with pytest.raises(IndexError, match="out of bounds"):
            compiled(_nrt=False)(lambda a, i: a[i])(a, index)
        with pytest.raises(IndexError, match="out of bounds"):
            compiled(_nrt=False)(put_at)(a, index)


@pytest.mark.skipif(options.PLAIN, reason="numba lacks what this needs")
def test_items_that_are_not_aligned_are_not_taken_to_be():
    for aligned, lines in ((True, 0), (False, 2)):
        records = np.rec.array(np.zeros(3, np.dtype([("flag", bool), ("value", float)], align=aligned)))
        records.value[-1] = 4.0
        written = code_of(compiled(_nrt=False)(first_from_last), records)
        assert sum(each.endswith("align 1") for each in written) == lines
        assert records.value[0] == 4.0


def test_parts_of_tuples_reach_the_kernels_that_are_called():
    two = Two(np.array([1.0, 2.0]), np.array([5.0, 9.0]))
    assert [of_parts_called(two, i) for i in (0, 1, -1)] == [4.0, 7.0, 7.0]
    assert [compiled(**LOOP)(of_parts)(two, i) for i in (0, 1, -1)] == [4.0, 7.0, 7.0]


def code_of(function, *arguments):
    """Lines of intermediate code that LLVM gets for a function, without its entry."""
    written, add = [], CPUCodeLibrary.add_ir_module
    with pytest.MonkeyPatch.context() as patch:
        count = lambda library, module: (written.append(str(module)), add(library, module))[1]  # noqa: E731
        patch.setattr(CPUCodeLibrary, "add_ir_module", count)
        function(*arguments)
    codes = [each.splitlines() for each in written if "define" in each and "wrapper" not in each]
    return min(codes, key=len)


@pytest.mark.skipif(options.PLAIN, reason="numba lacks what this needs")
@pytest.mark.parametrize("function", [from_both_ends, carried_over, of_a_row], ids=lambda each: each.__name__)
def test_intermediate_code_is_half_of_what_numba_writes(function):
    arguments = np.ones(5), np.ones((4, 3)), 2
    own = code_of(compiled(_nrt=False)(function), *arguments)
    assert len(own) < 0.5 * len(code_of(numba.njit(_nrt=False)(function), *arguments))


def test_of_a_value_what_was_put_in_is_taken_out_whole():
    number = ir.DoubleType()
    pair = ir.LiteralStructType([number, number])
    function = ir.Function(ir.Module(), ir.FunctionType(number, [number]), "taken")
    builder = _Builder(function.append_basic_block())
    outer = ir.Constant(ir.LiteralStructType([pair, number]), ir.Undefined)
    value = builder.insert_value(builder.insert_value(outer, function.args[0], (0, 1)), function.args[0], 1)
    assert builder.extract_value(value, 1) is builder.extract_value(value, (0, 1)) is function.args[0]
    part = builder.extract_value(value, 0)
    assert part.type == pair
    assert part.aggregate is value.aggregate  # into which a part of it was put


def test_what_a_choice_between_paths_or_a_call_takes_is_kept():
    number, called = ir.DoubleType(), ir.FunctionType(ir.VoidType(), [])
    function = ir.Function(
        ir.Module(),
        ir.FunctionType(number, [number.as_pointer(), called.as_pointer().as_pointer()]),
        "chosen",
    )
    begin, end = function.append_basic_block(), function.append_basic_block()
    builder = ir.IRBuilder(begin)
    kept = [builder.load(function.args[0])]
    builder.extract_value(ir.Constant(ir.LiteralStructType([number]), ir.Undefined), 0)
    builder.fptosi(builder.load(function.args[0]), ir.IntType(64))
    kept += [builder.load(function.args[1])]
    kept += [builder.call(kept[-1], []), builder.branch(end)]
    builder.position_at_end(end)
    choice = builder.phi(number)
    choice.add_incoming(kept[0], begin)
    builder.ret(choice)
    leave_out_unused(function)
    assert begin.instructions == kept


def test_a_variable_that_may_be_used_without_its_one_assignment_is_none_of_those():
    def function(c, n):
        if c:
            x = n
        y = n
        for i in range(n):
            y = y + i
            z = y
        return x + y + z

    once = assigned_once(run_frontend(function).blocks)
    assert {"c", "n"} <= once
    assert not {"x", "y", "z"} & once
