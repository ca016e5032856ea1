"""Prefetching of memory that will be read soon; compiled.

Imports numba: a method imports this module inside its verb.
"""

# ruff: noqa: ANN001, ANN202 -- the types are those that numba infers
# pyright: basic

from typing import Any

from llvmlite import ir
from numba import int64, types
from numba.extending import intrinsic

BYTE: Any = ir.IntType(8).as_pointer()
FLAG: Any = ir.IntType(32)
READ, KEEP, DATA = 0, 3, 1
"""The flags of LLVM's prefetch: for reading, into all levels of the cache, data rather than instructions."""


@intrinsic
def prefetch_line(context: Any, array: Any, offset: Any) -> Any:
    """Prefetch the cache line at a byte offset into an array; it neither waits nor fails."""

    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        at = builder.gep(builder.bitcast(data, BYTE), [arguments[1]])
        kind = ir.FunctionType(ir.VoidType(), [BYTE, FLAG, FLAG, FLAG])
        prefetch = builder.module.declare_intrinsic("llvm.prefetch", [BYTE], kind)
        builder.call(prefetch, [at, *(ir.Constant(FLAG, each) for each in (READ, KEEP, DATA))])
        return context.get_dummy_value()

    return types.void(array, int64), generate
