"""From lanes to one number, or from codes to lanes: the rest of what `lanes` begins."""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types

from .lanes import (
    INDEX,
    WORD,
    LanesType,
    Vec,
    emit_call,
    emit_splat,
    joined,
    operation,
    parted,
    shuffled,
)


def _in_words(b: Any, vec: Vec, value: Any) -> list[tuple[int, Any]]:
    """First lane and vector of pieces of at most 64 lanes: what is true of each lane of one fits a word."""
    pieces = []
    for (first, part), each in zip(vec.parts, parted(b, vec, value), strict=True):
        count = min(part.count, 64)
        pieces += [(first + i, shuffled(b, each, each, range(i, i + count))) for i in range(0, part.count, count)]
    return pieces


def _first_set(b: Any, mask: Any) -> Any:
    """Index, as a 64-bit integer, of the first bit that is set."""
    index = emit_call(b, f"llvm.cttz.{mask.type}", mask.type, [mask, ir.Constant(ir.IntType(1), 1)])
    return b.zext(index, WORD) if mask.type.width < 64 else index


def _folded(b: Any, vec: Vec, value: Any, of_two: Callable[[Any, Vec, Any, Any], Any]) -> tuple[Any, Vec]:
    """The parts of lanes made one vector: the wider is halved until it is as wide as the next, and both are one."""
    whole, width = None, 0
    for (_, part), each in zip(vec.parts, parted(b, vec, value), strict=True):
        whole = each if whole is None else of_two(b, part, _halved(b, vec, whole, width, part.count, of_two), each)
        width = part.count
    return whole, Vec(vec.element, width)


def _halved(b: Any, vec: Vec, value: Any, width: int, narrow: int, of_two: Callable[[Any, Vec, Any, Any], Any]) -> Any:
    """So many lanes made one half after the other, until they are as few as that."""
    while width > narrow:
        width //= 2
        halves = (shuffled(b, value, value, range(i, i + width)) for i in (0, width))
        value = of_two(b, Vec(vec.element, width), *halves)
    return value


@operation
def first_lane(typing: Any, vec: Vec) -> Any:
    """Lane 0."""
    return vec.element(vec), lambda c, b, sig, a: b.extract_element(parted(b, vec, a[0])[0], ir.Constant(INDEX, 0))


@operation
def lowest(typing: Any, vec: Vec) -> Any:
    """The smallest lane of unsigned integers."""

    def smaller(b: Any, kind: Vec, x: Any, y: Any) -> Any:
        return emit_call(b, f"llvm.umin.{kind.mangled}", kind.llvm, [x, y])

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        value, kind = _folded(b, vec, a[0], smaller)
        return emit_call(b, f"llvm.vector.reduce.umin.{kind.mangled}", ir.IntType(vec.element.bitwidth), [value])

    return vec.element(vec), emit


@operation
def highest(typing: Any, vec: Vec) -> Any:
    """The largest lane of floats free of NaN, by halving."""

    def emit_larger(b: Any, kind: Vec, x: Any, y: Any) -> Any:
        return b.select(b.fcmp_ordered(">", x, y), x, y)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        value, kind = _folded(b, vec, a[0], emit_larger)
        largest = _halved(b, vec, value, kind.count, 1, emit_larger)
        return b.extract_element(largest, ir.Constant(INDEX, 0))

    return vec.element(vec), emit


@operation
def total(typing: Any, vec: Vec) -> Any:
    """The sum of all lanes of integers; it wraps as a lane would."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        value, kind = _folded(b, vec, a[0], lambda b, kind, x, y: b.add(x, y))
        return emit_call(b, f"llvm.vector.reduce.add.{kind.mangled}", ir.IntType(vec.element.bitwidth), [value])

    return vec.element(vec), emit


@operation
def first_equal(typing: Any, vec: Vec, scalar: Any) -> Any:
    """Index of the first lane equal to the scalar, which must occur."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        compare = b.fcmp_ordered if vec.real else b.icmp_unsigned
        index = None
        for first, value in reversed(_in_words(b, vec, a[0])):
            mask = ir.IntType(value.type.count)
            hits = b.bitcast(compare("==", value, emit_splat(b, a[1], value.type.count)), mask)
            here = b.add(_first_set(b, hits), ir.Constant(WORD, first))
            found = b.icmp_unsigned("!=", hits, ir.Constant(mask, 0))
            index = here if index is None else b.select(found, here, index)
        return index

    return types.int64(vec, vec.element), emit


@operation
def differences(typing: Any, lanes: LanesType, left: Any, right: Any, x: Any) -> Any:
    """Lane k: how many bits of left[:, x] and right[:, x + k] differ, as uint8. Both are (planes, columns) of bytes.

    If the lanes have a `most_level`, the plane after the code holds levels; what these differ by is added, up to that.
    """
    whole = Vec(types.uint8, lanes.count)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        return joined(b, whole, [emit_part(c, b, sig, a, *each) for each in whole.parts])

    def emit_part(c: Any, b: Any, sig: Any, a: Any, first: int, vec: Vec) -> Any:
        rows = [c.make_array(kind)(c, b, array) for kind, array in zip(sig.args[1:3], a[1:3], strict=True)]
        strides = [b.extract_value(each.shape, 1) for each in rows]

        def of_plane(plane: int) -> tuple[Any, Any]:
            code, codes = (
                b.gep(each.data, [b.add(a[3], b.mul(stride, ir.Constant(WORD, plane)))])
                for each, stride in zip(rows, strides, strict=True)
            )
            codes = b.gep(codes, [ir.Constant(WORD, first)])
            others = b.load(b.bitcast(codes, vec.llvm.as_pointer()))
            others.align = 1
            return others, emit_splat(b, b.load(code), vec.count)

        def of_two(name: str, x: Any, y: Any) -> Any:
            return emit_call(b, f"llvm.{name}.{vec.mangled}", vec.llvm, [x, y])

        total = ir.Constant(vec.llvm, [0] * vec.count)
        for plane in range(sig.args[0].planes):
            differing = b.xor(*of_plane(plane))
            total = b.add(total, emit_call(b, f"llvm.ctpop.{vec.mangled}", vec.llvm, [differing]))
        if most := sig.args[0].most_level:
            levels = of_plane(sig.args[0].planes)
            difference = b.sub(of_two("umax", *levels), of_two("umin", *levels))
            total = b.add(total, of_two("umin", difference, ir.Constant(vec.llvm, [most] * vec.count)))
        return total

    return whole(lanes, left, right, types.int64), emit
