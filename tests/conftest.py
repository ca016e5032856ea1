"""What every test stands on: checked shapes, repeatable hypothesis, a cache and plugins of its own."""

import os
import sys
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path

import jaxtyping
import pytest
from hypothesis import settings

from checked_calls import check
from distributions import Points, distribution

os.environ["MPLBACKEND"] = "Agg"

check()

settings.register_profile("default", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("ci" if os.environ.get("CI") else "default")

Install = Callable[..., Path]


@pytest.fixture(autouse=True)
def cache_dir(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache for each test: nothing is read from, or left in, the developer's own."""
    folder = tmp_path_factory.mktemp("cache")
    monkeypatch.setenv("TANGIBLE_CACHE_DIR", str(folder))
    return folder


@pytest.fixture(autouse=True)
def runtime_dir(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Shared memory of its own for each test: two at a time do not meet on one channel."""
    folder = tmp_path_factory.mktemp("runtime")
    monkeypatch.setenv("TANGIBLE_RUNTIME_DIR", str(folder))
    return folder


@pytest.fixture(autouse=True)
def config_dir(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """No calibration of a developer's own device is read or written."""
    folder = tmp_path_factory.mktemp("config")
    monkeypatch.setenv("TANGIBLE_CONFIG_DIR", str(folder))
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
    for module in ("registry", "hooks"):
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
