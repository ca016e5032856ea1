"""From lanes to one number, or from codes to lanes: the rest of what `lanes` begins."""

from typing import Any

from llvmlite import ir
from numba import types

from .lanes import INDEX, WORD, LanesType, Vec, emit_call, emit_splat, operation


def _first_set(b: Any, hits: Any, count: int) -> Any:
    """Index, as a 64-bit integer, of the first true lane."""
    mask = ir.IntType(count)
    index = emit_call(b, f"llvm.cttz.i{count}", mask, [b.bitcast(hits, mask), ir.Constant(ir.IntType(1), 1)])
    return b.trunc(index, WORD) if count > 64 else b.zext(index, WORD) if count < 64 else index


@operation
def first_lane(typing: Any, vec: Vec) -> Any:
    """Lane 0."""
    return vec.element(vec), lambda c, b, sig, a: b.extract_element(a[0], ir.Constant(INDEX, 0))


@operation
def lowest(typing: Any, vec: Vec) -> Any:
    """The smallest lane of unsigned integers."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        kind = sig.args[0]
        return emit_call(b, f"llvm.vector.reduce.umin.{kind.mangled}", kind.llvm.element, a)

    return vec.element(vec), emit


@operation
def highest(typing: Any, vec: Vec) -> Any:
    """The largest lane of floats free of NaN, by halving."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        value, count = a[0], sig.args[0].count
        while count > 1:
            count //= 2
            low, high = (
                b.shuffle_vector(value, value, ir.Constant(ir.VectorType(INDEX, count), list(range(i, i + count))))
                for i in (0, count)
            )
            value = b.select(b.fcmp_ordered(">", low, high), low, high)
        return b.extract_element(value, ir.Constant(INDEX, 0))

    return vec.element(vec), emit


@operation
def total(typing: Any, vec: Vec) -> Any:
    """The sum of all lanes of integers; it wraps as a lane would."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        kind = sig.args[0]
        return emit_call(b, f"llvm.vector.reduce.add.{kind.mangled}", kind.llvm.element, a)

    return vec.element(vec), emit


@operation
def first_equal(typing: Any, vec: Vec, scalar: Any) -> Any:
    """Index of the first lane equal to the scalar, which must occur."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        kind = sig.args[0]
        compare = b.fcmp_ordered if kind.real else b.icmp_unsigned
        return _first_set(b, compare("==", a[0], emit_splat(b, a[1], kind.count)), kind.count)

    return types.int64(vec, vec.element), emit


@operation
def differences(typing: Any, lanes: LanesType, left: Any, right: Any, x: Any) -> Any:
    """Lane k: how many bits of left[:, x] and right[:, x + k] differ, as uint8. Both are (planes, columns) of bytes.

    If the lanes have a `most_level`, the plane after the code holds levels; what these differ by is added, up to that.
    """
    vec = Vec(types.uint8, lanes.count)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        rows = [c.make_array(kind)(c, b, array) for kind, array in zip(sig.args[1:3], a[1:3], strict=True)]
        strides = [b.extract_value(each.shape, 1) for each in rows]

        def of_plane(plane: int) -> tuple[Any, Any]:
            code, codes = (
                b.gep(each.data, [b.add(a[3], b.mul(stride, ir.Constant(WORD, plane)))])
                for each, stride in zip(rows, strides, strict=True)
            )
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

    return vec(lanes, left, right, types.int64), emit
