"""The pointer: what two processes say to each other, what is torn, silent, killed, taken twice."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from threading import Event, Thread
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from tangible_core.compiled.kernels import Address
from tangible_core.compiled.touch import CompiledLink
from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.errors import ConfigError, DeviceError
from tangible_core.mapping import WorkspaceMapping, mapped
from tangible_devices.pointer import PointerClient, channel, kernels
from tangible_devices.pointer.channel import Channel, checksum, packed, unpacked
from tangible_devices.pointer.following import follow, parse
from tangible_devices.pointer.pointer import HIGH_M, Pointer, PointerLink

TANGIBLE = str(Path(sys.executable).with_name("tangible"))
words = st.lists(st.integers(0, 2**64 - 1), min_size=1, max_size=9)


@pytest.fixture
def link() -> Iterator[CompiledLink]:
    link = Pointer().open()
    assert isinstance(link, CompiledLink)
    yield link
    link.close()


def ticked(link: CompiledLink) -> tuple[int, np.ndarray]:
    kernels, state = link.kernels(), np.full(7, 9.0)
    return kernels.read(*kernels.fixed, state), state


class TestExchange:
    def test_positions_go_in_and_forces_come_out(self, link: CompiledLink):
        with PointerClient() as client:
            client.send((0.01, -0.02, 0.003), buttons=5, velocity_m_per_s=(1.0, 2.0, 3.0))
            state = link.read()
            assert state[:2] == ((0.01, -0.02, 0.003), (1.0, 2.0, 3.0))
            assert state.buttons == 5
            link.write(Force(1.0, -2.0, 3.0))
            assert client.force() == link.applied == Force(1.0, -2.0, 3.0)

    def test_the_kernels_see_the_same(self, link: CompiledLink):
        kernels = link.kernels()
        with PointerClient() as client:
            client.send((0.01, -0.02, 0.003), buttons=5, velocity_m_per_s=(1.0, 2.0, 3.0))
            fresh, state = ticked(link)
            assert fresh == 1
            assert state.tolist() == [0.01, -0.02, 0.003, 1.0, 2.0, 3.0, 5.0]
            kernels.write(*kernels.fixed, 1.0, -2.0, 3.0)
            assert client.force() == link.applied == Force(1.0, -2.0, 3.0)
        assert not link.exchanges
        link.exchange()

    def test_a_velocity_that_is_not_sent_is_the_way_over_the_time(
        self, link: CompiledLink, monkeypatch: pytest.MonkeyPatch
    ):
        with PointerClient() as client:
            client.send((0.0, 0.0, 0.0))
            assert link.read().velocity_m_per_s == (0.0, 0.0, 0.0)
            assert client._last is not None
            then = client._last[0]
            monkeypatch.setattr(time, "monotonic", lambda: then + 0.25)
            client.send((0.01, -0.02, 0.0))
            assert ticked(link)[1][3:6] == pytest.approx([0.04, -0.08, 0.0])

    def test_through_a_mapping_it_still_needs_no_python(self):
        with mapped(Pointer(), WorkspaceMapping(scale=2.0)).open() as link, PointerClient() as client:
            assert isinstance(link, CompiledLink) and not link.exchanges
            client.send((0.02, 0.0, 0.01))
            assert ticked(link)[1][:3].tolist() == [0.01, 0.0, 0.005]

    def test_a_compiled_loop_takes_the_kernels_by_address(self, link: CompiledLink):
        @njit(nogil=True)
        def loop(read, write, fixed, state):
            while read(*fixed, state) == 0 or state[2] == 1.0:
                pass
            write(*fixed, state[0], state[1], state[2])

        kernels = link.kernels()
        ends = Address(kernels.read), Address(kernels.write)
        thread = Thread(target=loop, args=(*ends, kernels.fixed, np.zeros(7)))
        with PointerClient() as client:
            thread.start()
            client.send((0.5, 0.25, 0.125))
            thread.join(30)
            assert client.force() == (0.5, 0.25, 0.125)


def before_a_device(force_n: tuple[float, float, float]) -> Channel:
    """The memory as a device and a client that were killed leave it; a client's hold on it."""
    left = Channel("pointer", "device")
    left.put(channel.SAMPLE, 7, (0.0,) * 7)
    left.put(channel.FORCE, 7, force_n)
    for side in (channel.DEVICE_OPEN, channel.CLIENT_OPEN):
        left.set_flag(side, True)
    left.close()
    return Channel("pointer", "client")


class TestNobody:
    def test_without_a_client_the_tip_is_high_above(self, link: CompiledLink):
        assert link.read()[:2] == (HIGH_M, (0.0, 0.0, 0.0))
        fresh, state = ticked(link)
        assert fresh == 1
        assert state.tolist() == [*HIGH_M, 0, 0, 0, 0]

    def test_a_client_that_leaves_takes_the_tip_along(self, link: CompiledLink):
        with PointerClient() as client:
            client.send((0.0, 0.0, 0.0))
            assert link.read().position_m == (0, 0, 0)
        assert link.read().position_m == HIGH_M
        assert ticked(link)[1].tolist() == [*HIGH_M, 0, 0, 0, 0]

    def test_a_silent_client_is_not_believed(self):
        with Pointer(stale_after_s=0.03).open() as link, PointerClient() as client:
            client.send((0.0, 0.0, 0.0))
            assert link.read().position_m == (0, 0, 0)
            time.sleep(0.05)
            assert link.read().position_m == HIGH_M
            client.send((0.0, 0.0, 0.0))
            assert link.read().position_m == (0, 0, 0)

    def test_a_compiled_loop_counts_the_silence(self):
        with Pointer(stale_after_s=0.03).open() as link, PointerClient() as client:
            assert isinstance(link, CompiledLink)
            client.send((0.0, 0.0, 0.0))
            assert [ticked(link)[0] for _ in range(40)] == [1] * 30 + [0] * 10
            client.send((0.0, 0.0, 0.0))
            assert ticked(link)[0] == 1

    def test_what_an_earlier_client_left_is_not_taken_for_new(self):
        with Pointer().open(), PointerClient() as client:
            client.send((0.0, 0.0, 0.0))
            with pytest.raises(DeviceError, match="has a client already"):
                PointerClient()
        path = channel.channel_path("pointer")
        memory = bytearray(path.read_bytes())
        memory[channel.CLIENT_OPEN * 8] = 1  # as if it had been killed
        path.write_bytes(memory)
        with Pointer().open() as link:
            assert link.read().position_m == HIGH_M
            assert isinstance(link, CompiledLink)
            assert ticked(link)[0] == 0

    def test_a_client_that_comes_back_is_believed_when_it_sends(self, link: CompiledLink):
        with PointerClient() as client:
            client.send((0.0, 0.0, 0.0), 3)
            assert ticked(link)[0] == 1
        assert ticked(link)[1].tolist() == [*HIGH_M, 0, 0, 0, 0]
        link.kernels().fixed[0][channel.CLIENT_OPEN] = 1  # who is there, and has said nothing
        assert ticked(link)[0] == 0
        with PointerClient() as client:
            client.send((0.1, 0.0, 0.0))
            assert ticked(link)[1][0] == 0.1

    def test_the_next_client_s_first_sample_is_new(self, link: CompiledLink):
        for x in (0.1, 0.2):
            with PointerClient() as client:
                client.send((x, 0.0, 0.0), velocity_m_per_s=(0.0, 0.0, 0.0))
                assert ticked(link)[1][0] == x
                assert link.read().position_m[0] == x

    def test_a_device_that_is_closed_shows_no_force(self, link: CompiledLink):
        link.write(Force(0.0, 0.0, 1.0))
        link.close()
        with pytest.raises(DeviceError, match="the pointer device is closed"):
            link.exchange()
        shown = Channel("pointer", "client")
        assert shown.take(channel.FORCE, channel.FORCE_WORDS)[1] == (0, 0, 0)
        assert not shown.flag(channel.DEVICE_OPEN)
        shown.close()

    def test_a_device_that_opens_shows_no_force_and_hears_nothing_of_before(self):
        shown = before_a_device(force_n=(0.0, 0.0, 2.0))
        with Pointer().open() as link:
            assert shown.take(channel.FORCE, channel.FORCE_WORDS)[1] == (0, 0, 0)
            assert isinstance(link, CompiledLink)
            assert ticked(link)[0] == 0
            assert link.read().position_m == HIGH_M
        shown.close()

    def test_until_it_shows_no_force_it_is_not_open(self):
        """What a killed one left says that it is: a client would be shown its last force."""
        shown = before_a_device(force_n=(0.0, 0.0, 2.0))
        open_then: list[bool] = []

        class Looked(ModuleType):
            def __getattr__(self, name: str) -> object:
                if name == "write":
                    open_then.append(shown.flag(channel.DEVICE_OPEN))
                return getattr(kernels, name)

        PointerLink(Looked("kernels"), Channel("pointer", "device"), 0.1, 8.0).close()
        assert open_then[0] is False
        shown.close()

    def test_the_last_of_a_killed_client_is_not_believed_from_the_first_read_on(self):
        """As long as a client may be silent, the last place of one that was killed would be a place."""
        shown = before_a_device(force_n=(0.0, 0.0, 0.0))
        with Pointer(stale_after_s=10.0).open() as link:
            assert isinstance(link, CompiledLink)
            assert [ticked(link)[0] for _ in range(3)] == [0, 0, 0]
            assert link.read().position_m == HIGH_M
        shown.close()

    @pytest.mark.parametrize("size", [8.1, 1e3, 1e200])
    def test_a_force_over_the_device_s_is_not_shown(self, link: CompiledLink, size: float):
        link.write(Force(0.0, size, 0.0))
        assert link.applied == pytest.approx((0, 8, 0))
        link.write(Force(0.0, size, float("nan")))
        assert link.applied == NO_FORCE

    def test_every_force_has_another_number(self, link: CompiledLink, monkeypatch: pytest.MonkeyPatch):
        """By which a client tells a device that lives from one that shows its last force for ever."""
        with PointerClient() as client:
            link.write(Force(0.0, 0.0, 1.0))
            assert client.force() == (0, 0, 1)
            now = time.monotonic()
            monkeypatch.setattr(time, "monotonic", lambda: now + 0.6)
            assert client.force() == NO_FORCE
            link.write(Force(0.0, 0.0, 1.0))
            assert client.force() == (0, 0, 1)

    def test_a_silent_device_shows_no_force(self, link: CompiledLink, monkeypatch: pytest.MonkeyPatch):
        with PointerClient() as client:
            link.write(Force(0.0, 0.0, 1.0))
            assert client.force() == (0, 0, 1)
            now = time.monotonic()
            monkeypatch.setattr(time, "monotonic", lambda: now + 1.0)
            assert client.force() == NO_FORCE
            link.write(Force(0.0, 0.0, 2.0))
            assert client.force() == (0, 0, 2)

    def test_a_foreign_client_s_nonsense_is_no_position(self, link: CompiledLink):
        with PointerClient() as client:
            client.send((0.0, 0.0, 0.0))
            client._channel.put(channel.SAMPLE, 2**63, (np.nan,) * 7)
            assert ticked(link)[0] == 0
            assert np.isfinite(link.read().position_m).all()

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    @pytest.mark.parametrize("place", range(7))
    def test_no_part_of_it_may_be_nonsense(self, link: CompiledLink, place: int, bad: float):
        good = [0.01, 0.02, 0.03, 1.0, 2.0, 3.0, 5.0]
        with PointerClient() as client:
            client.send((0.0, 0.0, 0.0), velocity_m_per_s=(0.0, 0.0, 0.0))
            client._channel.put(channel.SAMPLE, 2**63, (*good[:place], bad, *good[place + 1 :]))
            assert ticked(link)[0] == 0
            assert link.read().position_m == HIGH_M, "nothing was heard yet"
            client._channel.put(channel.SAMPLE, 2**63 + 1, tuple(good))
            assert ticked(link)[1].tolist() == good

    @pytest.mark.usefixtures("unchecked_shapes")
    @pytest.mark.parametrize("bad", [(np.nan, 0, 0), (0, np.inf, 0), (0, 0), (0, 0, 0, 0)])
    def test_a_client_sends_only_positions(self, link: CompiledLink, bad: tuple[float, ...]):
        with PointerClient() as client, pytest.raises(DeviceError, match="three finite numbers in metres"):
            client.send(bad, velocity_m_per_s=(0.0, 0.0, 0.0))


class TestTorn:
    @given(words)
    def test_the_kernel_s_checksum_is_python_s(self, block: list[int]):
        assert kernels.checksum(np.array(block, np.uint64), 0, len(block)) == checksum(tuple(block))

    @given(st.data())
    def test_two_blocks_mixed_are_no_block(self, data: st.DataObject):
        """Signs of two numbers that change at once, equal numbers: nothing cancels out."""
        number = st.floats(-1, 1) | st.sampled_from([0.0, -0.0, 1.0, -1.0])
        old = packed(7, tuple(data.draw(st.lists(number, min_size=7, max_size=7))))
        new = packed(8, tuple(data.draw(st.lists(number, min_size=7, max_size=7))))
        taken = data.draw(st.lists(st.booleans(), min_size=9, max_size=9))
        mix = b"".join((new if of_new else old)[8 * i : 8 * i + 8] for i, of_new in enumerate(taken))
        assert unpacked(mix) is None or mix in (old, new)

    def test_a_writer_that_never_rests_is_never_read_half(self, link: CompiledLink):
        """Every sample holds one number seven times; a hundred thousand reads see no mixture."""
        stop = Event()

        def hammer() -> None:
            with PointerClient() as client:
                number = 0
                while not stop.is_set():
                    number += 1
                    value = float(number)
                    client.send((value, value, value), number, (value, value, value))

        @njit(nogil=True)
        def mixtures(read, fixed, state, count):
            found = 0
            for _ in range(count):
                if read(*fixed, state) and state[2] != 1.0:
                    found += (state != state[0]).any()
            return found

        thread = Thread(target=hammer)
        thread.start()
        try:
            kernels = link.kernels()
            for _ in range(20):
                assert mixtures(Address(kernels.read), kernels.fixed, np.zeros(7), 5000) == 0
        finally:
            stop.set()
            thread.join()

    @pytest.mark.parametrize("bit", [0, 63])
    @pytest.mark.parametrize("word", range(channel.SAMPLE_WORDS + 1))
    def test_a_block_with_one_bit_of_another_is_no_position(self, link: CompiledLink, word: int, bit: int):
        kernels = link.kernels()
        words = kernels.fixed[0]
        with PointerClient() as client:
            client.send((0.5, 0.25, 0.125), 1, (0.5, 0.25, 0.125))
            assert ticked(link)[0] == 1
            words[channel.SAMPLE + word] ^= np.uint64(1 << bit)
            assert ticked(link)[0] == 0
            assert link.read().position_m == HIGH_M
            words[channel.SAMPLE + word] ^= np.uint64(1 << bit)
            assert ticked(link)[0] == 1
            assert link.read().position_m == (0.5, 0.25, 0.125)

    @pytest.mark.parametrize("word", range(channel.FORCE_WORDS + 1))
    def test_a_force_with_one_bit_of_another_is_none(self, link: CompiledLink, word: int):
        with PointerClient() as client:
            link.write(Force(1.0, 2.0, 3.0))
            assert client.force() == (1, 2, 3)
            client._channel.memory[(channel.FORCE + word) * 8 + 3] ^= 16
            assert client.force() == NO_FORCE

    def test_a_block_that_is_being_written_is_read_again(self, link: CompiledLink, monkeypatch: pytest.MonkeyPatch):
        with PointerClient() as client:
            link.write(Force(1.0, 2.0, 3.0))
            torn = iter([None] * 7)
            monkeypatch.setattr(channel, "unpacked", lambda block: next(torn, unpacked(block)))
            assert client.force() == (1, 2, 3)

    def test_a_block_left_half_written_is_no_force(self, link: CompiledLink):
        with PointerClient() as client:
            client._channel.memory[channel.FORCE * 8 + 8] ^= 1
            assert client.force() == NO_FORCE


class TestPlaces:
    def test_a_second_device_is_refused_until_the_first_is_closed(self, link: CompiledLink):
        with pytest.raises(DeviceError, match=r"has a device already .*use another channel"):
            Pointer().open()
        with Pointer(channel="other").open() as other:
            assert other.read().position_m == HIGH_M
        link.close()
        with Pointer().open():
            pass

    def test_a_client_needs_a_device(self):
        with pytest.raises(DeviceError, match="no device is open on pointer 'pointer'; start"):
            PointerClient()

    def test_a_client_may_wait_for_one(self):
        opened: list[object] = []
        thread = Thread(target=lambda: (time.sleep(0.1), opened.append(Pointer().open())))
        thread.start()
        with PointerClient(wait_s=30.0) as client:
            assert client.force() == NO_FORCE
        thread.join()

    def test_a_client_is_told_that_the_device_was_closed(self, link: CompiledLink):
        with PointerClient() as client:
            link.write(Force(0.0, 0.0, 1.0))
            link.close()
            for call in (client.force, lambda: client.send((0.0, 0.0, 0.0))):
                with pytest.raises(DeviceError, match="was closed; start it again"):
                    call()

    def test_a_closed_client_is_closed(self, link: CompiledLink):
        client = PointerClient()
        client.close()
        client.close()
        with pytest.raises(DeviceError, match="is closed; make another"):
            client.force()

    def test_another_version_is_refused(self, link: CompiledLink):
        link.kernels().fixed[0][channel.MAGIC] += 1
        with pytest.raises(DeviceError, match="of another version"):
            PointerClient()
        link.kernels().fixed[0][channel.MAGIC] -= 1
        PointerClient().close()

    @pytest.mark.parametrize("name", ["../x", "A", "", "a/b", "x" * 65])
    def test_names_that_are_no_channel(self, name: str):
        with pytest.raises(DeviceError, match="lower-case letters"):
            Channel(name, "device")

    def test_only_this_user_may_look(self, link: CompiledLink):
        assert channel.channel_path("pointer").stat().st_mode & 0o077 == 0


CHILD = """
import sys, time
from tangible_devices.pointer import PointerClient
from tangible_core import load_method
from tangible_core.data import Force
if sys.argv[1] == "device":
    end = load_method("device", "pointer")().open()
    end.write(Force(0.0, 0.0, 1.0))
else:
    end = PointerClient()
    end.send((0.0, 0.0, 0.0))
print("ready", flush=True)
time.sleep(60)
"""


@pytest.fixture
def child() -> Iterator[object]:
    started: list[subprocess.Popen[str]] = []

    def start(side: str) -> subprocess.Popen[str]:
        process = subprocess.Popen([sys.executable, "-c", CHILD, side], stdout=subprocess.PIPE, text=True)
        started.append(process)
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


class TestKilled:
    def test_a_killed_client_is_not_felt_and_another_takes_its_place(self, link: CompiledLink, child):
        process = child("client")
        assert link.read().position_m == (0, 0, 0)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        time.sleep(0.12)
        assert link.read().position_m == HIGH_M
        with PointerClient() as client:
            client.send((0.1, 0.0, 0.0))
            assert link.read().position_m == (0.1, 0, 0)

    def test_a_killed_device_leaves_its_place_and_no_force(self, child):
        process = child("device")
        client = PointerClient()
        assert client.force() == (0, 0, 1)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        with pytest.raises(DeviceError, match="no device is open"):
            PointerClient("pointer")
        with Pointer().open() as link:
            assert client.force() == NO_FORCE
            client.send((0.1, 0.0, 0.0))
            assert link.read().position_m == (0.1, 0, 0)
        client.close()


@pytest.mark.parametrize(
    ("channel", "words"), [("pointer", "`tangible pointer`"), ("b", "`tangible pointer --channel b`")]
)
def test_whether_somebody_moves_it(channel: str, words: str):
    device = Pointer(channel=channel)
    with device.open():
        assert words in (device.unattended() or "")
        with PointerClient(channel):
            assert device.unattended() is None
        assert words in (device.unattended() or "")


class TestCommand:
    def test_typed_positions_are_felt(self, link: CompiledLink):
        """A spring of 1 N/mm under z = 0, in this process; the hand in another."""
        stop = Event()

        def feel() -> None:
            while not stop.is_set():
                state: HapticState = link.read()
                link.write(Force(0.0, 0.0, max(0.0, -1000 * state.position_m[2])))

        thread = Thread(target=feel)
        thread.start()
        try:
            ran = subprocess.run(
                [TANGIBLE, "pointer", "--json"], input=b"0 0 1\n\n10 -5\n\xff\n10 -5 -2.5\n", capture_output=True
            )
        finally:
            stop.set()
            thread.join()
        assert [json.loads(line) for line in ran.stdout.splitlines()] == [
            {"position_m": [0.0, 0.0, 0.001], "force_n": [0.0, 0.0, 0.0]},
            {"position_m": [0.01, -0.005, -0.0025], "force_n": [0.0, 0.0, 2.5]},
        ]
        complaints = ran.stderr.decode().splitlines()
        assert ["'10 -5' is not a position; type x y z in millimetres" in each for each in complaints] == [True, False]
        assert ran.returncode == 0, complaints

    def test_a_path_is_followed_for_its_time(self, link: CompiledLink):
        heading, *lines = follow("circle", "pointer", 0.5, 0.002, 0.08, 0.0, False, pytest.fail)
        assert heading.split() == ["x", "mm", "y", "mm", "z", "mm", "fx", "N", "fy", "N", "fz", "N"]
        assert 2 <= len(lines) <= 5
        assert {line.split()[2] for line in lines} == {"2.000"}

    def test_without_a_device_it_says_what_to_do(self):
        ran = subprocess.run([TANGIBLE, "pointer"], input="", capture_output=True, text=True)
        assert ran.returncode == 2
        assert "start `tangible feel`" in ran.stderr

    @pytest.mark.parametrize(
        ("path", "seconds", "speed"), [("cricle", 1, 1), ("circle", 0, 1), ("circle", 1, float("nan"))]
    )
    def test_options_that_make_no_sense(self, path: str, seconds: float, speed: float):
        with pytest.raises(ConfigError):
            next(follow(path, "pointer", seconds, 0.0, speed, 0.0, False, pytest.fail))

    @pytest.mark.parametrize("line", ["1 2", "1 2 3 4 5", "a b c", "1 2 3 inf", "nan 2 3", "1 2 3 -1", "1 2 3 0.5"])
    def test_lines_that_are_no_position(self, line: str):
        with pytest.raises(DeviceError, match="type x y z in millimetres"):
            parse(line)
