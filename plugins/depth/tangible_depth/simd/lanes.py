"""SIMD lanes inside numba: one LLVM vector holds the same quantity for many disparities at once.

`Vec(element, n)` is a numba type whose machine form is the LLVM vector `<n x element>`. The lane count travels as a
type: Python passes `Lanes(64)`, numba sees `LanesType(64)`, so that one module-level kernel is compiled per lane count
and found again in numba's disk cache by the next process (intrinsics made inside a closure would not be).

A count that is no power of two is held as several vectors that are, side by side: LLVM would take one of 80 lanes apart
lane by lane, which is four times the work of 128.
"""

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import NativeValue, intrinsic, models, register_model, typeof_impl, unbox

operation: Any = intrinsic
"""Called without the typing context that the function itself takes first, which type checkers cannot know."""
INDEX = ir.IntType(32)
WORD = ir.IntType(64)


class Lanes:
    """A lane count, how many bytes a code has, and up to what a level beside it counts: an argument for kernels."""

    def __init__(self, count: int, planes: int = 0, most_level: int = 0) -> None:
        self.count, self.planes, self.most_level = count, planes, most_level


class LanesType(types.Type):
    """The numba type of `Lanes`: the numbers are part of the type, the value is empty."""

    def __init__(self, count: int, planes: int, most_level: int) -> None:
        self.count, self.planes, self.most_level = count, planes, most_level
        super().__init__(name=f"Lanes({count},{planes},{most_level})")


class Vec(types.Type):
    """`count` lanes of one numba scalar type."""

    def __init__(self, element: Any, count: int) -> None:
        self.element, self.count = element, count
        self.real = isinstance(element, types.Float)
        super().__init__(name=f"Vec({element},{count})")

    @property
    def parts(self) -> "list[tuple[int, Vec]]":
        """First lane and vector of each part, of a power of two of lanes each, the widest first."""
        widths = [1 << i for i in reversed(range(self.count.bit_length())) if self.count >> i & 1]
        return [(sum(widths[:i]), Vec(self.element, each)) for i, each in enumerate(widths)]

    @property
    def llvm(self) -> ir.VectorType | ir.LiteralStructType:
        """The machine type: a vector, or one of each part."""
        element = ir.FloatType() if self.real else ir.IntType(self.element.bitwidth)
        if self.count & (self.count - 1) == 0:
            return ir.VectorType(element, self.count)
        return ir.LiteralStructType([part.llvm for _, part in self.parts])

    @property
    def mangled(self) -> str:
        """How LLVM names this type, if it is one vector, in its intrinsics."""
        return f"v{self.count}i{self.element.bitwidth}"


register_model(LanesType)(models.OpaqueModel)


@register_model(Vec)
class VecModel(models.PrimitiveModel):
    """A Vec is its LLVM vector, or its vectors."""

    def __init__(self, manager: Any, vec: Vec) -> None:
        super().__init__(manager, vec, vec.llvm)


@typeof_impl.register(Lanes)
def _typeof_lanes(value: Lanes, context: Any) -> LanesType:
    return LanesType(value.count, value.planes, value.most_level)


@unbox(LanesType)
def _unbox_lanes(kind: LanesType, value: Any, c: Any) -> NativeValue:
    return NativeValue(c.context.get_dummy_value())


def parted(b: Any, vec: Vec, value: Any) -> list[Any]:
    """Machine code: the vectors that lanes consist of."""
    return [b.extract_value(value, i) for i in range(len(vec.parts))] if len(vec.parts) > 1 else [value]


def joined(b: Any, vec: Vec, vectors: Sequence[Any]) -> Any:
    """Machine code: lanes from the vectors that they consist of."""
    if len(vectors) == 1:
        return vectors[0]
    value = ir.Constant(vec.llvm, ir.Undefined)
    for i, each in enumerate(vectors):
        value = b.insert_value(value, each, i)
    return value


def emit_splat(b: Any, scalar: Any, count: int) -> Any:
    """Machine code: the same scalar in every lane."""
    blank = ir.Constant(ir.VectorType(scalar.type, count), ir.Undefined)
    first = b.insert_element(blank, scalar, ir.Constant(INDEX, 0))
    return b.shuffle_vector(first, blank, ir.Constant(ir.VectorType(INDEX, count), [0] * count))


def emit_call(b: Any, name: str, result: Any, args: Sequence[Any]) -> Any:
    """Machine code: a call of an LLVM intrinsic."""
    function = b.module.globals.get(name) or ir.Function(
        b.module, ir.FunctionType(result, [each.type for each in args]), name
    )
    return b.call(function, args)


def _address(c: Any, b: Any, array_type: Any, array: Any, offset: Any, first: int, part: Vec) -> Any:
    data = c.make_array(array_type)(c, b, array).data
    return b.bitcast(b.gep(data, [b.add(offset, ir.Constant(WORD, first))]), part.llvm.as_pointer())


def _pairwise(emit: Callable[[Any, Vec, Any, Any], Any]) -> Any:
    """An intrinsic on two equal vectors, lane by lane."""

    @operation
    def pairwise(typing: Any, x: Vec, y: Vec) -> Any:
        def emit_all(c: Any, b: Any, sig: Any, a: Any) -> Any:
            both = zip(x.parts, parted(b, x, a[0]), parted(b, x, a[1]), strict=True)
            return joined(b, x, [emit(b, part, one, other) for (_, part), one, other in both])

        return x(x, y), emit_all

    return pairwise


def _one_by_one(vec: Vec, result: Vec, emit: Callable[[Any, Any, Any], Any]) -> Any:
    """What an intrinsic on one vector returns: emit(b, vector, its new type) for each part."""

    def emit_all(c: Any, b: Any, sig: Any, a: Any) -> Any:
        parts = zip(parted(b, vec, a[0]), result.parts, strict=True)
        return joined(b, result, [emit(b, each, part.llvm) for each, (_, part) in parts])

    return result(vec), emit_all


def _named(name: str) -> Any:
    return _pairwise(lambda b, vec, x, y: emit_call(b, f"llvm.{name}.{vec.mangled}", vec.llvm, [x, y]))


saturating_add = _named("uadd.sat")
"""250 + 10 = 255: losers stay losers."""
minimum = _named("umin")
maximum = _named("umax")
add = _pairwise(lambda b, vec, x, y: b.fadd(x, y) if vec.real else b.add(x, y))
subtract = _pairwise(lambda b, vec, x, y: b.fsub(x, y) if vec.real else b.sub(x, y))
multiply = _pairwise(lambda b, vec, x, y: b.fmul(x, y) if vec.real else b.mul(x, y))
larger = _pairwise(lambda b, vec, x, y: b.select(b.fcmp_ordered(">", x, y), x, y))
"""The larger of two vectors of floats, free of NaN."""


def shuffled(b: Any, vector: Any, other: Any, lanes: Sequence[int]) -> Any:
    """Machine code: these lanes of two equal vectors side by side."""
    return b.shuffle_vector(vector, other, ir.Constant(ir.VectorType(INDEX, len(lanes)), list(lanes)))


@operation
def shift_up(typing: Any, vec: Vec, fill: Vec) -> Any:
    """Lane k takes lane k - 1; lane 0 comes from the second vector."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        vectors, moved = parted(b, vec, a[0]), []
        before, last = parted(b, vec, a[1])[0], 0
        for (_, part), each in zip(vec.parts, vectors, strict=True):
            n = part.count
            carried = shuffled(b, before, before, [last] * n)
            moved.append(shuffled(b, each, carried, [n, *range(n - 1)]))
            before, last = each, n - 1
        return joined(b, vec, moved)

    return vec(vec, fill), emit


@operation
def shift_down(typing: Any, vec: Vec, fill: Vec) -> Any:
    """Lane k takes lane k + 1; the last lane comes from the second vector."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        vectors, moved = parted(b, vec, a[0]), []
        after = [*vectors[1:], parted(b, vec, a[1])[0]]
        for (_, part), each, following in zip(vec.parts, vectors, after, strict=True):
            n = part.count
            moved.append(shuffled(b, each, shuffled(b, following, following, [0] * n), range(1, n + 1)))
        return joined(b, vec, moved)

    return vec(vec, fill), emit


@operation
def width(typing: Any, lanes: LanesType) -> Any:
    """The lane count, a constant to the compiler."""
    return types.int64(lanes), lambda c, b, sig, a: ir.Constant(WORD, sig.args[0].count)


@operation
def load(typing: Any, lanes: LanesType, array: Any, offset: Any) -> Any:
    """Lanes from array[offset : offset + n]; the array's type decides the lanes' type."""
    vec = Vec(array.dtype, lanes.count)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        values = []
        for first, part in vec.parts:
            values.append(b.load(_address(c, b, sig.args[1], a[1], a[2], first, part)))
            values[-1].align = vec.element.bitwidth // 8
        return joined(b, vec, values)

    return vec(lanes, array, types.int64), emit


@operation
def store(typing: Any, array: Any, offset: Any, vec: Vec) -> Any:
    """array[offset : offset + n] = lanes."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        for (first, part), value in zip(vec.parts, parted(b, vec, a[2]), strict=True):
            stored = b.store(value, _address(c, b, sig.args[0], a[0], a[1], first, part))
            stored.align = vec.element.bitwidth // 8
        return c.get_dummy_value()

    return types.void(array, types.int64, vec), emit


@operation
def splat(typing: Any, lanes: LanesType, scalar: Any) -> Any:
    """The same scalar in every lane."""
    vec = Vec(scalar, lanes.count)
    return vec(lanes, scalar), lambda c, b, sig, a: joined(
        b, vec, [emit_splat(b, a[1], part.count) for _, part in vec.parts]
    )


@operation
def widened(typing: Any, vec: Vec) -> Any:
    """Unsigned bytes as 32-bit integers."""
    return _one_by_one(vec, Vec(types.int32, vec.count), lambda b, each, kind: b.zext(each, kind))


@operation
def to_float(typing: Any, vec: Vec) -> Any:
    """Signed integers as float32."""
    return _one_by_one(vec, Vec(types.float32, vec.count), lambda b, each, kind: b.sitofp(each, kind))
