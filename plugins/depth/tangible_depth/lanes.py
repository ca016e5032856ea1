"""SIMD lanes inside numba: one LLVM vector holds the same quantity for many disparities at once.

`Vec(element, n)` is a numba type whose machine form is the LLVM vector `<n x element>`. The lane count travels as a
type: Python passes `Lanes(64)`, numba sees `LanesType(64)`, so that one module-level kernel is compiled per lane count
and found again in numba's disk cache by the next process (intrinsics made inside a closure would not be).
"""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import NativeValue, intrinsic, models, register_model, typeof_impl, unbox

INDEX = ir.IntType(32)
WORD = ir.IntType(64)


class Lanes:
    """A lane count, and how many bytes a code has, as an argument for kernels."""

    def __init__(self, count: int, planes: int = 0) -> None:
        self.count, self.planes = count, planes


class LanesType(types.Type):
    """The numba type of `Lanes`: the numbers are part of the type, the value is empty."""

    def __init__(self, count: int, planes: int) -> None:
        self.count, self.planes = count, planes
        super().__init__(name=f"Lanes({count},{planes})")


class Vec(types.Type):
    """`count` lanes of one numba scalar type."""

    def __init__(self, element: Any, count: int) -> None:
        self.element, self.count = element, count
        self.real = isinstance(element, types.Float)
        super().__init__(name=f"Vec({element},{count})")

    @property
    def llvm(self) -> ir.VectorType:
        """The machine type."""
        return ir.VectorType(ir.FloatType() if self.real else ir.IntType(self.element.bitwidth), self.count)

    @property
    def mangled(self) -> str:
        """How LLVM names this type in its intrinsics."""
        return f"v{self.count}i{self.element.bitwidth}"


register_model(LanesType)(models.OpaqueModel)


@register_model(Vec)
class VecModel(models.PrimitiveModel):
    """A Vec is its LLVM vector."""

    def __init__(self, manager: Any, vec: Vec) -> None:
        super().__init__(manager, vec, vec.llvm)


@typeof_impl.register(Lanes)
def _typeof_lanes(value: Lanes, context: Any) -> LanesType:
    return LanesType(value.count, value.planes)


@unbox(LanesType)
def _unbox_lanes(kind: LanesType, value: Any, c: Any) -> NativeValue:
    return NativeValue(c.context.get_dummy_value())


def _splat(b: Any, scalar: Any, count: int) -> Any:
    blank = ir.Constant(ir.VectorType(scalar.type, count), ir.Undefined)
    first = b.insert_element(blank, scalar, ir.Constant(INDEX, 0))
    return b.shuffle_vector(first, blank, ir.Constant(ir.VectorType(INDEX, count), [0] * count))


def _call(b: Any, name: str, result: Any, args: list[Any]) -> Any:
    function = b.module.globals.get(name) or ir.Function(
        b.module, ir.FunctionType(result, [each.type for each in args]), name
    )
    return b.call(function, args)


def _address(c: Any, b: Any, array_type: Any, array: Any, offset: Any, vec: Vec) -> Any:
    data = c.make_array(array_type)(c, b, array).data
    return b.bitcast(b.gep(data, [offset]), vec.llvm.as_pointer())


def _first_set(b: Any, hits: Any, count: int) -> Any:
    """Index, as a 64-bit integer, of the first true lane."""
    mask = ir.IntType(count)
    index = _call(b, f"llvm.cttz.i{count}", mask, [b.bitcast(hits, mask), ir.Constant(ir.IntType(1), 1)])
    return b.trunc(index, WORD) if count > 64 else b.zext(index, WORD) if count < 64 else index


def _pairwise(emit: Callable[[Any, Vec, Any, Any], Any]) -> Any:
    """An intrinsic on two equal vectors."""

    @intrinsic
    def operation(typing: Any, x: Vec, y: Vec) -> Any:
        return x(x, y), lambda c, b, sig, a: emit(b, sig.return_type, a[0], a[1])

    return operation


def _named(name: str) -> Any:
    return _pairwise(lambda b, vec, x, y: _call(b, f"llvm.{name}.{vec.mangled}", vec.llvm, [x, y]))


saturating_add = _named("uadd.sat")
"""250 + 10 = 255: losers stay losers."""
minimum = _named("umin")
maximum = _named("umax")
add = _pairwise(lambda b, vec, x, y: b.fadd(x, y) if vec.real else b.add(x, y))
subtract = _pairwise(lambda b, vec, x, y: b.fsub(x, y) if vec.real else b.sub(x, y))
multiply = _pairwise(lambda b, vec, x, y: b.fmul(x, y) if vec.real else b.mul(x, y))
larger = _pairwise(lambda b, vec, x, y: b.select(b.fcmp_ordered(">", x, y), x, y))
"""The larger of two vectors of floats, free of NaN."""
shift_up = _pairwise(
    lambda b, vec, x, fill: b.shuffle_vector(
        x, fill, ir.Constant(ir.VectorType(INDEX, vec.count), [vec.count, *range(vec.count - 1)])
    )
)
"""Lane k takes lane k - 1; lane 0 comes from the second vector."""
shift_down = _pairwise(
    lambda b, vec, x, fill: b.shuffle_vector(
        x, fill, ir.Constant(ir.VectorType(INDEX, vec.count), list(range(1, vec.count + 1)))
    )
)
"""Lane k takes lane k + 1; the last lane comes from the second vector."""


@intrinsic
def width(typing: Any, lanes: LanesType) -> Any:
    """The lane count, a constant to the compiler."""
    return types.int64(lanes), lambda c, b, sig, a: ir.Constant(WORD, sig.args[0].count)


@intrinsic
def load(typing: Any, lanes: LanesType, array: Any, offset: Any) -> Any:
    """Lanes from array[offset : offset + n]; the array's type decides the lanes' type."""
    vec = Vec(array.dtype, lanes.count)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        value = b.load(_address(c, b, sig.args[1], a[1], a[2], vec))
        value.align = vec.element.bitwidth // 8
        return value

    return vec(lanes, array, types.int64), emit


@intrinsic
def store(typing: Any, array: Any, offset: Any, vec: Vec) -> Any:
    """array[offset : offset + n] = lanes."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        stored = b.store(a[2], _address(c, b, sig.args[0], a[0], a[1], sig.args[2]))
        stored.align = sig.args[2].element.bitwidth // 8
        return c.get_dummy_value()

    return types.void(array, types.int64, vec), emit


@intrinsic
def splat(typing: Any, lanes: LanesType, scalar: Any) -> Any:
    """The same scalar in every lane."""
    return Vec(scalar, lanes.count)(lanes, scalar), lambda c, b, sig, a: _splat(b, a[1], sig.return_type.count)


@intrinsic
def widened(typing: Any, vec: Vec) -> Any:
    """Unsigned bytes as 32-bit integers."""
    wide = Vec(types.int32, vec.count)
    return wide(vec), lambda c, b, sig, a: b.zext(a[0], sig.return_type.llvm)


@intrinsic
def to_float(typing: Any, vec: Vec) -> Any:
    """Signed integers as float32."""
    real = Vec(types.float32, vec.count)
    return real(vec), lambda c, b, sig, a: b.sitofp(a[0], sig.return_type.llvm)


@intrinsic
def first_lane(typing: Any, vec: Vec) -> Any:
    """Lane 0."""
    return vec.element(vec), lambda c, b, sig, a: b.extract_element(a[0], ir.Constant(INDEX, 0))


@intrinsic
def lowest(typing: Any, vec: Vec) -> Any:
    """The smallest lane of unsigned integers."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        kind = sig.args[0]
        return _call(b, f"llvm.vector.reduce.umin.{kind.mangled}", kind.llvm.element, a)

    return vec.element(vec), emit


@intrinsic
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


@intrinsic
def first_equal(typing: Any, vec: Vec, scalar: Any) -> Any:
    """Index of the first lane equal to the scalar, which must occur."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        kind = sig.args[0]
        compare = b.fcmp_ordered if kind.real else b.icmp_unsigned
        return _first_set(b, compare("==", a[0], _splat(b, a[1], kind.count)), kind.count)

    return types.int64(vec, vec.element), emit


@intrinsic
def hamming(typing: Any, lanes: LanesType, left: Any, right: Any, x: Any) -> Any:
    """Lane k: how many bits of left[:, x] and right[:, x + k] differ, as uint8. Both are (planes, columns) of bytes."""
    vec = Vec(types.uint8, lanes.count)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        rows = [c.make_array(kind)(c, b, array) for kind, array in zip(sig.args[1:3], a[1:3], strict=True)]
        strides = [b.extract_value(each.shape, 1) for each in rows]
        total = ir.Constant(vec.llvm, [0] * vec.count)
        for plane in range(sig.args[0].planes):
            code, codes = (
                b.gep(each.data, [b.add(a[3], b.mul(stride, ir.Constant(WORD, plane)))])
                for each, stride in zip(rows, strides, strict=True)
            )
            others = b.load(b.bitcast(codes, vec.llvm.as_pointer()))
            others.align = 1
            differing = b.xor(others, _splat(b, b.load(code), vec.count))
            total = b.add(total, _call(b, f"llvm.ctpop.{vec.mangled}", vec.llvm, [differing]))
        return total

    return vec(lanes, left, right, types.int64), emit
