"""Compiled kernels after an edit. Otherwise one would run as it was, or a guard be laid out as before."""

import os
import re
import shutil
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from contextlib import closing
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace

import pytest

import tangible_core
from forks import Forks
from tangible_core.provenance import numba_cache
from tangible_core.provenance.numba_cache import KEPT, extend

ACME = {
    "__init__": "",
    "kernels": """
        import numba
        from . import layout
        from .helper import more

        @numba.njit("float64(float64)", cache=True)
        def law(x):
            return more(x) * layout.GAIN
        """,
    "helper": """
        from numba import njit

        @njit(cache=True)
        def more(x):
            return x + 1.0
        """,
    "layout": "GAIN = 3.0\n",
    "neighbour": "",
}
CALL = "import tangible_core; from acme.kernels import law; print(law(1.0), len(law.stats.cache_misses))"
BEGUN = """
import numba, numba.core.caching
numba.njit("float64(float64)")(lambda x: x)
"""
"""What has imported numba and compiled with it."""


class Acme:
    """A package without knowledge of Tangible Images, whose kernel other processes call."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "acme"
        self.users = folder / "users"
        self.folder.mkdir()
        # Python takes a source that was edited within a second, at the same length, for the one that it compiled.
        fresh = {"PYTHONDONTWRITEBYTECODE": "1"}
        environment = {**os.environ, **fresh, "NUMBA_CACHE_DIR": "", "XDG_CACHE_HOME": str(self.users)}
        self._world = {"env": environment, "cwd": folder}
        for name, text in ACME.items():
            self.edit(name, textwrap.dedent(text))

    def edit(self, module: str, text: str) -> None:
        (self.folder / f"{module}.py").write_text(text)

    def run(self, code: str = CALL) -> list[str]:
        """Run code in a process that imports everything itself; return its words."""
        return subprocess.check_output([sys.executable, "-c", code], text=True, **self._world).split()

    @cached_property
    def _forks(self) -> Forks:
        return Forks([sys.executable, "-c", BEGUN], **self._world)

    def run_soon(self, code: str = CALL) -> list[str]:
        """Run code in a fork of a process that had imported numba; return its words."""
        return self._forks.run(f"import sys; sys.path.insert(0, ''); {code}").stdout.split()

    def close(self) -> None:
        if "_forks" in vars(self):
            self._forks.close()


@pytest.fixture
def acme(tmp_path: Path) -> Iterator[Acme]:
    with closing(Acme(tmp_path)) as acme:
        yield acme


@pytest.mark.whole
def test_kernel_is_recompiled_after_an_edit_of_its_imports_only(acme: Acme):
    assert (acme.run(), acme.run()) == (["6.0", "1"], ["6.0", "0"])
    acme.edit("neighbour", "GAIN = 5.0")
    assert acme.run_soon() == ["6.0", "0"]
    acme.edit("layout", "GAIN = 4.0\n")
    assert acme.run() == ["8.0", "1"]
    acme.edit("helper", ACME["helper"].replace("1.0", "2.0").replace("\n        ", "\n"))
    assert acme.run_soon() == ["12.0", "1"]


def test_kernel_of_an_undone_edit_is_loaded_within_the_kept_number(acme: Acme):
    gains = [float(gain) for gain in range(3, 3 + KEPT)]
    for gain in gains:
        acme.edit("layout", f"GAIN = {gain}\n")
        assert acme.run_soon() == [str(2 * gain), "1"]
    acme.edit("layout", f"GAIN = {gains[0]}\n")
    assert acme.run_soon() == [str(2 * gains[0]), "0"]
    for name in ("100.0", "101.0"):
        acme.edit("layout", f"GAIN = {name}\n")
        acme.run_soon()
    assert acme.run_soon() == ["202.0", "0"]
    for suffix in ("nbi", "nbc"):
        assert len(list((acme.folder / "__pycache__").glob(f"kernels.law-*.{suffix}"))) == KEPT


@pytest.mark.whole
def test_kernel_of_a_read_only_package_is_cached_in_the_users_folder(acme: Acme):
    (acme.folder / "__pycache__").write_text("no folder")
    assert [acme.run_soon(), acme.run_soon()] == [["6.0", "1"], ["6.0", "0"]]
    acme.edit("layout", "GAIN = 4.0\n")
    assert acme.run_soon() == ["8.0", "1"]
    assert list(acme.users.rglob("kernels.law-*.nbi"))


@pytest.mark.whole
def test_kernel_is_recompiled_also_if_numba_was_imported_first(acme: Acme):
    first = f"import numba; {CALL}"
    assert [acme.run(first), acme.run()] == [["6.0", "1"], ["6.0", "0"]]
    acme.edit("layout", "GAIN = 4.0\n")
    assert acme.run(first) == ["8.0", "1"]


@pytest.mark.whole
def test_kernel_compiled_by_an_old_process_after_an_edit_is_not_saved(acme: Acme):
    """Its constants are from before the edit, and the text that it could read is from after it."""
    edited = "import tangible_core, time; from acme import layout; time.sleep(0.05)"
    edit = "open('acme/layout.py', 'w').write('GAIN = 4.0')"
    assert acme.run_soon(f"{edited}; {edit}; {CALL}") == ["6.0", "1"]
    assert not list((acme.folder / "__pycache__").glob("kernels.law-*"))
    assert acme.run_soon() == ["8.0", "1"]


@pytest.mark.whole
def test_vectorized_kernels_are_recompiled_after_an_edit(acme: Acme):
    text = "import numba\nfrom . import layout\n@numba.{}(cache=True)\ndef law(x{}): {}\n"
    call = "import numpy as np, tangible_core; from acme import kernels; y = np.zeros(1); print(kernels.law(y, y)[0])"
    made = {
        "vectorize('f8(f8, f8)', ": text.format("X", ", y", "return layout.GAIN"),
        "guvectorize(['f8[:], f8[:], f8[:]'], '(n),(n)->(n)', ": text.format("X", ", y, z", "z[:] = layout.GAIN"),
    }
    for decorator, source in made.items():
        acme.edit("kernels", source.replace("X(", decorator))
        for gain in ("3.0", "4.0"):
            acme.edit("layout", f"GAIN = {gain}\n")
            assert acme.run_soon(call) == [gain]


def test_unknown_numba_version_disables_the_cache_with_a_warning(caplog: pytest.LogCaptureFixture, monkeypatch):
    class Cache:
        def __init__(self, py_func) -> None:
            self.kept = True

        def disable(self) -> None:
            self.kept = False

        def save_overload(self, sig, data) -> None: ...

        def _load_overload(self, sig, context) -> None: ...

    closure = SimpleNamespace(settled=True, digest="d")
    monkeypatch.setattr(numba_cache, "closure_of_function", lambda function: closure)
    extend(SimpleNamespace(Cache=Cache))
    assert not Cache(extend).kept
    assert "this version of numba is unknown" in caplog.text


PUSHED_FOR_A_SECOND = """
import pytest

import tangible_core
from tangible_core.data import DeviceSpec
from tangible_core.servo import Safety
from tangible_core.servo.guard.guard import guard

settings, memory = Safety(ramp_s=0, passivity="off").arrays(DeviceSpec(8.0, 3000.0, 1.5, (0.1, 0.1, 0.1), 3e-5), 0.0)
left = [guard(settings, memory, 0.001, *[0.0] * 6, 0.0, 0.0, 300.0)[2] for _ in range(1000)]
print(tangible_core.__file__, max(left), len(guard.stats.cache_misses))
"""


def push(packages: Path) -> tuple[float, int]:
    """Return the greatest output force for 300 N on a device of 8 N, and the number of compilations of the guard."""
    environment = {**os.environ, "PYTHONPATH": str(packages), "NUMBA_CACHE_DIR": ""}
    done = subprocess.run(
        [sys.executable, "-P", "-c", PUSHED_FOR_A_SECOND], capture_output=True, text=True, check=True, env=environment
    )
    file, force_n, compiled = done.stdout.split()
    assert Path(file).is_relative_to(packages)
    return float(force_n), int(compiled)


@pytest.mark.whole
def test_guard_is_recompiled_after_an_edit_of_its_layout(tmp_path: Path):
    shutil.copytree(
        Path(tangible_core.__file__).parent, tmp_path / "tangible_core", ignore=shutil.ignore_patterns("__pycache__")
    )
    assert push(tmp_path) == (8.0, 1)
    layout = tmp_path / "tangible_core" / "servo" / "guard" / "layout.py"
    names = layout.read_text()
    exchanged = {"MAX_FORCE_N": "MAX_STIFFNESS", "MAX_STIFFNESS": "MAX_FORCE_N"}
    layout.write_text("".join(exchanged.get(word, word) for word in re.split(r"\b", names)))
    assert push(tmp_path) == (8.0, 1)
    (tmp_path / "tangible_core" / "pipeline" / "engine.py").write_text("")
    assert push(tmp_path) == (8.0, 0)
