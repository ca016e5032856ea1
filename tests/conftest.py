"""What every test stands on: repeatable hypothesis, a cache and plugins of its own."""

import gc
import os
import sys
import tempfile
from collections.abc import Callable, Generator, Iterator
from importlib import metadata
from itertools import count
from pathlib import Path
from typing import Any
from unittest.mock import patch

import jaxtyping
import pytest
from _pytest.doctest import DoctestModule
from hypothesis import settings

from distributions import Points, distribution

os.environ["MPLBACKEND"] = "Agg"
os.environ["LC_ALL"] = "C.UTF-8"  # the tests are about the English texts, whatever language their reader has chosen
HELPERS = str(Path(__file__).parent / "helpers")
# processes that a test starts find the helpers too
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [os.environ.get("PYTHONPATH"), HELPERS]))
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # torch's threads spin, and take the processor from the other workers

if os.environ.get("TANGIBLE_CHECKED_CALLS"):
    from checked_calls import check

    check()  # before the first of our modules is imported

# Before Python 3.12, dask imports it, and it replaces the standard library's finder: entry points are then of a class
# that no hint names, and whatever test comes next in this worker fails.
sys.modules.setdefault("importlib_metadata", metadata)

settings.register_profile("default", deadline=None, max_examples=10)
settings.register_profile("ci", settings.get_profile("default"), derandomize=True, print_blob=True)
settings.register_profile("nightly", settings.get_profile("default"), max_examples=200)
settings.load_profile("nightly" if "--nightly" in sys.argv else "ci" if os.environ.get("CI") else "default")

Install = Callable[..., Path]
OWN = ("cache", "runtime", "config", "log", "models")
"""Folders that each test has of its own, told by an environment variable each."""
FIRST = ("test_every_processor.py", "test_third_party.py")
"""Files of the tests that take longest, minutes each: at the end, all other workers would wait for them."""
STANDSTILL_S = 30.0
"""Longer than any machine lets a loop stand still, however busy it is."""
RINGS = ("whole", "nightly")
"""Marks of tests that run when they are asked for: `pytest --whole`, `pytest --whole --nightly`."""


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """None beside this process where files are named: a debugger works, nothing is waited for."""
    if config.args_source is pytest.Config.ArgsSource.ARGS:
        return 0
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return processors + processors // 2


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options that run more than every change needs, or less."""
    group = parser.getgroup("tangible")
    group.addoption(
        "--whole", action="store_true", help="run all browser cases, killed servers, peers, slow variants too"
    )
    group.addoption("--nightly", action="store_true", help="run millions of ticks, every processor, 200 examples too")
    group.addoption("--since", metavar="REVISION", help="run only what changes since then, e.g. origin/main, can break")


class DoctestsWhereThereAreSome:
    """A plugin for all folders: a file without a prompt is not imported for its docstrings."""

    @pytest.hookimpl(wrapper=True)
    def pytest_collect_file(self, file_path: Path) -> Generator[None, list[Any], list[Any]]:
        found = yield
        if not any(isinstance(each, DoctestModule) for each in found) or ">>>" in file_path.read_text("utf-8"):
            return found
        return [each for each in found if not isinstance(each, DoctestModule)]


def pytest_configure(config: pytest.Config) -> None:
    """Beside others, compile what they do not."""
    config.pluginmanager.register(DoctestsWhereThereAreSome())
    if "PYTEST_XDIST_WORKER" in os.environ:
        from compiled_once import compile_once

        compile_once()


gc.disable()


def pytest_collection_finish() -> None:
    """What is imported by now stays: the garbage collector need not look at it, neither before nor again and again."""
    gc.freeze()
    gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what was not asked for, unless tests are named by their ids; put first what takes minutes."""
    unasked = {ring for ring in RINGS if not config.getoption(ring)}
    named = [arg for arg in config.args if "::" in arg]
    left_out = {item for item in items if unasked & {mark.name for mark in item.iter_markers()} and not named}
    if revision := config.getoption("since"):
        from since import affected, changed_files

        chosen = affected({item.path for item in items}, changed_files(revision))
        left_out |= {item for item in items if item.path not in chosen}
    if left_out:
        config.hook.pytest_deselected(items=list(left_out))
        items[:] = [item for item in items if item not in left_out]
    items.sort(key=lambda item: item.path.name not in FIRST)


@pytest.fixture(scope="session")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A new folder each, made without looking at all there are."""
    parent = tmp_path_factory.mktemp("own")
    return (parent / str(number) for number in count())


@pytest.fixture(autouse=True)
def own_dir(folders: Iterator[Path]) -> Iterator[Path]:
    """A folder for what a test would read from, and leave in, the developer's own; one fixture, as all pay it."""
    folder = next(folders)
    with patch.dict(os.environ, {f"TANGIBLE_{kind.upper()}_DIR": f"{folder}/{kind}" for kind in OWN}):
        yield folder


@pytest.fixture(scope="session", autouse=True)
def shared_dir() -> Iterator[None]:
    """Memory of its own for the force loops of these tests: what one run sweeps away is never another's."""
    if "TANGIBLE_SHARED_DIR" in os.environ:
        yield
        return
    from tangible_core.servo.ring import shared_folder  # after `check`

    with (
        tempfile.TemporaryDirectory(prefix="tests-", dir=shared_folder()) as own,
        pytest.MonkeyPatch.context() as patch,
    ):
        patch.setenv("TANGIBLE_SHARED_DIR", own)
        yield


@pytest.fixture
def own_memory(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As `shared_dir`, of one test: what others have left there is none of its."""
    from tangible_core.servo.ring import shared_folder

    with tempfile.TemporaryDirectory(prefix="test-", dir=shared_folder()) as own:
        monkeypatch.setenv("TANGIBLE_SHARED_DIR", own)
        yield


@pytest.fixture
def cache_dir(own_dir: Path) -> Path:
    """The cache of this test, empty at first."""
    return _made(own_dir / "cache")


@pytest.fixture
def runtime_dir(own_dir: Path) -> Path:
    """Shared memory of this test: two at a time do not meet on one channel."""
    return _made(own_dir / "runtime")


@pytest.fixture
def config_dir(own_dir: Path) -> Path:
    """The configuration of this test: no calibration of a developer's own device is read or written."""
    return _made(own_dir / "config")


@pytest.fixture
def log_dir(own_dir: Path) -> Path:
    """The log of this test: tracebacks of failures on purpose are kept in no developer's log."""
    return _made(own_dir / "log")


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture
def unchecked_shapes(monkeypatch: pytest.MonkeyPatch) -> None:
    """As outside of tests: only the code's own checks are left."""
    monkeypatch.setattr(jaxtyping.config, "jaxtyping_disable", True)


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Install distributions that are made up, in a world that has no other ones: no test sees a developer's plugins.

    `install("acme", {"tangible.depth": {"mine": "acme:Mine"}}, acme="the source text of a module")`
    """
    site = tmp_path / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(site)
    for module in ("registry", "hooks", "naming"):
        monkeypatch.setattr(f"tangible_core.plugins.{module}.entry_points", lambda **of: _entry_points(site, **of))

    def install(name: str, points: Points, version: str = "1.0", **modules: str) -> Path:
        return distribution(site, name, points, version, **modules)

    yield install
    for name, module in list(sys.modules.items()):
        if str(getattr(module, "__file__", "")).startswith(str(site)):
            del sys.modules[name]


def _entry_points(site: Path, **of: str) -> metadata.EntryPoints:
    found = [point for dist in metadata.distributions(path=[str(site)]) for point in dist.entry_points]
    return metadata.EntryPoints(found).select(**of)


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A force loop that a busy machine does not let tick for a while is not ended for that."""
    from tangible_core.servo import limits

    monkeypatch.setattr(limits, "WATCHDOG_PERIODS", 1000 * STANDSTILL_S)


@pytest.fixture
def loop_in_thread(monkeypatch: pytest.MonkeyPatch, patient: None) -> None:
    """Force loops are threads of this process; see the helper of this name."""
    from loop_in_thread import loops_in_threads  # after `check`

    loops_in_threads(monkeypatch)


@pytest.fixture
def models(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of networks, empty."""
    monkeypatch.setenv("TANGIBLE_MODELS_DIR", str(tmp_path))
    return tmp_path
