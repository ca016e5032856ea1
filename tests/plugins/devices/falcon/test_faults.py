"""A Falcon would keep a force when its USB fails at any step, tell no cure, or not open again."""

import logging
from collections.abc import Iterator

import pytest

from falcon_bus import held_bus, open_on
from tangible_core.data import NO_FORCE, Force
from tangible_core.errors import DeviceError
from tangible_devices.falcon.simulator.bus import Bus
from tangible_devices.falcon.simulator.chip import SimulatedClock
from tangible_devices.falcon.simulator.faults import ERRORS, Fault

WORDS = {
    "unplugged": "it was unplugged; check its plug",
    "access-denied": 'TAG\\+="uaccess"\nthen run `sudo udevadm',
    "busy": "another program is using it",
    "timeout": "does not answer \\(time-out\\)",
    "stall": "refused the request \\(stall\\)",
    "overflow": "sent more than was requested \\(overflow\\)",
}
CALLS = ("read", "write", "exchange")
PUSH = Force(0.0, 0.0, 3.0)
OPENING = [
    *[("look", 0), ("open", 0), ("configure", 0), ("configure", 1), ("driver", 0), ("driver", 1), ("claim", 0)],
    *[("control", nth) for nth in (0, 1, 3, 4, 9, 12, 14, 17)],
    *[("write", nth) for nth in (0, 10, 11, 12, 80, 300, 1100)],
    *[("read", nth) for nth in (0, 60, 61, 63, 80, 300, 1100)],
]


def opening_faults() -> Iterator[object]:
    """Yield every error at every place; by day each error once at each kind of place, and each place once."""
    for kind in dict(OPENING):
        places = [after for at, after in OPENING if at == kind]
        for row, after in enumerate(places):
            for column, error in enumerate(ERRORS):
                by_day = row % len(ERRORS) == column or column % len(places) == row
                yield pytest.param(kind, after, error, marks=() if by_day else pytest.mark.nightly)


def running_faults() -> Iterator[object]:
    """Yield every error of every transfer under every call; by day each error of a transfer under one call."""
    for shift, at in enumerate(("write", "read")):
        for row, error in enumerate(ERRORS):
            for column, call in enumerate(CALLS):
                by_day = (row + shift) % len(CALLS) == column
                yield pytest.param(at, error, call, marks=() if by_day else pytest.mark.nightly)


def check_at_rest(bus: Bus) -> None:
    unit = bus.units[0]
    assert unit.chip.processor.body.torque_counts == (0, 0, 0)
    assert unit.claimed_by is None
    assert unit.kernel_driver or not unit.plugged


def check_opens_again(bus: Bus, clock: SimulatedClock) -> None:
    bus.faults.clear()
    if not bus.units[0].plugged or not bus.units[0].kernel_driver:
        bus.units[0].plug_in()
    with open_on(bus, clock) as link:
        link.write(PUSH)
        link.read()
        assert link.applied == pytest.approx(PUSH)
    check_at_rest(bus)


def loud(caplog: pytest.LogCaptureFixture) -> list[str]:
    """Warnings, but for the guide to homing."""
    return [
        record.message
        for record in caplog.records
        if record.levelno >= logging.WARNING and "pull its" not in record.message
    ]


@pytest.mark.parametrize(("at", "after", "error"), list(opening_faults()))
def test_fault_while_opening_leaves_no_force_and_one_message(
    at: str, after: int, error: str, caplog: pytest.LogCaptureFixture
):
    bus, clock = held_bus(faults=(Fault(at=at, after=after, error=error),))  # pyright: ignore[reportArgumentType]
    with pytest.raises(DeviceError, match=WORDS[error]):
        open_on(bus, clock)
    assert not loud(caplog)
    check_at_rest(bus)
    check_opens_again(bus, clock)


@pytest.mark.parametrize(("at", "error", "call"), list(running_faults()))
def test_fault_while_running_leaves_no_force_and_one_message(
    at: str, error: str, call: str, caplog: pytest.LogCaptureFixture
):
    bus, clock = held_bus()
    with pytest.raises(DeviceError, match=WORDS[error]), open_on(bus, clock) as link:
        link.write(PUSH)
        assert bus.units[0].chip.processor.body.torque_counts != (0, 0, 0)
        bus.fail(Fault(at=at, error=error))  # pyright: ignore[reportArgumentType]
        for _ in range(5):
            {"read": link.read, "write": lambda: link.write(PUSH), "exchange": link.exchange}[call]()
            link.exchange()
    assert link.applied == NO_FORCE
    assert not loud(caplog)
    check_at_rest(bus)
    with pytest.raises(DeviceError, match="was closed after an error"):
        link.read()
    check_opens_again(bus, clock)


@pytest.mark.parametrize("error", list(ERRORS))
@pytest.mark.parametrize("at", ["write", "read", "driver"])
def test_fault_while_closing_is_a_warning_at_most(at: str, error: str, caplog: pytest.LogCaptureFixture):
    bus, clock = held_bus()
    link = open_on(bus, clock)
    link.write(PUSH)
    bus.fail(Fault(at=at, error=error))  # pyright: ignore[reportArgumentType]
    link.close()
    assert link.applied == NO_FORCE
    assert len(loud(caplog)) == (at != "driver")
    check_opens_again(bus, clock)


def test_fault_does_not_hide_the_user_s_exception():
    bus, clock = held_bus()
    with pytest.raises(ZeroDivisionError), open_on(bus, clock) as link:
        link.write(PUSH)
        bus.fail(Fault(at="write", error="unplugged"))
        raise ZeroDivisionError
    check_at_rest(bus)
    check_opens_again(bus, clock)


def test_ctrl_c_while_homing_leaves_no_force(monkeypatch: pytest.MonkeyPatch):
    bus, clock = held_bus()
    transfers = iter(range(10**6))

    def interrupted(handle: object, step: object) -> None:
        if next(transfers) == 900:
            raise KeyboardInterrupt

    monkeypatch.setattr(bus, "_step", interrupted)
    with pytest.raises(KeyboardInterrupt):
        open_on(bus, clock)
    monkeypatch.undo()
    check_at_rest(bus)
    check_opens_again(bus, clock)
