"""The mapping from hand to picture: a wrong one puts the surface beside the hand, or pushes where it must not."""

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import float64, int64, njit, void

from tangible_core.compiled.touch import CompiledLink, LinkKernels
from tangible_core.data import NO_FORCE, DeviceSpec, Force, HapticState
from tangible_core.mapping import (
    MappedDevice,
    Placement,
    WorkspaceMapping,
    intended_path,
    kernels,
    map_device,
    placement_of,
)
from tangible_core.mapping.device import over
from tangible_core.mapping.placement import turn
from tangible_core.plugins.interfaces import HapticDevice, Link
from tangible_core.testing.kinds.device import CHECKS as DEVICE_CHECKS
from tangible_devices.mock import Mock
from tangible_devices.pointer.pointer import Pointer

SPEC = Mock().spec()
near = st.floats(-0.2, 0.2)
points = st.tuples(near, near, near)
placements = st.builds(
    lambda scale, degrees, *offsets: Placement(scale, *turn(degrees), *offsets),
    st.floats(1e-2, 1e2),
    st.floats(-360, 360) | st.sampled_from([0.0, 90.0, -90.0, 180.0, 270.0]),
    *[near] * 5,
)
ARRAY = float64[::1]


@njit(int64(ARRAY, ARRAY), nogil=True)
def read_buffer(buffer, state):
    if buffer[7] == 0.0:
        return 0
    for i in range(7):  # as a slice, it takes a second to compile
        state[i] = buffer[i]
    return 1


@njit(void(ARRAY, float64, float64, float64), nogil=True)
def write_buffer(buffer, fx, fy, fz):
    buffer[8], buffer[9], buffer[10] = fx, fy, fz


class BufferLink(CompiledLink):
    """A link that reads from a buffer, and writes the force to it."""

    def __init__(self, buffer: np.ndarray) -> None:
        super().__init__("the buffer", 8.0)
        self.buffer = buffer
        self.exchanged = 0

    def _read(self) -> HapticState:
        return HapticState(tuple(self.buffer[:3]), tuple(self.buffer[3:6]), 0.0, int(self.buffer[6]))

    def _send(self, force: Force) -> None:
        self.buffer[8:] = force

    @property
    def applied(self) -> Force:
        return Force(*self.buffer[8:].tolist())

    def _release(self) -> None:
        pass

    def kernels(self) -> LinkKernels:
        return LinkKernels(read_buffer, write_buffer, (self.buffer,))

    @property
    def exchanges(self) -> bool:
        return True

    def _exchange(self) -> None:
        self.exchanged += 1


BUFFER = np.zeros(11)


class BufferDevice(HapticDevice):
    """A device whose links share one buffer."""

    def spec(self) -> DeviceSpec:
        return SPEC

    def open(self) -> Link:
        return BufferLink(BUFFER)


@pytest.fixture
def buffer() -> np.ndarray:
    BUFFER[:] = 0
    BUFFER[7] = 1
    return BUFFER


def open_link(buffer: np.ndarray, **options: object) -> Link:
    return map_device(BufferDevice(), WorkspaceMapping(**options)).open()


def hold(buffer: np.ndarray, link: Link, x: float, y: float, z: float, buttons: int = 0) -> HapticState:
    buffer[:7] = x, y, z, 0, 0, 0, buttons
    return link.read()


def push(link: Link, *force: float) -> Force:
    link.write(Force(*force))
    return link.applied


def to_picture(place: Placement, hand_m: tuple[float, float, float]) -> tuple[float, ...]:
    """Return the point of the picture at a point of the hand, by the kernel."""
    state = np.array([*hand_m, 0.0, 0.0, 0.0, 0.0])
    kernels.place(place, np.zeros(kernels.MEMORY), state)
    return tuple(state[:3].tolist())


def to_hand(place: Placement, picture_m: tuple[float, ...]) -> tuple[float, float, float]:
    """Return the point of the hand at a point of the picture, by the formula h = o + k R (s - c)."""
    x, y, z = picture_m
    x, y = x - place.centre_x_m, y - place.centre_y_m
    x, y = place.cos * x - place.sin * y, place.sin * x + place.cos * y
    return place.offset_x_m + place.scale * x, place.offset_y_m + place.scale * y, place.offset_z_m + place.scale * z


class TestInPlainPython:
    @given(placements, points)
    def test_placement_agrees_with_kernel_and_inverse(self, place: Placement, point: tuple[float, float, float]):
        size = max(1.0, 1.0 / place.scale, place.scale)
        close = partial(pytest.approx, abs=1e-12 * size)
        assert to_picture(place, place.under_hand(point)) == close(point)
        assert place.under_hand(to_picture(place, point)) == close(point)
        assert place.under_hand(point) == close(to_hand(place, point))

    def test_intended_path_is_where_the_link_puts_the_hand(self):
        mapping = WorkspaceMapping(
            region_m=(0.01, -0.005, 0.02, 0.01), rotation_deg=30, offset_m=(0.001, 0.01, 0.02), scale=1.5
        )
        device, ticks = map_device(Mock(), mapping), np.arange(0, 900, 300)
        hand_m = Mock().wanted(ticks)
        assert hand_m.all() and np.ptp(hand_m[:, 0]) > 0.01  # no axis is left out
        there = [to_picture(placement_of(device), tuple(each)) for each in hand_m.tolist()]
        assert intended_path(device, ticks) == pytest.approx(np.array(there), abs=1e-15)
        assert intended_path(BufferDevice(), ticks) is None
        assert placement_of(Mock()) == Placement()


class TestGeometry:
    @given(placements, points)
    def test_velocity_is_mapped_like_points(self, place: Placement, point: tuple[float, float, float]):
        state = np.array([*point, *point, 3.0])
        kernels.place(place, np.zeros(kernels.MEMORY), state)
        still = np.subtract(to_picture(place, point), to_picture(place, (0.0, 0.0, 0.0)))
        assert state[3:6] == pytest.approx(still, abs=1e-12 * max(1.0, 1.0 / place.scale))
        assert state[6] == 3.0

    @given(placements, points)
    def test_forces_are_rotated_and_keep_their_size(self, place: Placement, force: tuple[float, float, float]):
        """Compare the work at the hand, which is `scale` times that in the picture, and of the same sign."""
        x, y, z = kernels.push(place, np.zeros(kernels.MEMORY), *force)
        assert math.hypot(x, y, z) == pytest.approx(math.hypot(*force), abs=1e-15, rel=1e-12)
        assert (*place.rotate_back(x, y), z) == pytest.approx(force, abs=1e-12)
        step = (0.01, -0.02, 0.005)
        way = np.subtract(to_hand(place, step), to_hand(place, (0.0, 0.0, 0.0)))
        assert np.dot((x, y, z), way) == pytest.approx(place.scale * np.dot(force, step), abs=1e-12 * (1 + place.scale))

    def test_spec_is_in_metres_and_quarter_turns_are_exact(self):
        """Rotate a picture counter-clockwise: its bottom comes to lie right of the hand."""
        for degrees, seen in ((0, (0.03, 0.01)), (90, (0.01, -0.03)), (180, (-0.03, -0.01)), (-90, (-0.01, 0.03))):
            place = WorkspaceMapping(rotation_deg=degrees).placement(SPEC.workspace_m)
            assert to_picture(place, (0.03, 0.01, 0.002)) == (*seen, 0.002)
        mapping = WorkspaceMapping(scale=2, rotation_deg=90)
        spec = mapping.spec_on_picture(DeviceSpec(8.0, 3000.0, 20.0, (0.1, 0.06, 0.08), 2e-5, buttons=4))
        assert spec == DeviceSpec(8.0, 6000.0, 40.0, (0.03, 0.05, 0.04), 1e-5, buttons=4)
        assert MappedDevice(device=Mock(), mapping=mapping).spec() == mapping.spec_on_picture(SPEC)
        mapped = MappedDevice(device=Pointer(channel="hand"), mapping=mapping)
        assert (mapped.follows("hand"), mapped.follows("pointer")) == (True, False)

    def test_rotated_region_fills_the_workspace_unless_a_scale_is_given(self):
        assert WorkspaceMapping(region_m=(0, 0, 0.02, 0.01), scale=2).placement(SPEC.workspace_m).scale == 2
        place = WorkspaceMapping(region_m=(0.01, -0.005, 0.02, 0.01)).placement((0.08, 0.08, 0.08))
        assert (place.scale, to_picture(place, (-0.04, 0.02, 0.004))) == (4, (0.0, 0.0, 0.001))
        place = WorkspaceMapping(region_m=(0, 0, 0.02, 0.01), rotation_deg=90).placement((0.08, 0.16, 0.08))
        assert place.scale == 8
        assert to_hand(place, (0.01, 0.005, 0.0)) == pytest.approx((-0.04, 0.08, 0.0), abs=1e-15)


class TestClutch:
    def test_clutch_moves_the_picture_with_the_hand_from_the_start_or_later(self, buffer: np.ndarray):
        link = open_link(buffer, clutch_button=1, scale=2.0)
        assert hold(buffer, link, 0.02, 0.0, 0.01).position_m == (0.01, 0.0, 0.005)
        for x in (0.02, 0.01, -0.02):
            assert hold(buffer, link, x, x - 0.02, 0.03, 2).position_m == pytest.approx((0.01, 0.0, 0.015))
        assert hold(buffer, link, -0.02, -0.04, 0.01).position_m == pytest.approx((0.01, 0.0, 0.005))
        assert hold(buffer, link, 0.0, -0.04, 0.01).position_m == pytest.approx((0.02, 0.0, 0.005))
        link = open_link(buffer, clutch_button=0)
        assert hold(buffer, link, 0.02, 0.0, 0.01, 1).position_m == (0.02, 0.0, 0.01)
        link = open_link(buffer, clutch_button=1)
        hold(buffer, link, 0.0, 0.0, 0.0, 5)
        assert hold(buffer, link, 0.01, 0.0, 0.0, 5).position_m == (0.01, 0.0, 0.0)
        assert push(link, 0.0, 0.0, 1.0) == (0, 0, 1)

    @pytest.mark.parametrize("part", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)])
    def test_clutch_mutes_until_every_component_of_the_force_is_zero(self, buffer: np.ndarray, part: tuple[float, ...]):
        link = open_link(buffer, clutch_button=0)
        hold(buffer, link, 0.0, 0.0, -0.001, 1)
        hold(buffer, link, 0.0, 0.0, -0.001)
        assert push(link, *part) == NO_FORCE
        assert push(link, *part) == NO_FORCE
        assert push(link, *NO_FORCE) == NO_FORCE
        assert push(link, *part) == part

    def test_clutch_gives_no_velocity_and_mutes_the_force(self, buffer: np.ndarray):
        link = open_link(buffer, clutch_button=0, scale=2.0, rotation_deg=90.0)
        for buttons, seen in ((0, (0.2, -0.1, 0.3)), (1, (0.0, 0.0, 0.3))):
            buffer[:7] = 0.01, 0.02, 0.03, 0.2, 0.4, 0.6, buttons
            assert link.read().velocity_m_per_s == pytest.approx(seen)
        link = open_link(buffer, clutch_button=0)
        hold(buffer, link, 0.0, 0.0, -0.001)
        assert push(link, 0.0, 0.0, 1.0) == (0, 0, 1)
        hold(buffer, link, 0.0, 0.0, -0.001, 1)
        assert push(link, 0.0, 0.0, 1.0) == NO_FORCE
        assert push(link, *NO_FORCE) == NO_FORCE
        hold(buffer, link, 0.0, 0.0, -0.02)
        assert push(link, 0.0, 0.0, 7.0) == NO_FORCE
        hold(buffer, link, 0.0, 0.0, 0.01)
        assert push(link, *NO_FORCE) == NO_FORCE
        hold(buffer, link, 0.0, 0.0, -0.001)
        assert push(link, 0.0, 0.0, 1.0) == (0, 0, 1)


class TestLimits:
    @pytest.mark.parametrize(
        "place",
        [
            *[(0.031, 0, 0), (0, -0.021, 0), (0, 0, 0.011), (-0.031, 0, 0), (0, 0.021, 0), (0, 0, -0.011)],
            *[(math.nan, 0, 0), (0, math.nan, 0), (0, 0, math.nan)],
        ],
    )
    def test_limits_give_no_force_outside(self, buffer: np.ndarray, place: tuple[float, float, float]):
        link = open_link(buffer, limits_m=(0.06, 0.04, 0.02))
        hold(buffer, link, 0.03, -0.02, 0.01)
        assert push(link, 1.0, 0.0, 0.0) == (1, 0, 0)
        hold(buffer, link, *place)
        assert push(link, 1.0, 0.0, 0.0) == NO_FORCE

    def test_limits_give_no_energy_when_entered_inside_the_surface(self, buffer: np.ndarray):
        """A hand that pressed in where force is barred is not thrown out where it is allowed."""
        link = open_link(buffer, limits_m=(0.06, 0.06, 0.06))
        for x, z, given_n in ((0.04, -0.01, 0.0), (0.0, -0.01, 0.0), (0.0, 0.01, 0.0), (0.0, -0.01, 8.0)):
            hold(buffer, link, x, 0.0, z)
            assert push(link, 0.0, 0.0, max(0.0, -800 * z)).z == given_n


class TestKernels:
    def test_kernels_agree_with_the_methods_and_exchange_with_the_device(self, buffer: np.ndarray):
        options = {"scale": 3.0, "rotation_deg": 30.0, "offset_m": (0.01, 0.02, 0.03), "clutch_button": 0}
        rng = np.random.default_rng(0)
        by_method, by_kernel = open_link(buffer, **options), open_link(buffer, **options)
        assert isinstance(by_kernel, CompiledLink)
        own = by_kernel.kernels()
        state = np.zeros(7)
        for _ in range(50):
            buffer[:6], buffer[6] = rng.uniform(-0.05, 0.05, 6), rng.integers(2)
            force = rng.uniform(-3, 3, 3) * rng.integers(2)
            seen = by_method.read()
            assert own.read(*own.fixed, state) == 1
            assert state == pytest.approx([*seen.position_m, *seen.velocity_m_per_s, seen.buttons], abs=1e-15)
            by_method.write(Force(*force))
            applied = buffer[8:].copy()
            own.write(*own.fixed, *force)
            assert np.array_equal(buffer[8:], applied)
        buffer[7], before = 0, state.copy()
        assert own.read(*own.fixed, state) == 0
        assert np.array_equal(state, before), "a stale state stays"
        link = open_link(buffer, scale=2.0)
        assert isinstance(link, CompiledLink) and link.exchanges
        link.exchange()
        link.write(Force(1.0, 2.0, 3.0))
        assert buffer[8:].tolist() == [1, 2, 3]
        link.close()
        assert link.applied == NO_FORCE


class TestDevice:
    def test_identity_mapping_returns_the_device_itself(self):
        mock = Mock()
        for nothing in ({}, {"rotation_deg": -360.0}, {"region_m": (0, 0, 0.08, 0.08)}):
            assert map_device(mock, WorkspaceMapping(**nothing)) is mock

    @pytest.mark.parametrize("check", DEVICE_CHECKS)
    def test_mapped_device_passes_the_device_checks(self, check):
        mapping = WorkspaceMapping(scale=2.5, rotation_deg=37.0, offset_m=(0.01, -0.01, 0.0), clutch_button=3)
        check(MappedDevice(device=Mock(), mapping=mapping))


def test_wrong_options_are_refused():
    for name, wrong in (
        ("scale", 0), ("scale", math.nan), ("rotation_deg", 1000), ("region_m", (0, 0, 0, 1)), ("region_m", (0, 0, 1)),
        ("offset_m", (math.inf, 0, 0)), ("clutch_button", -1), ("limits_m", (1, 1, 0)), ("zoom", 2),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=name):
            WorkspaceMapping(**{name: wrong})


@pytest.mark.parametrize(
    ("mapping", "area_m"),
    [
        ({"offset_m": (0.01, 0.0, 0.0)}, (0.06, 0.06)),  # centred on the device: what is as far on both sides
        ({"offset_m": (-0.04, 0.0, 0.0)}, (0.08, 0.06)),  # nothing of the picture is on one of the sides
        ({"offset_m": (0.0, 0.05, 0.0), "scale": 2.0}, (0.16, 0.02)),
        ({"region_m": (0.01, -0.02, 0.02, 0.02), "scale": 1.0}, (0.06, 0.02)),
        ({"rotation_deg": 90.0, "offset_m": (0.0, 0.01, 0.0)}, (0.06, 0.06)),
        ({"rotation_deg": 90.0}, (0.06, 0.08)),
        ({"rotation_deg": -30.0}, (0.06 / (0.5 + 0.75**0.5),) * 2),
    ],
)
def test_path_of_a_hand_is_over_the_picture_as_it_lies(mapping: dict, area_m: tuple[float, float]):
    """A picture of 80 by 60 mm; the path has a size of its own in the hand's metres."""
    found = over(MappedDevice(device=Mock(path="circle"), mapping=WorkspaceMapping(**mapping)), (0.08, 0.06))
    wanted = Mock(path="circle").over(area_m)
    assert isinstance(found, MappedDevice) and isinstance(found.device, Mock)
    assert found.device.wanted(np.arange(500)) == pytest.approx(wanted.wanted(np.arange(500)), abs=1e-9)
    assert found.mapping == WorkspaceMapping(**mapping)
    assert over(Mock(path="circle"), area_m) == wanted
