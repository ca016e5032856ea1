"""What no driver can forget: no force over the greatest or not finite, none left behind, none once closed."""

import logging
import math

import pytest

from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import Link

PUSH = Force(0.0, 3.0, 4.0)


class Bare(Link):
    """A driver that thinks of nothing: it does as it is told, and writes down what that was."""

    def __init__(self, max_force_n: float = 5.0) -> None:
        super().__init__("the bare device", max_force_n)
        self.told: list[Force | str] = []
        self.fails: BaseException | None = None

    def _read(self) -> HapticState:
        return HapticState((0.0, 0.0, 0.0))

    def _send(self, force: Force) -> None:
        self.told.append(force)
        if self.fails:
            raise self.fails

    @property
    def applied(self) -> Force:
        return next((each for each in reversed(self.told) if isinstance(each, Force)), NO_FORCE)

    def _release(self) -> None:
        self.told.append("released")


class TestForce:
    def test_up_to_the_greatest_it_is_sent_as_it_is(self):
        link = Bare()
        link.write(PUSH)
        assert link.told == [PUSH]

    @pytest.mark.parametrize("times", [1.0001, 100.0, 1e300])
    def test_over_it_it_is_scaled_down(self, times: float):
        link = Bare()
        link.write(Force(0.0, 3.0 * times, 4.0 * times))
        assert link.applied == pytest.approx(PUSH)

    @pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_not_finite_it_is_zero(self, bad: float, axis: int):
        link = Bare()
        link.write(PUSH)
        link.write(Force(*[bad if each == axis else 0.1 for each in range(3)]))
        assert link.told == [PUSH, NO_FORCE]


class TestEnd:
    def test_zero_force_and_then_it_is_let_go_of_once(self):
        link = Bare()
        link.write(PUSH)
        link.close()
        link.close()
        assert link.told == [PUSH, NO_FORCE, "released"]

    @pytest.mark.parametrize("error", [None, ZeroDivisionError, KeyboardInterrupt])
    def test_a_block_ends_so_too_whatever_happens(self, error: type[BaseException] | None):
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
        assert link.told == [PUSH, NO_FORCE, "released"]

    def test_a_block_in_which_it_was_closed(self):
        with Bare() as link:
            link.close()
        assert link.told == [NO_FORCE, "released"]

    @pytest.mark.parametrize("ask", [Link.read, lambda link: link.write(PUSH), lambda link: link._check_open()])
    def test_once_closed_it_refuses_in_one_sentence(self, ask):
        link = Bare()
        link.close()
        with pytest.raises(DeviceError, match=r"^the bare device is closed; open it again$"):
            ask(link)
        assert link.told == [NO_FORCE, "released"]

    @pytest.mark.parametrize("fails", [DeviceError("it is gone"), ZeroDivisionError(), KeyboardInterrupt()])
    def test_a_device_that_takes_no_zero_is_let_go_of_all_the_same(
        self, fails: BaseException, caplog: pytest.LogCaptureFixture
    ):
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
        assert link.told == [NO_FORCE, "released"]
        with pytest.raises(DeviceError, match="is closed"):
            link.read()

    def test_a_block_says_that_the_device_took_no_zero(self):
        with pytest.raises(DeviceError, match="it is gone"), Bare() as link:
            link.fails = DeviceError("it is gone")
        assert link.told == [NO_FORCE, "released"]

    def test_but_not_over_an_error_of_its_own(self):
        with pytest.raises(ZeroDivisionError), Bare() as link:
            link.fails = DeviceError("it is gone")
            raise ZeroDivisionError

    def test_a_driver_that_let_go_by_itself_says_why_and_is_not_asked_again(self):
        link = Bare()
        link._end("was closed after an error: it is gone")
        link._end("was closed again")
        link.close()
        with link:
            pass
        assert link.told == []
        with pytest.raises(DeviceError, match=r"^the bare device was closed after an error: it is gone; open"):
            link.write(PUSH)

    def test_one_that_does_so_while_it_is_told_zero_is_not_let_go_of_twice(self):
        class Brittle(Bare):
            def _send(self, force: Force) -> None:
                self._end("broke")
                raise DeviceError("it is gone")

        link = Brittle()
        link.close()
        assert link.told == []


def test_a_driver_that_does_not_say_what_it_is_gives_no_force():
    class Mute(Bare):
        def __init__(self) -> None:
            self.told, self.fails = [], None

    with pytest.raises(AttributeError):
        Mute().write(PUSH)


def test_a_driver_s_own_fields_do_not_take_the_place_of_the_link_s():
    class Same(Bare):
        def __init__(self) -> None:
            super().__init__()
            self._closed, self._name, self._max_force_n = "no", "no", 1e9

    link = Same()
    link.write(Force(0.0, 0.0, 100.0))
    assert link.applied == (0.0, 0.0, 5.0)


def test_a_driver_of_read_write_and_close_is_none():
    class Old(Link):
        applied = NO_FORCE

        def read(self) -> HapticState:  # pyright: ignore[reportIncompatibleMethodOverride]
            return HapticState((0.0, 0.0, 0.0))

    with pytest.raises(TypeError, match=r"_read.*_release.*_send"):
        Old("old", 1.0)
