"""Compiled loops that call the kernel of a force law. Imports numba: import this module inside a verb."""

# pyright: basic

from collections.abc import Callable
from importlib import import_module
from typing import Any, final

import numpy as np
from numba import typeof, types
from numba.core import cgutils
from numba.core.registry import cpu_target
from numba.experimental.function_type import FunctionModel
from numba.extending import NativeValue, register_model, typeof_impl, unbox

from .compiling import KERNEL, njit


class KernelType(types.FunctionType):
    """The type of an `Address` for numba: all kernels of one signature have the same type."""


@final
class Address:
    """A kernel passed to another kernel by its address, so that the caller is compiled once for all similar kernels.

    A kernel passed directly would be compiled into the caller, anew in every process: numba's disk cache does not
    recognise it. The address follows numba's calling convention: by that of C, each call copies all arguments twice.
    """

    def __init__(self, kernel: Callable[..., Any], signature: Any = None) -> None:
        """Take the address of a kernel; signature: for a kernel that was defined without one (see `signature`)."""
        self._kernel: Any = kernel
        if signature is None:
            (signature,) = self._kernel.nopython_signatures
        self.signature: Any = signature
        result = self._kernel.get_compile_result(signature)
        self.address: int = result.library.get_pointer_to_function(result.fndesc.llvm_func_name)

    def __reduce__(self) -> tuple[Any, ...]:
        return _revive, (self._kernel.py_func.__module__, self._kernel.py_func.__qualname__, self.signature)


register_model(KernelType)(FunctionModel)


@typeof_impl.register(Address)
def _numba_type(address: Address, _context: Any) -> KernelType:
    return KernelType(address.signature)


@unbox(KernelType)
def _unbox(kind: Any, address: Any, c: Any) -> NativeValue:
    proxy = cgutils.create_struct_proxy(kind)(c.context, c.builder)
    number = c.pyapi.object_getattr_string(address, "address")
    proxy.c_addr = proxy.py_addr = cgutils.get_null_value(c.context.get_value_type(types.voidptr))
    proxy.jit_addr = c.pyapi.long_as_voidptr(number)
    c.pyapi.decref(number)
    return NativeValue(proxy._getvalue())


def signature(kernel: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """Return the signature of a kernel for such arguments; without one it is compiled for them, or loaded from disk."""
    of_types: Any = typeof(kernel)
    return of_types.get_call_type(cpu_target.typing_context, tuple(map(typeof, arguments)), {})


def _revive(module: str, name: str, signature: Any) -> Address:
    kernel = getattr(import_module(module), name)
    kernel.get_call_template(signature.args, {})
    return Address(kernel, signature)


@njit(**KERNEL)
def step_velocity(positions_m, period_s, i):
    """Return the velocity with which the path reached position i; 0 at the first, and where it is not finite."""
    if i == 0:
        return 0.0, 0.0, 0.0
    vx = (positions_m[i, 0] - positions_m[i - 1, 0]) / period_s
    vy = (positions_m[i, 1] - positions_m[i - 1, 1]) / period_s
    vz = (positions_m[i, 2] - positions_m[i - 1, 2]) / period_s
    return (vx, vy, vz) if np.isfinite(vx) and np.isfinite(vy) and np.isfinite(vz) else (0.0, 0.0, 0.0)


@njit(**KERNEL)
def along(fixed, tick, positions_m, period_s, force_n):
    """Compute the force for every position of a path. (numba warns if an address is the first argument.)"""
    for i in range(positions_m.shape[0]):
        x, y, z = positions_m[i, 0], positions_m[i, 1], positions_m[i, 2]
        vx, vy, vz = step_velocity(positions_m, period_s, i)
        force_n[i, 0], force_n[i, 1], force_n[i, 2] = tick(*fixed, x, y, z, vx, vy, vz)


@njit(**KERNEL)
def over_states(tick, fixed, memory, states, proxy_m, force_n):
    """Compute the proxy (NaN without one) and the force for states (x, y, z, vx, vy, vz), one after another."""
    for i in range(states.shape[0]):
        x, y, z, vx, vy, vz = states[i, 0], states[i, 1], states[i, 2], states[i, 3], states[i, 4], states[i, 5]
        force_n[i, 0], force_n[i, 1], force_n[i, 2] = tick(*fixed, x, y, z, vx, vy, vz)
        px, py, pz = memory[0], memory[1], memory[2]
        proxy_m[i, 0], proxy_m[i, 1], proxy_m[i, 2] = (np.nan, np.nan, np.nan) if np.isnan(pz) else (px, py, pz)
