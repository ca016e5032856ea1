"""SIMD lanes inside numba: one LLVM vector holds the same quantity of many disparities."""

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import NativeValue, intrinsic, models, register_model, typeof_impl, unbox

# Decorator of an intrinsic; callers omit its first parameter, the typing context, which type checkers cannot know.
operation: Any = intrinsic
INDEX: Any = ir.IntType(32)
WORD: Any = ir.IntType(64)


class Lanes:
    """The lane count, bytes of a code, and most that its level counts, as an argument of kernels."""

    def __init__(self, count: int, planes: int = 0, most_level: int = 0) -> None:
        self.count = count
        self.planes = planes
        self.most_level = most_level


class LanesType(types.Type):
    """The numba type of `Lanes`: the numbers are part of the type, the value is empty."""

    def __init__(self, count: int, planes: int, most_level: int) -> None:
        # A kernel is compiled per lane count and found again in the disk cache; intrinsics of a closure would not be.
        self.count = count
        self.planes = planes
        self.most_level = most_level
        super().__init__(name=f"Lanes({count},{planes},{most_level})")


class Vec(types.Type):
    """`count` lanes of one numba scalar type."""

    def __init__(self, element: Any, count: int) -> None:
        self.element = element
        self.count = count
        self.real: bool = isinstance(element, types.Float)
        super().__init__(name=f"Vec({element},{count})")

    @property
    def parts(self) -> "list[tuple[int, Vec]]":
        """The first lane and the vector of each part, a power of two lanes each, the widest first."""
        # LLVM would process one vector of 80 lanes lane by lane, which takes four times as long as 128.
        widths = [1 << i for i in reversed(range(self.count.bit_length())) if self.count >> i & 1]
        return [(sum(widths[:i]), Vec(self.element, lane_count)) for i, lane_count in enumerate(widths)]

    @property
    def llvm(self) -> Any:
        """The machine type: a vector, or a struct of the parts' vectors."""
        element = ir.FloatType() if self.real else ir.IntType(self.element.bitwidth)
        if self.count & (self.count - 1) == 0:
            return ir.VectorType(element, self.count)
        return ir.LiteralStructType([part.llvm for _, part in self.parts])

    @property
    def mangled(self) -> str:
        """The name of this type, if it is one vector, in LLVM's intrinsics."""
        return f"v{self.count}i{self.element.bitwidth}"


register_model(LanesType)(models.OpaqueModel)


@register_model(Vec)
class VecModel(models.PrimitiveModel):
    """The data model of a Vec: its LLVM vector, or its vectors."""

    def __init__(self, manager: Any, vec: Vec) -> None:
        super().__init__(manager, vec, vec.llvm)


@typeof_impl.register(Lanes)
def _typeof_lanes(value: Lanes, context: Any) -> LanesType:
    return LanesType(value.count, value.planes, value.most_level)


@unbox(LanesType)
def _unbox_lanes(kind: LanesType, value: Any, c: Any) -> NativeValue:
    return NativeValue(c.context.get_dummy_value())


def split(b: Any, vec: Vec, value: Any) -> list[Any]:
    """Emit code that splits lanes into their vectors."""
    return [b.extract_value(value, i) for i in range(len(vec.parts))] if len(vec.parts) > 1 else [value]


def join(b: Any, vec: Vec, vectors: Sequence[Any]) -> Any:
    """Emit code that joins vectors into lanes."""
    if len(vectors) == 1:
        return vectors[0]
    value = ir.Constant(vec.llvm, ir.Undefined)
    for i, vector in enumerate(vectors):
        value = b.insert_value(value, vector, i)
    return value


def emit_splat(b: Any, scalar: Any, count: int) -> Any:
    """Emit code for the same scalar in every lane."""
    blank = ir.Constant(ir.VectorType(scalar.type, count), ir.Undefined)
    first = b.insert_element(blank, scalar, ir.Constant(INDEX, 0))
    return b.shuffle_vector(first, blank, ir.Constant(ir.VectorType(INDEX, count), [0] * count))


def emit_call(b: Any, name: str, result: Any, args: Sequence[Any]) -> Any:
    """Emit a call of an LLVM intrinsic."""
    function = b.module.globals.get(name) or ir.Function(
        b.module, ir.FunctionType(result, [arg.type for arg in args]), name
    )
    return b.call(function, args)


def _address(c: Any, b: Any, array_type: Any, array: Any, offset: Any, first: int, part: Vec) -> Any:
    data = c.make_array(array_type)(c, b, array).data
    return b.bitcast(b.gep(data, [b.add(offset, ir.Constant(WORD, first))]), part.llvm.as_pointer())


def _pairwise(emit: Callable[[Any, Vec, Any, Any], Any]) -> Any:
    """Create an intrinsic on two equal vectors, lane by lane."""

    @operation
    def pairwise(typing: Any, x: Vec, y: Vec) -> Any:
        def emit_all(c: Any, b: Any, sig: Any, a: Any) -> Any:
            both = zip(x.parts, split(b, x, a[0]), split(b, x, a[1]), strict=True)
            return join(b, x, [emit(b, part, one, other) for (_, part), one, other in both])

        return x(x, y), emit_all

    return pairwise


def _one_by_one(vec: Vec, result: Vec, emit: Callable[[Any, Any, Any], Any]) -> Any:
    """Return signature and code of an intrinsic on one vector: emit(b, vector, its new type) for each part."""

    def emit_all(c: Any, b: Any, sig: Any, a: Any) -> Any:
        parts = zip(split(b, vec, a[0]), result.parts, strict=True)
        return join(b, result, [emit(b, vector, part.llvm) for vector, (_, part) in parts])

    return result(vec), emit_all


def _from_intrinsic(name: str) -> Any:
    return _pairwise(lambda b, vec, x, y: emit_call(b, f"llvm.{name}.{vec.mangled}", vec.llvm, [x, y]))


# Sum that saturates, 250 + 10 = 255, so that high costs stay high.
saturating_add: Any = _from_intrinsic("uadd.sat")
minimum: Any = _from_intrinsic("umin")
maximum: Any = _from_intrinsic("umax")
add: Any = _pairwise(lambda b, vec, x, y: b.fadd(x, y) if vec.real else b.add(x, y))
subtract: Any = _pairwise(lambda b, vec, x, y: b.fsub(x, y) if vec.real else b.sub(x, y))
multiply: Any = _pairwise(lambda b, vec, x, y: b.fmul(x, y) if vec.real else b.mul(x, y))
# Maximum of floats without NaN, lane by lane.
larger: Any = _pairwise(lambda b, vec, x, y: b.select(b.fcmp_ordered(">", x, y), x, y))


def shuffle(b: Any, vector: Any, other: Any, lanes: Sequence[int]) -> Any:
    """Emit code that picks these lanes of two equal vectors."""
    return b.shuffle_vector(vector, other, ir.Constant(ir.VectorType(INDEX, len(lanes)), list(lanes)))


@operation
def shift_up(typing: Any, vec: Vec, fill: Vec) -> Any:
    """Move lane k - 1 to lane k; lane 0 comes from the second vector."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        vectors, shifted_parts = split(b, vec, a[0]), []
        before, last = split(b, vec, a[1])[0], 0
        for (_, part), vector in zip(vec.parts, vectors, strict=True):
            n = part.count
            fill_lane = shuffle(b, before, before, [last] * n)
            shifted_parts.append(shuffle(b, vector, fill_lane, [n, *range(n - 1)]))
            before, last = vector, n - 1
        return join(b, vec, shifted_parts)

    return vec(vec, fill), emit


@operation
def shift_down(typing: Any, vec: Vec, fill: Vec) -> Any:
    """Move lane k + 1 to lane k; the last lane comes from the second vector."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        vectors, shifted_parts = split(b, vec, a[0]), []
        after = [*vectors[1:], split(b, vec, a[1])[0]]
        for (_, part), vector, following in zip(vec.parts, vectors, after, strict=True):
            n = part.count
            shifted_parts.append(shuffle(b, vector, shuffle(b, following, following, [0] * n), range(1, n + 1)))
        return join(b, vec, shifted_parts)

    return vec(vec, fill), emit


@operation
def width(typing: Any, lanes: LanesType) -> Any:
    """Return the lane count, a compile-time constant."""
    return types.int64(lanes), lambda c, b, sig, a: ir.Constant(WORD, sig.args[0].count)


@operation
def load(typing: Any, lanes: LanesType, array: Any, offset: Any) -> Any:
    """Load lanes from array[offset : offset + n]; their type is that of the array."""
    vec = Vec(array.dtype, lanes.count)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        values = []
        for first, part in vec.parts:
            values.append(b.load(_address(c, b, sig.args[1], a[1], a[2], first, part)))
            values[-1].align = vec.element.bitwidth // 8
        return join(b, vec, values)

    return vec(lanes, array, types.int64), emit


@operation
def store(typing: Any, array: Any, offset: Any, vec: Vec) -> Any:
    """Store lanes to array[offset : offset + n]."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        for (first, part), value in zip(vec.parts, split(b, vec, a[2]), strict=True):
            store_instruction = b.store(value, _address(c, b, sig.args[0], a[0], a[1], first, part))
            store_instruction.align = vec.element.bitwidth // 8
        return c.get_dummy_value()

    return types.void(array, types.int64, vec), emit


@operation
def splat(typing: Any, lanes: LanesType, scalar: Any) -> Any:
    """Fill every lane with a scalar."""
    vec = Vec(scalar, lanes.count)
    return vec(lanes, scalar), lambda c, b, sig, a: join(
        b, vec, [emit_splat(b, a[1], part.count) for _, part in vec.parts]
    )


@operation
def widen(typing: Any, vec: Vec) -> Any:
    """Convert unsigned bytes to 32-bit integers."""
    return _one_by_one(vec, Vec(types.int32, vec.count), lambda b, each, kind: b.zext(each, kind))


@operation
def to_float(typing: Any, vec: Vec) -> Any:
    """Convert signed integers to float32."""
    return _one_by_one(vec, Vec(types.float32, vec.count), lambda b, each, kind: b.sitofp(each, kind))
