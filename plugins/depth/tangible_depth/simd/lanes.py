"""SIMD lanes inside numba: one LLVM vector holds the same quantity for many disparities at once.

`Vec(element, n)` is a numba type whose machine form is the LLVM vector `<n x element>`. The lane count travels as a
type: Python passes `Lanes(64)`, numba sees `LanesType(64)`, so that one module-level kernel is compiled per lane count
and found again in numba's disk cache by the next process (intrinsics made inside a closure would not be).
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
    return LanesType(value.count, value.planes, value.most_level)


@unbox(LanesType)
def _unbox_lanes(kind: LanesType, value: Any, c: Any) -> NativeValue:
    return NativeValue(c.context.get_dummy_value())


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


def _address(c: Any, b: Any, array_type: Any, array: Any, offset: Any, vec: Vec) -> Any:
    data = c.make_array(array_type)(c, b, array).data
    return b.bitcast(b.gep(data, [offset]), vec.llvm.as_pointer())


def _pairwise(emit: Callable[[Any, Vec, Any, Any], Any]) -> Any:
    """An intrinsic on two equal vectors."""

    @operation
    def pairwise(typing: Any, x: Vec, y: Vec) -> Any:
        return x(x, y), lambda c, b, sig, a: emit(b, sig.return_type, a[0], a[1])

    return pairwise


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


@operation
def width(typing: Any, lanes: LanesType) -> Any:
    """The lane count, a constant to the compiler."""
    return types.int64(lanes), lambda c, b, sig, a: ir.Constant(WORD, sig.args[0].count)


@operation
def load(typing: Any, lanes: LanesType, array: Any, offset: Any) -> Any:
    """Lanes from array[offset : offset + n]; the array's type decides the lanes' type."""
    vec = Vec(array.dtype, lanes.count)

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        value = b.load(_address(c, b, sig.args[1], a[1], a[2], vec))
        value.align = vec.element.bitwidth // 8
        return value

    return vec(lanes, array, types.int64), emit


@operation
def store(typing: Any, array: Any, offset: Any, vec: Vec) -> Any:
    """array[offset : offset + n] = lanes."""

    def emit(c: Any, b: Any, sig: Any, a: Any) -> Any:
        stored = b.store(a[2], _address(c, b, sig.args[0], a[0], a[1], sig.args[2]))
        stored.align = sig.args[2].element.bitwidth // 8
        return c.get_dummy_value()

    return types.void(array, types.int64, vec), emit


@operation
def splat(typing: Any, lanes: LanesType, scalar: Any) -> Any:
    """The same scalar in every lane."""
    return Vec(scalar, lanes.count)(lanes, scalar), lambda c, b, sig, a: emit_splat(b, a[1], sig.return_type.count)


@operation
def widened(typing: Any, vec: Vec) -> Any:
    """Unsigned bytes as 32-bit integers."""
    wide = Vec(types.int32, vec.count)
    return wide(vec), lambda c, b, sig, a: b.zext(a[0], sig.return_type.llvm)


@operation
def to_float(typing: Any, vec: Vec) -> Any:
    """Signed integers as float32."""
    real = Vec(types.float32, vec.count)
    return real(vec), lambda c, b, sig, a: b.sitofp(a[0], sig.return_type.llvm)
