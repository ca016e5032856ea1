"""Packed touches, which one process passes on unread: a scene is lost or felt unlimited, or memory is never freed."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from faulty_touch import FaultyTouch
from loop_devices import Circling, Failing
from tangible_core import HapticSurface, load_method
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import NO_FORCE, Force, HapticState
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import Touch
from tangible_core.plugins.touch import PlainTouch
from tangible_core.servo import Packed, Ring, Safety, Servo, null_touch, pack_touch, parcel, ring
from tangible_core.servo.ring import shared_folder

pytestmark = pytest.mark.usefixtures("own_memory")

SPEC = Circling().spec()
STIFF_N_PER_M, DEPTH_M = 50_000.0, 1e-5


def stiff() -> Touch:
    level = HapticSurface.from_heights(np.full((16, 16), 0.002, np.float32))
    return load_method("render", "proxy")(stiffness_n_per_m=STIFF_N_PER_M).touch(level)


class Silent(PlainTouch):
    """A spring that does not state its stiffness."""

    def force(self, state: HapticState) -> Force:
        return Force(0.0, 0.0, max(0.0, -7000 * state.position_m[2]))


def of_a_dead_maker(touch: Touch) -> tuple[Path, float]:
    made = pack_touch(touch, SPEC)
    dead = made.parcel.with_name("tangible-999999999-a_b1.parcel")
    return made.parcel.rename(dead), made.stiffness_n_per_m


def parcels() -> set[Path]:
    return set(shared_folder().glob("*.parcel"))


@pytest.mark.usefixtures("loop_in_thread")
class TestStiffness:
    @pytest.mark.parametrize("touch", [stiff(), Silent()])
    @pytest.mark.parametrize("limits", [Safety(), Safety(coupling="auto")])
    def test_packed_touch_is_limited_like_the_touch(self, touch: Touch, limits: Safety):
        one = pack_touch(touch, SPEC)
        settings = [Servo(each, Circling(), limits)._arrays(each)[0] for each in (touch, one)]
        assert np.array_equal(*settings)
        assert one.stiffness_n_per_m > 5000
        one.discard()


class TestOwner:
    def test_parcel_of_killed_maker_is_adopted_unless_it_was_deleted(self):
        one = Packed(*of_a_dead_maker(stiff()))
        assert one.parcel.name == f"tangible-{os.getpid()}-a_b1.parcel"
        Ring.create(16).remove()  # which sweeps
        assert one.unused_parcel().exists()
        one.discard()
        one.discard()
        assert not parcels()
        path, stiffness = of_a_dead_maker(stiff())
        Ring.create(16).remove()
        with pytest.raises(DeviceError, match=r"the packed scene is missing .*; make it again"):
            Packed(path, stiffness)

    @pytest.mark.parametrize("name", ["tangible-1-x.ring", "x.parcel", "../tangible-1.parcel", ""])
    def test_file_that_is_not_a_parcel_is_left_alone(self, tmp_path: Path, name: str):
        with pytest.raises(DeviceError, match="is not the file of a packed scene"):
            Packed(tmp_path / name, 1.0)

    def test_touch_that_cannot_be_packed_leaves_no_file(self):
        class Local(Silent):
            """A class that no other process can import."""

        with pytest.raises(DeviceError, match="make it picklable"):
            pack_touch(Local(), SPEC)
        assert not parcels()


@pytest.mark.usefixtures("loop_in_thread")
class TestUse:
    @pytest.mark.parametrize("device", [Failing(opens="never"), Circling()])
    def test_parcel_of_loop_that_does_not_start_is_deleted(self, device, monkeypatch: pytest.MonkeyPatch):
        one = pack_touch(stiff(), SPEC)
        if isinstance(device, Circling):  # there is no room for the ring
            monkeypatch.setattr(ring, "_size", lambda slots: 1 << 62)
        with pytest.raises(DeviceError), Servo(one, device):
            pass
        assert not parcels()

    def test_packed_touch_is_used_once_and_the_scene_before_stays(self):
        with Servo(null_touch(), Failing(fault="none")) as servo:
            one = pack_touch(FaultyTouch(), SPEC)
            servo.swap(one)
            with pytest.raises(DeviceError, match="already used or discarded"):
                servo.swap(one)
            broken = pack_touch(FaultyTouch("does not arrive"), SPEC)
            with pytest.raises(LookupError, match="the law's data is not in process"):
                servo.swap(broken)
            assert servo.running
            servo.stop()
            late = pack_touch(FaultyTouch(), SPEC)
            with pytest.raises(DeviceError, match="has ended"):
                servo.swap(late)
        assert not parcels()


SERVER = """
import json, sys, time
from tangible_core.data import TickFlag
from tangible_core.servo import Packed, Safety, Servo, null_touch
from loop_devices import Circling

def wait(ticks):
    end, there = time.monotonic() + 60, servo.ring.count
    while servo.ring.count < there + ticks:
        assert servo.running and time.monotonic() < end
        time.sleep(0.005)

path, stiffness, z_m = sys.argv[1:]
with Servo(null_touch(), Circling(z_m=float(z_m)), Safety(ramp_s=0)) as servo:
    wait(50)
    servo.swap(Packed(path, float(stiffness)))
    wait(500)
    servo.stop()
    rows = servo.ring.since(0)[0]
flags = rows[:, -3].astype(int)
(swapped,) = (flags & TickFlag.SWAPPED).nonzero()[0]
print(json.dumps({
    "how": servo.how,
    "before_n": float(abs(rows[:swapped, 11:14]).max()),
    "after_n": float(rows[-1, 13]),
    "limited": bool(flags[-1] & TickFlag.STIFFNESS_LIMITED),
    "imported": sorted({"numba", "cv2", "llvmlite"} & sys.modules.keys()),
}))
"""


def test_process_without_kernels_starts_with_null_touch_and_passes_a_scene_on():
    made = pack_touch(stiff(), SPEC)
    words = [str(made.parcel), str(made.stiffness_n_per_m), str(0.002 - DEPTH_M)]
    ran = subprocess.run([sys.executable, "-c", SERVER, *words], capture_output=True, text=True, timeout=120)
    assert ran.returncode == 0, ran.stderr
    said = json.loads(ran.stdout)
    assert "the whole loop is compiled" in said["how"] or sys.platform != "linux"
    assert (said["imported"], said["before_n"]) == ([], 0)
    assert said["limited"]
    assert 0 < said["after_n"] < 0.5 * STIFF_N_PER_M * DEPTH_M
    assert not parcels()


class TestNullTouch:
    def test_null_touch_has_no_force_anywhere(self):
        here, there = null_touch(), parcel.unpack(parcel.pack(null_touch()))
        assert isinstance(there, CompiledTouch)
        places = np.random.default_rng(0).uniform(-1, 1, (100, 3)) * np.logspace(-9, 3, 100)[:, None]
        places[:3] = np.nan, np.inf, 0
        for touch in (here, there):
            assert touch.stiffness_n_per_m == 0
            assert touch.force(HapticState((0.0, 0.0, -1.0), (9.0, 9.0, 9.0))) == NO_FORCE
            assert not touch.path(places).any()
