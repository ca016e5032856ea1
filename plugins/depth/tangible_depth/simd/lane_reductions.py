"""Reductions of SIMD lanes to one number, and of codes to lanes; an extension of `lanes`."""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types

from .lanes import INDEX, WORD, LanesType, Vec, emit_call, emit_splat, join, operation, shuffle, split


def _in_words(b: Any, vec: Vec, value: Any) -> list[tuple[int, Any]]:
    """Divide lanes into pieces of at most 64, whose mask fits a word: first lane and vector of each."""
    pieces = []
    for (first, part), word in zip(vec.parts, split(b, vec, value), strict=True):
        count = min(part.count, 64)
        pieces += [(first + i, shuffle(b, word, word, range(i, i + count))) for i in range(0, part.count, count)]
    return pieces


def _fold(b: Any, vec: Vec, value: Any, of_two: Callable[[Any, Vec, Any, Any], Any]) -> tuple[Any, Vec]:
    """Fold the parts of lanes into one vector: halve the wider until it is as wide as the next, then combine both."""
    whole, width = None, 0
    for (_, part), word in zip(vec.parts, split(b, vec, value), strict=True):
        whole = word if whole is None else of_two(b, part, _halve(b, vec, whole, width, part.count, of_two), word)
        width = part.count
    return whole, Vec(vec.element, width)


def _halve(b: Any, vec: Vec, value: Any, width: int, narrow: int, of_two: Callable[[Any, Vec, Any, Any], Any]) -> Any:
    while width > narrow:
        width //= 2
        halves = (shuffle(b, value, value, range(i, i + width)) for i in (0, width))
        value = of_two(b, Vec(vec.element, width), *halves)
    return value


@operation
def first_lane(typing: Any, vec: Vec) -> Any:
    """Return lane 0."""
    return vec.element(vec), lambda c, b, sig, a: b.extract_element(split(b, vec, a[0])[0], ir.Constant(INDEX, 0))


@operation
def lowest(typing: Any, vec: Vec) -> Any:
    """Return the smallest lane of unsigned integers."""

    def smaller(b: Any, kind: Vec, x: Any, y: Any) -> Any:
        return emit_call(b, f"llvm.umin.{kind.mangled}", kind.llvm, [x, y])

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        value, kind = _fold(b, vec, a[0], smaller)
        return emit_call(b, f"llvm.vector.reduce.umin.{kind.mangled}", ir.IntType(vec.element.bitwidth), [value])

    return vec.element(vec), emit


@operation
def highest(typing: Any, vec: Vec) -> Any:
    """Return the largest lane of floats without NaN, by halving."""

    def emit_larger(b: Any, kind: Vec, x: Any, y: Any) -> Any:
        return b.select(b.fcmp_ordered(">", x, y), x, y)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        value, kind = _fold(b, vec, a[0], emit_larger)
        largest = _halve(b, vec, value, kind.count, 1, emit_larger)
        return b.extract_element(largest, ir.Constant(INDEX, 0))

    return vec.element(vec), emit


@operation
def total(typing: Any, vec: Vec) -> Any:
    """Return the sum of all lanes of integers, which wraps like a lane."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        value, kind = _fold(b, vec, a[0], lambda b, kind, x, y: b.add(x, y))
        return emit_call(b, f"llvm.vector.reduce.add.{kind.mangled}", ir.IntType(vec.element.bitwidth), [value])

    return vec.element(vec), emit


@operation
def first_equal(typing: Any, vec: Vec, scalar: Any) -> Any:
    """Return the index of the first lane equal to the scalar, which must occur."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        compare = b.fcmp_ordered if vec.real else b.icmp_unsigned
        index = None
        for first, value in reversed(_in_words(b, vec, a[0])):
            mask = ir.IntType(value.type.count)
            hits = b.bitcast(compare("==", value, emit_splat(b, a[1], value.type.count)), mask)
            bit = emit_call(b, f"llvm.cttz.{mask}", mask, [hits, ir.Constant(ir.IntType(1), 1)])
            here = b.add(b.zext(bit, WORD) if mask.width < 64 else bit, ir.Constant(WORD, first))
            has_hit = b.icmp_unsigned("!=", hits, ir.Constant(mask, 0))
            index = here if index is None else b.select(has_hit, here, index)
        return index

    return types.int64(vec, vec.element), emit


@operation
def differences(typing: Any, lanes: LanesType, left: Any, right: Any, x: Any) -> Any:
    """Count the differing bits of left[:, x] and right[:, x + k] in lane k, and their level's difference, as uint8."""
    whole = Vec(types.uint8, lanes.count)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        return join(b, whole, [emit_part(c, b, sig, a, *part) for part in whole.parts])

    def emit_part(c: Any, b: Any, sig: Any, a: Any, first: int, vec: Vec) -> Any:
        rows = [c.make_array(kind)(c, b, array) for kind, array in zip(sig.args[1:3], a[1:3], strict=True)]
        strides = [b.extract_value(row.shape, 1) for row in rows]

        def of_plane(plane: int) -> tuple[Any, Any]:
            code, codes = (
                b.gep(row.data, [b.add(a[3], b.mul(stride, ir.Constant(WORD, plane)))])
                for row, stride in zip(rows, strides, strict=True)
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
