"""The kernels of `Circling`. Imports numba: `loop_devices` imports it late."""


# pyright: basic

from numba import float64, int64, njit, void

from tangible_core.compiled.compiling import KERNEL

FIXED = (float64[:, ::1], float64, int64[::1], float64[::1])


@njit(int64(*FIXED, float64[::1]), **KERNEL)
def read(wheel_m, z_m, steps, force_n, state):
    """Write the next place on the circle to `state`."""
    place = wheel_m[steps[0] % wheel_m.shape[0]]
    steps[0] += 1
    state[0], state[1], state[2] = place[0], place[1], z_m
    return 1


@njit(void(*FIXED, float64, float64, float64), **KERNEL)
def write(wheel_m, z_m, steps, force_n, fx, fy, fz):
    """Hold this force."""
    force_n[0], force_n[1], force_n[2] = fx, fy, fz
