"""A mouse or robot that moves the pointer would feel a force that nobody holds, or keep one after it died."""

import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
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
from tangible_core.mapping import WorkspaceMapping, map_device
from tangible_core.plugins.interfaces import Link
from tangible_core.servo import Safety
from tangible_core.servo.guard import guard
from tangible_devices.pointer import PointerClient, channel, kernels
from tangible_devices.pointer.channel import Channel, checksum, unpack_block
from tangible_devices.pointer.following import follow, parse
from tangible_devices.pointer.pointer import HIGH_M, Pointer, PointerLink

words = st.lists(st.integers(0, 2**64 - 1), min_size=1, max_size=9)


@pytest.fixture
def link() -> Iterator[CompiledLink]:
    link = Pointer().open()
    assert isinstance(link, CompiledLink)
    yield link
    link.close()


def run_tick(link: CompiledLink) -> tuple[int, np.ndarray]:
    kernels, state = link.kernels(), np.full(7, 9.0)
    return kernels.read(*kernels.fixed, state), state


class TestExchange:
    def test_link_reads_positions_and_client_reads_forces(self, link: CompiledLink):
        with PointerClient() as client:
            client.send((0.01, -0.02, 0.003), buttons=5, velocity_m_per_s=(1.0, 2.0, 3.0))
            state = link.read()
            assert (state[:2], state.buttons) == (((0.01, -0.02, 0.003), (1.0, 2.0, 3.0)), 5)
            link.write(Force(1.0, -2.0, 3.0))
            assert client.force() == link.applied == Force(1.0, -2.0, 3.0)

    def test_velocity_not_sent_is_way_over_time(self, link: CompiledLink, monkeypatch: pytest.MonkeyPatch):
        with PointerClient() as client:
            client.send((0.0, 0.0, 0.0))
            assert link.read().velocity_m_per_s == (0.0, 0.0, 0.0)
            assert client._last is not None
            then = client._last[0]
            monkeypatch.setattr(time, "monotonic", lambda: then + 0.25)
            client.send((0.01, -0.02, 0.0))
            assert run_tick(link)[1][3:6] == pytest.approx([0.04, -0.08, 0.0])


def as_compiled(link: Link) -> CompiledLink:
    assert isinstance(link, CompiledLink)
    return link


FOLLOW_S = 0.012


class TestFollowing:
    @pytest.mark.parametrize("follow_s", [0.0, FOLLOW_S])
    def test_filter_passes_first_sample_and_after_silence(self, follow_s: float):
        with Pointer(stale_after_s=0.02, follow_s=follow_s).open() as link:
            here, there = (0.01, -0.02, 0.003), (0.3, 0.2, -0.1)
            with PointerClient() as client:
                client.send(here, 1, (1.0, 2.0, 3.0))
                assert run_tick(as_compiled(link))[1].tolist() == [*here, 1.0, 2.0, 3.0, 1.0]
                for _ in range(25):
                    silent = run_tick(as_compiled(link))[0]
                assert not silent
                client.send(there)
                assert run_tick(as_compiled(link))[1][:3].tolist() == list(there)
                client.release()
                assert run_tick(as_compiled(link))[1].tolist() == [*HIGH_M, 0, 0, 0, 0]
                client.send(here)
                assert run_tick(as_compiled(link))[1].tolist() == [*here, 0, 0, 0, 0]
            assert run_tick(as_compiled(link))[1].tolist() == [*HIGH_M, 0, 0, 0, 0]
            with PointerClient() as client:
                client.send(there)
                assert run_tick(as_compiled(link))[1][:3].tolist() == list(there)

    def test_filter_of_kernel_is_first_order_at_a_millisecond(self):
        with Pointer(follow_s=FOLLOW_S).open() as link, PointerClient() as client:
            client.send((0.0, 0.0, 0.0))
            run_tick(as_compiled(link))
            client.send((0.01, -0.02, 0.003), 5, (1.0, 2.0, 3.0))
            seen = np.array([run_tick(as_compiled(link))[1] for _ in range(50)])
        way = 1 - np.exp(-np.arange(1, 51) / (1000 * FOLLOW_S))
        np.testing.assert_allclose(seen[:, :6], way[:, None] * [0.01, -0.02, 0.003, 1.0, 2.0, 3.0], rtol=1e-9)
        assert (seen[:, 6] == 5).all()

    def test_filter_of_python_is_first_order_by_the_clock(self, monkeypatch: pytest.MonkeyPatch):
        now = [1000.0]
        monkeypatch.setattr(time, "perf_counter", lambda: now[0])
        monkeypatch.setattr(time, "sleep", lambda seconds: None)
        with Pointer(follow_s=FOLLOW_S).open() as link, PointerClient() as client:

            def read_after(seconds: float) -> HapticState:
                now[0] += seconds
                return link.read()

            client.send((0.01, 0.0, 0.0))
            assert read_after(0.001).position_m == (0.01, 0.0, 0.0)
            client.send((0.03, 0.0, -0.01), 4, (2.0, 0.0, 0.0))
            for seconds in (0.001, 0.004, 0.002):
                seen = read_after(seconds)
            way = 1 - np.exp(-0.007 / FOLLOW_S)
            assert seen.position_m == pytest.approx((0.01 + 0.02 * way, 0.0, -0.01 * way))
            assert seen.velocity_m_per_s == pytest.approx((2.0 * way, 0.0, 0.0))
            assert (seen.buttons, seen.time_s) == (4, now[0])
            client.release()
            assert read_after(0.001)[:2] == (HIGH_M, (0.0, 0.0, 0.0))
            for pause_s in (0.0, 0.2):  # let go, then silent
                now[0] += pause_s
                client.send((0.5, 0.0, 0.0), velocity_m_per_s=(0.0, 0.0, 0.0))
                assert read_after(0.001)[:2] == ((0.5, 0.0, 0.0), (0.0, 0.0, 0.0))

    @given(st.lists(st.tuples(*[st.floats(-1, 1)] * 6), min_size=2, max_size=4))
    def test_filter_switched_off_keeps_position_to_the_bit(self, samples: list[tuple[float, ...]]):
        with Pointer(channel="bits").open() as link, PointerClient("bits") as client:
            for sample in samples:
                client.send(sample[:3], 1, sample[3:])
                assert run_tick(as_compiled(link))[1].tobytes() == np.array([*sample, 1.0]).tobytes()
                assert (*link.read().position_m, *link.read().velocity_m_per_s) == sample


class Spring:
    """A spring of 1 N/mm under z = 0 on a link, tick by tick of 1 ms, by its kernels and a guard."""

    def __init__(self, link: Link, limits: Safety) -> None:
        self._kernels = as_compiled(link).kernels()
        self._settings, self._memory = limits.arrays(Pointer().spec(), 1000.0)

    def ticks(self, count: int) -> list[float]:
        """Return the forces of these ticks, N upwards."""
        return [self._tick() for _ in range(count)]

    def _tick(self) -> float:
        state = np.zeros(7)
        if self._kernels.read(*self._kernels.fixed, state):
            pushed = 0.0, 0.0, max(0.0, -1000 * state[2])
            *force, _ = guard.guard(self._settings, self._memory, 0.001, *state[:6], *pushed)
        else:
            *force, _ = guard.wait(self._settings, self._memory, 0.001)
        self._kernels.write(*self._kernels.fixed, *force)
        return force[2]


@pytest.mark.parametrize("follow_s", [0.0, FOLLOW_S])
class TestLettingGo:
    """A hand 2 mm deep, which the spring and nothing else holds."""

    @pytest.fixture
    def grip(self, follow_s: float) -> Iterator[tuple[PointerClient, Spring]]:
        with Pointer(follow_s=follow_s).open() as link, PointerClient() as client:
            spring = Spring(link, Safety(ramp_s=0, passivity="off"))
            client.send((0.0, 0.0, -0.002))
            assert spring.ticks(10)[-1] == 2.0 == client.force().z
            yield client, spring

    @pytest.mark.parametrize("leave", [PointerClient.release, PointerClient.close])
    def test_release_ends_law_at_next_tick_and_guard_fades_out(self, grip, leave):
        client, spring = grip
        leave(client)
        assert spring.ticks(6) == [1.5, 1.0, 0.5, 0.0, 0.0, 0.0]

    def test_release_gives_client_no_force_until_the_next_send(self, grip):
        client, spring = grip
        client.release()
        assert client.force() == NO_FORCE
        spring.ticks(1)
        assert client.force() == NO_FORCE
        client.release()
        spring.ticks(10)
        client.send((0.1, 0.0, -0.001))
        assert spring.ticks(5) == [0.5, 1.0, 1.0, 1.0, 1.0]
        assert client.force().z == 1.0
        assert client._channel.take(channel.SAMPLE, channel.SAMPLE_WORDS)[1][3:6] == (0, 0, 0)

    def test_release_after_close_leaves_next_client_alone(self, grip):
        client, spring = grip
        client.close()
        with PointerClient() as other:
            other.send((0.0, 0.0, -0.002))
            client.release()
            assert spring.ticks(10)[-1] == 2.0

    def test_silence_ends_force_after_stale_times(self, grip):
        _, spring = grip
        forces = spring.ticks(200)
        assert 90 < (end := forces.index(0.0)) <= 90 + 20, "100 reads of a sample, ten of which were; then 20 ms"
        assert (set(forces[:end]), set(forces[end:])) == ({2.0}, {0.0})


@pytest.mark.parametrize("tag", [0, 0x2AAAAA, 0x7FFFFF])
def test_clutch_ignores_client_number_in_buttons(tag: int):
    with map_device(Pointer(), WorkspaceMapping(scale=2.0, clutch_button=1)).open() as link, PointerClient() as client:
        for x, buttons, seen in ((0.02, 0, 0.01), (0.04, 1, 0.02), (0.06, 2, 0.02), (0.06, 3, 0.02), (0.08, 5, 0.03)):
            client.send((x, 0.0, 0.01), tag << 8 | buttons)
            state = run_tick(as_compiled(link))[1]
            assert (state[0], state[6]) == (pytest.approx(seen), tag << 8 | buttons)


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
    def test_tip_after_client_left_is_high_above(self, link: CompiledLink):
        with PointerClient() as client:
            client.send((0.0, 0.0, 0.0))
            assert link.read().position_m == (0, 0, 0)
        assert link.read().position_m == HIGH_M
        assert run_tick(link)[1].tolist() == [*HIGH_M, 0, 0, 0, 0]

    def test_silent_client_is_ignored(self):
        with Pointer(stale_after_s=0.03).open() as link, PointerClient() as client:
            client.send((0.0, 0.0, 0.0))
            assert link.read().position_m == (0, 0, 0)
            time.sleep(0.05)
            assert link.read().position_m == HIGH_M
            client.send((0.0, 0.0, 0.0))
            assert link.read().position_m == (0, 0, 0)

    def test_kernel_counts_the_silence(self):
        with Pointer(stale_after_s=0.03).open() as link, PointerClient() as client:
            assert isinstance(link, CompiledLink)
            client.send((0.0, 0.0, 0.0))
            assert [run_tick(link)[0] for _ in range(40)] == [1] * 30 + [0] * 10
            client.send((0.0, 0.0, 0.0))
            assert run_tick(link)[0] == 1

    def test_sample_of_earlier_client_is_not_new(self):
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
            assert run_tick(link)[0] == 0

    def test_silent_client_is_used_again_when_it_sends(self, link: CompiledLink):
        with PointerClient() as client:
            client.send((0.0, 0.0, 0.0), 3)
            assert run_tick(link)[0] == 1
        assert run_tick(link)[1].tolist() == [*HIGH_M, 0, 0, 0, 0]
        link.kernels().fixed[0][channel.CLIENT_OPEN] = 1  # a client that has sent nothing
        assert run_tick(link)[0] == 0
        with PointerClient() as client:
            client.send((0.1, 0.0, 0.0))
            assert run_tick(link)[1][0] == 0.1

    def test_opened_device_has_no_force_and_no_old_sample(self):
        shown = before_a_device(force_n=(0.0, 0.0, 2.0))
        with Pointer().open() as link:
            assert shown.take(channel.FORCE, channel.FORCE_WORDS)[1] == (0, 0, 0)
            assert isinstance(link, CompiledLink)
            assert run_tick(link)[0] == 0
            assert link.read().position_m == HIGH_M
        shown.close()

    def test_closed_device_shows_no_force(self, link: CompiledLink):
        link.write(Force(0.0, 0.0, 1.0))
        link.close()
        with pytest.raises(DeviceError, match="the pointer device is closed"):
            link.exchange()
        shown = Channel("pointer", "client")
        assert shown.take(channel.FORCE, channel.FORCE_WORDS)[1] == (0, 0, 0)
        assert not shown.flag(channel.DEVICE_OPEN)
        shown.close()

    def test_device_is_open_only_after_zero_force(self):
        """A killed device leaves its flag set, and a client would read its last force."""
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

    @pytest.mark.parametrize("size", [8.1, 1e3, 1e200])
    def test_force_above_limit_is_scaled_down(self, link: CompiledLink, size: float):
        link.write(Force(0.0, size, 0.0))
        assert link.applied == pytest.approx((0, 8, 0))
        link.write(Force(0.0, size, float("nan")))
        assert link.applied == NO_FORCE

    def test_force_blocks_have_rising_numbers(self, link: CompiledLink, monkeypatch: pytest.MonkeyPatch):
        """By these numbers a client tells a living device from one that shows its last force for ever."""
        with PointerClient() as client:
            link.write(Force(0.0, 0.0, 1.0))
            assert client.force() == (0, 0, 1)
            now = time.monotonic()
            monkeypatch.setattr(time, "monotonic", lambda: now + 0.6)
            assert client.force() == NO_FORCE
            link.write(Force(0.0, 0.0, 1.0))
            assert client.force() == (0, 0, 1)

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    @pytest.mark.parametrize("place", range(7))
    def test_sample_with_nonfinite_number_is_refused(self, link: CompiledLink, place: int, bad: float):
        good = [0.01, 0.02, 0.03, 1.0, 2.0, 3.0, 5.0]
        with PointerClient() as client:
            client.send((0.0, 0.0, 0.0), velocity_m_per_s=(0.0, 0.0, 0.0))
            client._channel.put(channel.SAMPLE, 2**63, (*good[:place], bad, *good[place + 1 :]))
            assert run_tick(link)[0] == 0
            assert link.read().position_m == HIGH_M, "nothing was heard yet"
            client._channel.put(channel.SAMPLE, 2**63 + 1, tuple(good))
            assert run_tick(link)[1].tolist() == good

    @pytest.mark.usefixtures("unchecked_shapes")
    @pytest.mark.parametrize("bad", [(np.nan, 0, 0), (0, np.inf, 0), (0, 0), (0, 0, 0, 0)])
    def test_client_sending_invalid_position_is_refused(self, link: CompiledLink, bad: tuple[float, ...]):
        with PointerClient() as client, pytest.raises(DeviceError, match="three finite numbers"):
            client.send(bad, velocity_m_per_s=(0.0, 0.0, 0.0))


class TestTorn:
    @given(words)
    def test_checksum_of_kernel_equals_python_s(self, block: list[int]):
        assert kernels.checksum(np.array(block, np.uint64), 0, len(block)) == checksum(tuple(block))

    @pytest.mark.parametrize("bit", [0, 63])
    @pytest.mark.parametrize("word", range(channel.SAMPLE_WORDS + 1))
    def test_sample_with_one_wrong_bit_is_refused(self, link: CompiledLink, word: int, bit: int):
        kernels = link.kernels()
        words = kernels.fixed[0]
        with PointerClient() as client:
            client.send((0.5, 0.25, 0.125), 1, (0.5, 0.25, 0.125))
            assert run_tick(link)[0] == 1
            words[channel.SAMPLE + word] ^= np.uint64(1 << bit)
            assert run_tick(link)[0] == 0
            assert link.read().position_m == HIGH_M
            words[channel.SAMPLE + word] ^= np.uint64(1 << bit)
            assert (run_tick(link)[0], link.read().position_m) == (1, (0.5, 0.25, 0.125))

    @pytest.mark.parametrize("word", range(channel.FORCE_WORDS + 1))
    def test_force_with_one_wrong_bit_is_zero(self, link: CompiledLink, word: int):
        with PointerClient() as client:
            link.write(Force(1.0, 2.0, 3.0))
            assert client.force() == (1, 2, 3)
            client._channel.memory[(channel.FORCE + word) * 8 + 3] ^= 16
            assert client.force() == NO_FORCE

    @pytest.mark.whole
    def test_reader_never_sees_half_of_a_busy_writer_s_block(self, link: CompiledLink):
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
            mixtures = 0
            for _ in range(count):
                if read(*fixed, state) and state[2] != 1.0:
                    mixtures += (state != state[0]).any()
            return mixtures

        thread = Thread(target=hammer)
        thread.start()
        try:
            kernels = link.kernels()
            for _ in range(20):
                assert mixtures(Address(kernels.read), kernels.fixed, np.zeros(7), 5000) == 0
        finally:
            stop.set()
            thread.join()

    def test_block_being_written_is_read_again(self, link: CompiledLink, monkeypatch: pytest.MonkeyPatch):
        with PointerClient() as client:
            link.write(Force(1.0, 2.0, 3.0))
            torn = iter([None] * 7)
            monkeypatch.setattr(channel, "unpack_block", lambda block: next(torn, unpack_block(block)))
            assert client.force() == (1, 2, 3)


class TestPlaces:
    def test_second_device_is_refused_until_first_is_closed(self, link: CompiledLink):
        with pytest.raises(DeviceError, match="has a device already"):
            Pointer().open()
        with Pointer(channel="other").open() as other:
            assert other.read().position_m == HIGH_M
        link.close()
        with Pointer().open():
            pass

    def test_client_without_device_is_refused_after_its_wait(self):
        with pytest.raises(DeviceError, match="no device is open"):
            PointerClient()
        opened: list[object] = []
        thread = Thread(target=lambda: (time.sleep(0.1), opened.append(Pointer().open())))
        thread.start()
        with PointerClient(wait_s=30.0) as client:
            assert client.force() == NO_FORCE
        thread.join()

    def test_client_of_closed_device_and_closed_client_are_refused(self, link: CompiledLink):
        client = PointerClient()
        link.close()
        for call in (client.force, lambda: client.send((0.0, 0.0, 0.0))):
            with pytest.raises(DeviceError, match="was closed"):
                call()
        client.close()
        client.close()
        with pytest.raises(DeviceError, match="is closed"):
            client.force()

    def test_client_of_another_version_is_refused(self, link: CompiledLink):
        link.kernels().fixed[0][channel.MAGIC] += 1
        with pytest.raises(DeviceError, match="of another version"):
            PointerClient()
        link.kernels().fixed[0][channel.MAGIC] -= 1
        PointerClient().close()

    @pytest.mark.parametrize("name", ["../x", "A", "", "a/b", "x" * 65])
    def test_channel_with_invalid_name_is_refused(self, name: str):
        with pytest.raises(DeviceError):
            Channel(name, "device")

    def test_channel_file_is_private(self, link: CompiledLink):
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


@pytest.mark.whole
class TestKilled:
    def test_killed_client_gives_no_force_and_is_replaceable(self, link: CompiledLink, child):
        process = child("client")
        assert link.read().position_m == (0, 0, 0)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        time.sleep(0.12)
        assert link.read().position_m == HIGH_M
        with PointerClient() as client:
            client.send((0.1, 0.0, 0.0))
            assert link.read().position_m == (0.1, 0, 0)

    def test_killed_device_leaves_its_place_and_no_force(self, child):
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


@pytest.mark.parametrize(("channel", "words"), [("pointer", "pointer`"), ("b", "pointer --channel b`")])
def test_unattended_names_the_command_to_start(channel: str, words: str):
    device = Pointer(channel=channel)
    with device.open():
        assert words in (device.unattended() or "")
        with PointerClient(channel):
            assert device.unattended() is None


class TestCommand:
    def test_command_with_typed_positions_moves_the_device(self, link: CompiledLink, monkeypatch: pytest.MonkeyPatch):
        """A spring of 1 N/mm under z = 0."""
        stop = Event()

        def feel() -> None:
            while not stop.is_set():
                state: HapticState = link.read()
                link.write(Force(0.0, 0.0, max(0.0, -1000 * state.position_m[2])))

        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"0 0 1\n\n10 -5\n\xff\n10 -5 -2.5\n")))
        thread, complaints = Thread(target=feel), list[str]()
        thread.start()
        try:
            lines = list(follow("", "pointer", 1.0, 0.0, 0.08, 0.0, True, complaints.append))
        finally:
            stop.set()
            thread.join()
        assert [json.loads(line) for line in lines] == [
            {"position_m": [0.0, 0.0, 0.001], "force_n": [0.0, 0.0, 0.0]},
            {"position_m": [0.01, -0.005, -0.0025], "force_n": [0.0, 0.0, 2.5]},
        ]
        assert ["'10 -5' is not a position" in complaint for complaint in complaints] == [True, False]

    def test_command_with_path_follows_it_for_its_time(self, link: CompiledLink):
        heading, *lines = follow("circle", "pointer", 0.5, 0.002, 0.08, 0.0, False, pytest.fail)
        assert heading.split() == ["x", "mm", "y", "mm", "z", "mm", "fx", "N", "fy", "N", "fz", "N"]
        assert 2 <= len(lines) <= 5
        assert {line.split()[2] for line in lines} == {"2.000"}

    @pytest.mark.parametrize(
        ("path", "seconds", "speed"), [("cricle", 1, 1), ("circle", 0, 1), ("circle", 1, float("nan"))]
    )
    def test_command_with_invalid_options_is_refused(self, path: str, seconds: float, speed: float):
        with pytest.raises(ConfigError):
            next(follow(path, "pointer", seconds, 0.0, speed, 0.0, False, pytest.fail))

    @pytest.mark.parametrize("line", ["1 2", "1 2 3 4 5", "a b c", "1 2 3 inf", "nan 2 3", "1 2 3 -1", "1 2 3 0.5"])
    def test_command_line_without_position_is_refused(self, line: str):
        with pytest.raises(DeviceError, match="is not a position"):
            parse(line)
