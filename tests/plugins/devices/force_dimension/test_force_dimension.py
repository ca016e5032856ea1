"""A Force Dimension device would push the wrong way or keep a force: over a library of the same functions."""

import sys
from types import ModuleType

import pytest

from tangible_core.data import NO_FORCE, Finding, Force, Unit
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.testing import run_checks
from tangible_devices.force_dimension.force_dimension import ForceDimension, check_result


class Library:
    """The functions of `forcedimension_core.dhd` that are used, over simulated devices."""

    def __init__(self) -> None:
        self.serials = [1234, 77]
        self.opened: set[int] = set()
        self.busy: set[int] = set()
        self.position = [0.01, 0.02, 0.03]
        self.velocity: list[float] | None = [0.0, 0.0, 0.0]
        self.forces: list[tuple[float, ...]] = []
        self.enabled = False
        self.gone = False

    def errorGetLastStr(self) -> str:
        return "the words of the library"

    def getDeviceCount(self) -> int:
        return len(self.serials)

    def openID(self, index: int) -> int:
        if index >= len(self.serials) or index in self.busy:
            return -1
        self.opened.add(index)
        return index

    def openSerial(self, serial: int) -> int:
        return self.openID(self.serials.index(serial)) if serial in self.serials else -1

    def close(self, ID: int = -1) -> int:
        self.opened.discard(ID)
        return 0

    def getSerialNumber(self, ID: int = -1) -> int:
        return self.serials[ID]

    def getSystemName(self, ID: int = -1) -> str | None:
        return "omega.3"

    def enableForce(self, enable: bool, ID: int = -1) -> int:
        self.enabled = enable
        return -self.gone

    def getPosition(self, out: list[float], ID: int = -1) -> int:
        out[:] = self.position
        return -1 if self.gone or ID not in self.opened else 1  # 1: too soon for a new one

    def getLinearVelocity(self, out: list[float], ID: int = -1) -> int:
        out[:] = self.velocity or [9.0, 9.0, 9.0]
        return -1 if self.velocity is None or ID not in self.opened else 0

    def getButtonMask(self, ID: int = -1) -> int:
        return 5

    def setForce(self, f: list[float], ID: int = -1) -> int:
        if self.gone or ID not in self.opened:
            return -1
        self.forces.append((f[0], f[1], f[2]))
        return 2  # a motor is saturated


@pytest.fixture
def dhd(monkeypatch: pytest.MonkeyPatch) -> Library:
    library, package = Library(), ModuleType("forcedimension_core")
    package.dhd = library
    monkeypatch.setitem(sys.modules, "forcedimension_core", package)
    monkeypatch.setitem(sys.modules, "forcedimension_core.dhd", library)
    return library


@pytest.fixture
def missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "forcedimension_core", None)


def test_force_dimension_conforms(dhd: Library):
    assert not [check for check in run_checks("device", "force-dimension") if not check.passed]
    assert (dhd.opened, dhd.forces[-1]) == (set(), (0, 0, 0))


class TestAxes:
    def test_positions_and_forces_are_rotated_between_axes(self, dhd: Library):
        """10 mm towards the user, 20 mm to the right, 30 mm up."""
        dhd.velocity = [1.0, 2.0, 3.0]
        with ForceDimension().open() as link:
            state = link.read()
            assert (state[:2], state.buttons) == (((0.02, -0.01, 0.03), (2.0, -1.0, 3.0)), 5)
            link.write(Force(1.0, 2.0, 3.0))
            assert dhd.enabled
        assert dhd.forces == [(0, 0, 0), (-2, 1, 3), (0, 0, 0)]
        dhd.velocity = None
        with ForceDimension().open() as link:
            assert link.read().velocity_m_per_s == (0, 0, 0)

    @pytest.mark.parametrize(("model", "most"), [("omega", 12.0), ("delta", 20.0), ("sigma", 12.0), ("falcon", 8.0)])
    def test_spec_has_limits_of_the_model(self, dhd: Library, model: str, most: float):
        with ForceDimension(model=model).open() as link:
            link.write(Force(0.0, 0.0, 100.0))
            assert link.applied == (0, 0, most)


class TestFaults:
    def test_open_without_package_names_what_to_install(self, missing: None):
        with pytest.raises(DeviceAbsent, match=r"pip install forcedimension-core"):
            ForceDimension().open()

    def test_open_without_a_free_device_is_refused(self, dhd: Library):
        dhd.busy.add(0)
        with pytest.raises(DeviceError, match="the words of the library"):
            ForceDimension().open()
        with ForceDimension(index=1).open() as link:
            link.read()
        with ForceDimension(serial=77).open() as link:
            with pytest.raises(DeviceError, match="open already"):
                ForceDimension(serial=77).open()
            link.read()
        ForceDimension(serial=77).open().close()
        with pytest.raises(DeviceError, match="serial 5"):
            ForceDimension(serial=5).open()
        dhd.serials.clear()
        with pytest.raises(DeviceAbsent, match="plug it in"):
            ForceDimension().open()

    def test_link_unplugged_is_refused(self, dhd: Library):
        link = ForceDimension().open()
        link.write(Force(0.0, 0.0, 1.0))
        dhd.gone = True
        with pytest.raises(DeviceError, match="reading its position"):
            link.read()
        with pytest.raises(DeviceError, match="setting its force"):
            link.write(Force(0.0, 0.0, 1.0))
        assert link.applied == NO_FORCE
        link.close()
        dhd.gone = False
        ForceDimension().open().close()

    @pytest.mark.parametrize("result", [-1, -2, -1000])
    def test_check_result_negative_is_an_error(self, dhd: Library, result: int):
        with pytest.raises(DeviceError, match="pushing: the words of the library"):
            check_result(dhd, result, "pushing", "push again")
        assert [check_result(dhd, each, "pushing", "") for each in (0, 1, 2)] == [0, 1, 2]

    @pytest.mark.parametrize("kind", ["position", "velocity"])
    @pytest.mark.parametrize("bad", [[0.0, 0.0, float("nan")], [float("inf"), 0.0, 0.0]])
    def test_read_of_nonfinite_state_is_refused(self, dhd: Library, kind: str, bad: list[float]):
        setattr(dhd, kind, bad)
        with ForceDimension().open() as link, pytest.raises(DeviceError, match="its position is"):
            link.read()


class TestService:
    def test_connected_and_doctor_list_library_and_devices(self, dhd: Library):
        dhd.busy.add(1)
        first, second = ForceDimension().connected()
        assert first == Unit("omega.3", "1234", "index 0")
        assert (second.problem, dhd.opened) == ("the words of the library", set())
        dhd.busy.add(1)
        library, first, second = ForceDimension().examine()
        assert {library.verdict, first.verdict} == {"fine"}
        assert second.verdict == "failed" and "close other programs" in second.cure
        dhd.serials.clear()
        assert [each.verdict for each in ForceDimension().examine()] == ["fine", "not asked"]

    def test_doctor_without_package_has_not_asked(self, missing: None):
        [finding] = ForceDimension().examine()
        assert isinstance(finding, Finding) and finding.verdict == "not asked"
