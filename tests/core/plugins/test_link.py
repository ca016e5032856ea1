"""The safety of every driver. Otherwise a force over the limit would reach a hand, or one be left behind at the end."""

import logging
import math

import pytest

from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import Link

PUSH = Force(0.0, 3.0, 4.0)


class Bare(Link):
    """A driver without checks of its own, which records every command."""

    def __init__(self, max_force_n: float = 5.0) -> None:
        super().__init__("the bare device", max_force_n)
        self.commands: list[Force | str] = []
        self.fails: BaseException | None = None

    def _read(self) -> HapticState:
        return HapticState((0.0, 0.0, 0.0))

    def _send(self, force: Force) -> None:
        self.commands.append(force)
        if self.fails:
            raise self.fails

    @property
    def applied(self) -> Force:
        return next((command for command in reversed(self.commands) if isinstance(command, Force)), NO_FORCE)

    def _release(self) -> None:
        self.commands.append("released")


class TestForce:
    def test_force_up_to_the_limit_is_sent_unchanged(self):
        link = Bare()
        link.write(PUSH)
        assert link.commands == [PUSH]

    @pytest.mark.parametrize("times", [1.0001, 100.0, 1e300])
    def test_force_over_the_limit_is_scaled_down(self, times: float):
        link = Bare()
        link.write(Force(0.0, 3.0 * times, 4.0 * times))
        assert link.applied == pytest.approx(PUSH)

    @pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_force_not_finite_is_sent_as_zero(self, bad: float, axis: int):
        link = Bare()
        link.write(PUSH)
        link.write(Force(*[bad if each == axis else 0.1 for each in range(3)]))
        assert link.commands == [PUSH, NO_FORCE]


class TestEnd:
    def test_close_sends_zero_and_releases_once(self):
        link = Bare()
        link.write(PUSH)
        link.close()
        link.close()
        assert link.commands == [PUSH, NO_FORCE, "released"]

    @pytest.mark.parametrize("error", [None, ZeroDivisionError, KeyboardInterrupt])
    def test_block_with_any_error_sends_zero_and_releases(self, error: type[BaseException] | None):
        link = Bare()
        try:
            with link as opened:
                assert opened is link
                link.write(PUSH)
                if error:
                    raise error
        except (ZeroDivisionError, KeyboardInterrupt) as raised:
            assert type(raised) is error
        else:
            assert error is None
        assert link.commands == [PUSH, NO_FORCE, "released"]

    def test_block_with_a_closed_link_releases_once(self):
        with Bare() as link:
            link.close()
        assert link.commands == [NO_FORCE, "released"]

    @pytest.mark.parametrize("ask", [Link.read, lambda link: link.write(PUSH), lambda link: link._check_open()])
    def test_closed_link_is_refused_in_one_sentence(self, ask):
        link = Bare()
        link.close()
        with pytest.raises(DeviceError, match=r"^the bare device is closed; open it again$"):
            ask(link)
        assert link.commands == [NO_FORCE, "released"]

    @pytest.mark.parametrize("fails", [DeviceError("it is gone"), ZeroDivisionError(), KeyboardInterrupt()])
    def test_device_that_refuses_zero_force_is_released(self, fails: BaseException, caplog: pytest.LogCaptureFixture):
        link = Bare()
        link.fails = fails
        if isinstance(fails, DeviceError):
            with caplog.at_level(logging.WARNING):
                link.close()
            (record,) = caplog.records
            assert record.getMessage() == (
                "the bare device: its force could not be made zero, turn off its power: it is gone"
            )
        else:
            with pytest.raises(type(fails)):
                link.close()
        assert link.commands == [NO_FORCE, "released"]
        with pytest.raises(DeviceError, match="is closed"):
            link.read()

    def test_block_with_a_refused_zero_force_raises_the_first_error(self):
        with pytest.raises(DeviceError, match="it is gone"), Bare() as link:
            link.fails = DeviceError("it is gone")
        assert link.commands == [NO_FORCE, "released"]
        with pytest.raises(ZeroDivisionError), Bare() as link:
            link.fails = DeviceError("it is gone")
            raise ZeroDivisionError

    def test_driver_that_ends_keeps_its_first_reason_and_is_released_once(self):
        link = Bare()
        link._end("was closed after an error: it is gone")
        link._end("was closed again")
        link.close()
        with link:
            pass
        assert link.commands == []
        with pytest.raises(DeviceError, match=r"^the bare device was closed after an error: it is gone; open"):
            link.write(PUSH)

        class Brittle(Bare):
            def _send(self, force: Force) -> None:
                self._end("broke")
                raise DeviceError("it is gone")

        link = Brittle()
        link.close()
        assert link.commands == []


def test_driver_without_its_base_init_or_with_equal_names_keeps_the_limit():
    class Mute(Bare):
        def __init__(self) -> None:
            self.commands, self.fails = [], None

    with pytest.raises(AttributeError):
        Mute().write(PUSH)

    class Same(Bare):
        def __init__(self) -> None:
            super().__init__()
            self._closed, self._name, self._max_force_n = "no", "no", 1e9

    link = Same()
    link.write(Force(0.0, 0.0, 100.0))
    assert link.applied == (0.0, 0.0, 5.0)


def test_driver_of_read_write_and_close_cannot_be_made():
    class Old(Link):
        applied = NO_FORCE

        def read(self) -> HapticState:  # pyright: ignore[reportIncompatibleMethodOverride]
            return HapticState((0.0, 0.0, 0.0))

    with pytest.raises(TypeError, match=r"_read.*_release.*_send"):
        Old("old", 1.0)
