"""Checks of a haptic device. A real device pushes for a moment, as hard as it can: let its grip hang free."""

from itertools import pairwise

import numpy as np

from ...data import NO_FORCE, Force
from ...errors import DeviceAbsent, DeviceError
from ...plugins.interfaces import HapticDevice
from ..checks import Check, CheckFailure, checks_in, demand, refuses


class _Mishap(Exception):
    """An exception that a user's program might raise while it holds a device."""


def spec_makes_sense(method: HapticDevice) -> None:
    """Check that there is a specification, whose numbers `DeviceSpec` checks, with 1 to 6 axes."""
    spec = method.spec()
    demand(1 <= spec.axes <= 6 and spec.buttons >= 0, f"{spec.axes} axes and {spec.buttons} buttons")


def absence_is_said(method: HapticDevice) -> None:
    """Check that the device opens, or raises DeviceAbsent with a cure in its message; other checks then do not run."""
    try:
        method.open().close()
    except DeviceAbsent as error:
        demand(";" in str(error) or ", or " in str(error), f"{error}: names no cure; add what the user can do about it")


def no_strange_channel_is_followed(method: HapticDevice) -> None:
    """Check that the device follows at most its own channel: the page would take it for its own hand."""
    demand(method.follows("a channel of no device") is False, "it follows a channel that no device has")


def force_is_applied(method: HapticDevice) -> None:
    """Check that the device applies the force written, within 2 % of its largest force, and none after opening."""
    most = method.spec().max_force_n
    with method.open() as link:
        demand(tuple(link.applied) == NO_FORCE, f"a link just opened applies {link.applied}")
        for force in (Force(0.0, 0.0, most / 4), Force(-most / 8, most / 16, 0.0), NO_FORCE):
            link.write(force)
            apart = float(np.linalg.norm(np.subtract(link.applied, force)))
            demand(apart <= 0.02 * most, f"{force} was written, {link.applied} is applied")


def forces_are_limited(method: HapticDevice) -> None:
    """Check that a force too strong is scaled to the device's largest and keeps its direction; no axis wraps around."""
    most = method.spec().max_force_n
    with method.open() as link:
        for force in (Force(0.0, 0.0, 2 * most), Force(1e3, 2e3, -1e3), Force(-1e308, 1e308, 1e308)):
            link.write(force)
            applied_n = np.array(link.applied)
            size = float(np.linalg.norm(applied_n))
            link.write(NO_FORCE)
            demand(size <= most * (1 + 1e-6), f"{force} leads to {size:.4g} N; the device's limit is {most:g} N")
            demand(size >= 0.9 * most, f"{force} leads to {size:.4g} N; up to {most:g} N can be given")
            ideal = np.array(force) / max(map(abs, force))
            along_n = float(applied_n @ ideal / np.linalg.norm(ideal))
            demand(along_n >= 0.98 * size, f"{force} turns into {applied_n.tolist()} N, another direction")


def broken_force_is_none(method: HapticDevice) -> None:
    """Check that a force with a NaN or infinite part becomes zero, also after a good one: an error must not push."""
    good = Force(0.0, 0.0, method.spec().max_force_n / 4)
    with method.open() as link:
        for bad in (Force(np.nan, 0.0, 0.0), Force(0.1, np.inf, 0.0), Force(0.1, 0.1, -np.inf)):
            link.write(good)
            link.write(bad)
            demand(tuple(link.applied) == NO_FORCE, f"{bad} was written, {link.applied} is applied")


def no_force_is_left_behind(method: HapticDevice) -> None:
    """Check that no force is applied after the `with` block, also after an exception: motors must not go on pushing."""
    push = Force(0.0, 0.0, method.spec().max_force_n / 4)
    with method.open() as link:
        link.write(push)
    demand(tuple(link.applied) == NO_FORCE, f"after the block the device applies {link.applied}")
    try:
        with method.open() as link:
            link.write(push)
            raise _Mishap
    except _Mishap:
        demand(tuple(link.applied) == NO_FORCE, f"after an exception in the block the device applies {link.applied}")
    else:
        raise CheckFailure("an exception in the block is swallowed")


def close_is_final(method: HapticDevice) -> None:
    """Check that closing leaves no force, a second close does nothing, and a closed link raises DeviceError."""
    link = method.open()
    link.write(Force(0.0, 0.0, method.spec().max_force_n / 4))
    link.close()
    link.close()
    demand(tuple(link.applied) == NO_FORCE, f"a closed link applies {link.applied}")
    refuses(DeviceError, "reading a closed link", link.read)
    refuses(DeviceError, "writing to a closed link", lambda: link.write(NO_FORCE))


def device_can_be_opened_again(method: HapticDevice) -> None:
    """Check that a closed device can be opened again, by the same method and by an equal one."""
    for again in (method, method, type(method)(**dict(method))):
        with again.open() as link:
            link.read()


def openers_do_not_share(method: HapticDevice) -> None:
    """Check that a second opener is refused or gets another device, without any effect on the first one's force."""
    push = Force(0.0, 0.0, method.spec().max_force_n / 4)
    with method.open() as first:
        first.write(push)
        try:
            with method.open() as second:
                second.write(NO_FORCE)
        except DeviceError:
            pass
        demand(tuple(first.applied) != NO_FORCE, "a second opener took the force from the first one")
        first.read()


def velocity_is_that_of_the_positions(method: HapticDevice) -> None:
    """Check that velocities are in m/s of the device's clock: over 200 reads they sum to the way of the tip."""
    spec = method.spec()
    with method.open() as link:
        states = [link.read() for _ in range(200)]
    speeds = np.array([state.velocity_m_per_s for state in states])
    steps_s = np.diff([state.time_s for state in states])
    way = np.subtract(states[-1].position_m, states[0].position_m)
    path_m = (0.5 * (speeds[1:] + speeds[:-1]) * steps_s[:, None]).sum(axis=0)
    apart, length = float(np.linalg.norm(path_m - way)), float((np.linalg.norm(speeds[1:], axis=1) * steps_s).sum())
    demand(apart <= 0.1 * length + 10 * spec.resolution_m, f"velocities sum to {path_m} m, the tip moved by {way} m")


def states_make_sense(method: HapticDevice) -> None:
    """Check that time only increases, states are finite, and positions lie within twice the workspace."""
    reach = np.array(method.spec().workspace_m)  # from the centre: half of it is the workspace itself
    with method.open() as link:
        states = [link.read() for _ in range(50)]
    for before, after in pairwise(states):
        demand(after.time_s > before.time_s, f"time stands or goes back: {before.time_s} s, then {after.time_s} s")
    for state in states:
        finite = np.isfinite((*state.position_m, *state.velocity_m_per_s, state.time_s)).all()
        demand(finite, f"a state is not finite: {state}")
        demand((np.abs(state.position_m) <= reach).all(), f"{state.position_m} m is far outside of {reach.tolist()} m")


CHECKS: tuple[Check, ...] = checks_in(__name__)
WITH_MOTORS = CHECKS[3:]  # the checks that open the device, most of them to push
