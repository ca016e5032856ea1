"""What calls a law again and again, compiled. Imports numba: what uses this module imports it inside its verb."""

# ruff: noqa: ANN001, ANN201 -- the types are those that numba infers
# pyright: basic

from collections.abc import Callable
from typing import Any, final

import numpy as np
from numba import njit, types

from . import compiling as compiling


@final
class Address(types.WrapperAddressProtocol):
    """A kernel as an argument of another: by its address, so that the caller is compiled once for all kernels alike.

    A kernel given as it is would be compiled into the caller, anew in every process: numba's disk cache does not know
    it again.
    """

    def __init__(self, kernel: Callable[..., Any]) -> None:
        self._kernel: Any = kernel
        (self._signature,) = self._kernel.nopython_signatures

    def signature(self) -> Any:
        """The one that the kernel was compiled for."""
        return self._signature

    def __wrapper_address__(self) -> int:
        """Of the compiled code, for a caller by C's rules."""
        compiled = self._kernel.get_compile_result(self._signature)
        return compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)


@njit(cache=True, nogil=True, error_model="numpy")
def step_velocity(positions_m, period_s, i):
    """Velocity that brought the path to position i, one period after the one before it.

    0 at the first position, and where it is not finite.
    """
    if i == 0:
        return 0.0, 0.0, 0.0
    vx = (positions_m[i, 0] - positions_m[i - 1, 0]) / period_s
    vy = (positions_m[i, 1] - positions_m[i - 1, 1]) / period_s
    vz = (positions_m[i, 2] - positions_m[i - 1, 2]) / period_s
    return (vx, vy, vz) if np.isfinite(vx) and np.isfinite(vy) and np.isfinite(vz) else (0.0, 0.0, 0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def along(tick, fixed, positions_m, period_s, force_n):
    """The law's force for every position of a path."""
    for i in range(positions_m.shape[0]):
        x, y, z = positions_m[i, 0], positions_m[i, 1], positions_m[i, 2]
        vx, vy, vz = step_velocity(positions_m, period_s, i)
        force_n[i, 0], force_n[i, 1], force_n[i, 2] = tick(*fixed, x, y, z, vx, vy, vz)


@njit(cache=True, nogil=True, error_model="numpy")
def over_states(tick, fixed, memory, states, proxy_m, force_n):
    """The law's proxy, NaN where there is none, and force for states (x, y, z, vx, vy, vz), one after another."""
    for i in range(states.shape[0]):
        x, y, z, vx, vy, vz = states[i, 0], states[i, 1], states[i, 2], states[i, 3], states[i, 4], states[i, 5]
        force_n[i, 0], force_n[i, 1], force_n[i, 2] = tick(*fixed, x, y, z, vx, vy, vz)
        px, py, pz = memory[0], memory[1], memory[2]
        proxy_m[i, 0], proxy_m[i, 1], proxy_m[i, 2] = (np.nan, np.nan, np.nan) if np.isnan(pz) else (px, py, pz)
