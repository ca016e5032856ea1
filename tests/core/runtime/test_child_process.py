"""Child processes run the code of this process: else a file of a downloads folder runs, or another law is felt."""

import importlib.util
import json
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from distributions import distribution
from tangible_bench.config.reading import parse_comparison
from tangible_bench.measuring.plan import measurements
from tangible_bench.measuring.run import look, run
from tangible_core import HapticSurface, load_method
from tangible_core.errors import BrokenMethod
from tangible_core.plugins.registry import Registry
from tangible_core.runtime.child_process import dumps, python, search_path
from tangible_core.servo import Servo

TANGIBLE = str(Path(sys.executable).with_name("tangible"))
TRAP = "import pathlib; pathlib.Path({marker!r}).write_text('I ran')\nraise SystemExit\n"
FEEL = "scene: {height: level.npy}\nwant: touch\nworkspace: {width_m: 0.02, relief_m: 0.002}\ndevice: {use: mock}\n"
COMPARE = """\
compare: depth
methods: [acme]
scenes: [{synthetic: steps, width_px: 64, height_px: 32}]
repeats: 1
warmups: 0
calls: 1
"""
SURFACE = HapticSurface.from_heights(np.full((8, 8), 0.002, np.float32))
ACME = '''
import os, pathlib
import numpy as np
from tangible_core import DisparityMap, Force
from tangible_core.plugins import DepthEstimator, ForceRenderer, HapticDevice
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import DeviceSpec
from tangible_core.plugins.interfaces import PlainTouch

FELT = pathlib.Path(__file__).with_suffix(f".{os.getpid()}.felt")


class Law(ForceRenderer):
    """A force law that leaves a file next to its own when it is called."""

    def touch(self, surface):
        return LawTouch()


class LawTouch(PlainTouch):
    def force(self, state):
        FELT.touch()
        return Force(0.0, 0.0, 0.0)


class Tip(HapticDevice):
    """A device that is never opened."""

    def spec(self):
        return DeviceSpec(8.0, 3000.0, 20.0, (0.1, 0.1, 0.1), 1e-6, simulated=True)

    def open(self):
        FELT.touch()


class Flat(DepthEstimator):
    """A depth method that returns zeros."""

    def estimate(self, views):
        return DisparityMap(np.zeros(views.shape, np.float32))


def tick(x, y, z, vx, vy, vz):
    return 0.0, 0.0, 0.0


tick.py_func = tick  # a kernel is pickled by this attribute


def kernel():
    return CompiledTouch(tick, ())
'''


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return the folder in which a user works."""
    work = tmp_path / "work"
    work.mkdir()
    np.save(work / "level.npy", np.full((8, 8), 0.5))
    return work


def feel(cwd: Path, render: str, **variables: str) -> None:
    cwd.joinpath("p.yaml").write_text(FEEL + f"render: {{use: {render}}}\n")
    words, env = [TANGIBLE, "feel", "p.yaml", "--seconds", "0.05"], {**os.environ, **variables}
    done = subprocess.run(words, cwd=cwd, env=env, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr


def install_acme(folder: Path) -> Path:
    """Install a distribution `acme` with one force law and one depth method."""
    points = {"tangible.render": {"acme": "acme:Law"}, "tangible.depth": {"acme": "acme:Flat"}}
    return distribution(folder, "acme", points, acme=ACME)


class TestTheCurrentFolder:
    @pytest.mark.whole
    def test_feel_runs_nothing_of_the_current_folder(self, folder: Path) -> None:
        marker = folder / "ran.txt"
        for name in ("numba", "numpy", "pickle", "importlib", "tangible_core"):
            folder.joinpath(f"{name}.py").write_text(TRAP.format(marker=str(marker)))
        feel(folder, "proxy")
        assert not marker.exists()

    def test_feel_uses_the_installed_plugin_and_not_a_file_of_its_name(self, folder: Path, tmp_path: Path) -> None:
        site = install_acme(tmp_path / "site")
        folder.joinpath("acme.py").write_text(ACME)
        feel(folder, "acme", PYTHONPATH=str(site))
        assert list(site.glob("*.felt"))
        assert not list(folder.glob("*.felt"))


class TestSearchPath:
    @pytest.fixture(autouse=True)
    def path(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(folder)
        monkeypatch.setattr(sys, "path", ["", "lib", "/opt/lib"])

    @pytest.mark.parametrize("file", ["", "beside.py", "beside/inner.py"])
    def test_search_path_has_the_current_folder_if_a_module_came_from_it(
        self, folder: Path, file: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        if file:
            folder.joinpath(file).parent.mkdir(exist_ok=True)
            folder.joinpath(file).touch()
            importlib.invalidate_caches()
            monkeypatch.delitem(sys.modules, "beside", raising=False)
            importlib.import_module("beside")
        assert search_path() == [*([str(folder)] if file else []), str(folder / "lib"), "/opt/lib"]
        sys.modules.pop("beside", None)

    def test_search_path_in_a_deleted_folder_leaves_out_the_empty_entry(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(sys, "path", ["", "/opt/lib"])
        folder.joinpath("level.npy").unlink()
        folder.rmdir()
        assert search_path() == ["/opt/lib"]


def test_command_sets_the_path_before_any_import(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = [*map(str, map(Path.absolute, map(Path, sys.path))), str(folder / 'it\'s "mine" \udce4')]
    monkeypatch.setattr(sys, "path", path)
    done = subprocess.run(
        python("import json; print(json.dumps([sys.path, sys.flags.safe_path]))"), capture_output=True, check=True
    )
    assert json.loads(done.stdout) == [path, True]


@pytest.mark.parametrize("flags", [[], ["-E"], ["-I"]])
def test_command_has_the_flags_of_this_python(flags: list[str]) -> None:
    """The command is built in a Python with these flags, and checked here."""
    code = f"import sys; sys.path[:] = {sys.path!r}; from tangible_core.runtime.child_process import command; "
    code += "print(*command('x')[1:-2])"
    done = subprocess.run([sys.executable, *flags, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split()[0] == "-P"
    assert set(done.stdout.split()) >= {"-P", *flags}


class TestOrigins:
    @pytest.fixture
    def site(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        """Return the folder where a child finds `acme`."""
        site = install_acme(tmp_path / "site")
        monkeypatch.syspath_prepend(site)
        return site

    @pytest.fixture
    def elsewhere(self, site: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
        """Return the module `acme` as this process has it, from another folder."""
        path = site.parent / "elsewhere" / "acme.py"
        path.parent.mkdir()
        path.write_text(ACME)
        spec = importlib.util.spec_from_file_location("acme", path)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, "acme", module)
        spec.loader.exec_module(module)
        yield module
        sys.modules.pop("acme", None)

    def check_refusal(self, name: str, site: Path, error: object) -> None:
        assert f"{name} of {site.parent / 'elsewhere' / 'acme.py'}" in str(error)
        assert f"there the module is {site / 'acme.py'}" in str(error)
        assert not list(site.glob("*.felt"))

    @pytest.mark.parametrize("name", ["LawTouch", "Tip"])
    def test_force_law_or_device_of_another_file_is_refused(self, site: Path, elsewhere: Any, name: str) -> None:
        touch, device = load_method("render", "proxy")().touch(SURFACE), load_method("device", "mock")()
        touch, device = (elsewhere.LawTouch(), device) if name == "LawTouch" else (touch, elsewhere.Tip())
        with pytest.raises(BrokenMethod) as raised, Servo(touch, device):
            pytest.fail("it was felt")
        self.check_refusal(name, site, raised.value)

    def test_compared_method_of_another_file_is_refused(self, site: Path, elsewhere: Any, tmp_path: Path) -> None:
        outlook = look(measurements(parse_comparison(COMPARE, Path("c.yaml"), Registry())), tmp_path / "r.jsonl")
        [row] = run(outlook, tmp_path / "r.jsonl", 60, lambda *_: None, lambda *_: None).values()
        self.check_refusal("Flat", site, row.error)

    def test_kernel_of_another_file_is_refused_and_of_the_same_by_a_link_accepted(
        self, site: Path, elsewhere: Any
    ) -> None:
        kernel, law = dumps(elsewhere.kernel()), dumps(elsewhere.Law())
        del sys.modules["acme"]
        with pytest.raises(BrokenMethod) as raised:
            pickle.loads(kernel)
        self.check_refusal("tick", site, raised.value)
        other = site.parent / "elsewhere" / "acme.py"
        other.unlink()
        other.symlink_to(site / "acme.py")
        assert type(pickle.loads(law)).__name__ == "Law"

    def test_class_of_a_missing_module_is_refused(
        self, site: Path, elsewhere: Any, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        sent = dumps(elsewhere.Law())
        del sys.modules["acme"]
        monkeypatch.setattr(sys, "path", [])
        with pytest.raises(BrokenMethod, match="No module named 'acme'"):
            pickle.loads(sent)

    def test_local_object_raises_the_error_of_pickle(self) -> None:
        class Local:
            pass

        for thing in (Local, Local(), lambda: None):
            with pytest.raises((pickle.PicklingError, AttributeError), match=r"local|lambda|Local"):
                dumps(thing)

    @pytest.mark.whole
    def test_force_law_of_a_notebook_or_a_script_is_refused_with_the_cure(self, tmp_path: Path) -> None:
        code = ACME.replace("__file__", "'felt'") + FEELS_ITS_OWN
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
        assert done.stdout.startswith("BrokenMethod LawTouch of "), done.stderr
        assert "to a module" in done.stdout


FEELS_ITS_OWN = """
from tangible_core import HapticSurface, load_method
from tangible_core.servo import Servo
try:
    with Servo(Law().touch(HapticSurface.from_heights(np.zeros((2, 2)))), load_method("device", "mock")()):
        pass
except Exception as error:
    print(type(error).__name__, error)
"""
