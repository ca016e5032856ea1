"""The dependencies of code. Otherwise an edit would be answered by an old result, or nothing ever by the cache."""

import os
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

from tangible_core.provenance import closure as closures
from tangible_core.provenance import versions
from tangible_core.provenance.closure import closure, closure_of_function

from .conftest import Write, forget

INSTALLED = "lib/site-packages"
DIST = "{0}-1.0.dist-info/METADATA"


def metadata(name: str, version: str = "1.0") -> str:
    return f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n"


def digest(module: str) -> str:
    forget()
    return closure(module).digest


METHOD = {
    "acme/__init__.py": "",
    "acme/method.py": "def verb():\n    from .kernel import fast\n    import numpy\n",
    "acme/kernel.py": "from acme import deep\nfrom tangible_core import Force\nfast = 1\n",
    "acme/deep.py": "from . import method\nimport lent.all as lent\n",
    "acme/neighbour.py": "",
    "lent/all.py": "from tool import VALUE",
    "tool.py": "VALUE = 1",
}


@pytest.mark.parametrize(
    ("changed", "same"),
    [
        ("acme/neighbour.py", True),
        ("acme/method.py", False),
        ("acme/kernel.py", False),
        ("acme/deep.py", False),
        ("acme/__init__.py", False),
        ("lent/all.py", False),
        ("tool.py", False),
    ],
)
@pytest.mark.parametrize("folder", ["work", INSTALLED])
def test_digest_changes_with_imported_modules_only(write: Write, folder: str, changed: str, same: bool):
    site = write(folder, **METHOD)
    before = digest("acme.method")
    (site / changed).write_text((site / changed).read_text() + "\n")
    of_others_and_installed = folder == INSTALLED and not changed.startswith("acme")
    assert (digest("acme.method") == before) is (same or of_others_and_installed)


def test_digest_changes_with_versions_and_sources_of_installed_packages(write: Write):
    site = write(
        INSTALLED,
        **METHOD,
        **{DIST.format("other"): metadata("other"), "other-1.0.dist-info/RECORD": "lent/all.py,,\n"},
    )
    assert closure("acme.method").versions["other"] == "1.0"
    before = digest("acme.method")
    (site / DIST.format("other")).write_text(metadata("other", "1.1"))
    assert digest("acme.method") != before
    site = write(
        INSTALLED,
        **METHOD,
        **{
            DIST.format("lent"): metadata("lent"),
            "lent-1.0.dist-info/entry_points.txt": "[tangible.render]\na = lent.all:A",
        },
    )
    before = digest("acme.method")
    (site / "lent/all.py").write_text("")
    assert digest("acme.method") != before


def test_closure_reads_the_used_modules_where_they_are_installed(write: Write, monkeypatch: pytest.MonkeyPatch):
    write(INSTALLED, **METHOD)
    modules = closure("acme.method").modules
    assert {"acme.kernel", "tangible_core", "tangible_core.data"} <= set(modules)
    assert "tangible_core.pipeline.engine.engine" not in modules
    write(INSTALLED, **{"acme/fast.py": "from tangible_core.compiled import njit"})
    modules = closure("acme.fast").modules
    assert {"tangible_core.compiled", "tangible_core.compiled.compiling"} <= set(modules)
    assert "tangible_core.compiled.threads" not in modules
    write(INSTALLED, **METHOD)
    monkeypatch.setattr(versions, "INSTALLED", {*versions.INSTALLED, Path(versions.__file__).parts[-4]})
    assert "tangible_core.data" in closure("acme.method").modules


@pytest.mark.parametrize("package", ["", "def __getattr__(name): ...\n"])
def test_closure_of_a_name_of_a_lazy_package_leaves_out_its_other_names(write: Write, package: str):
    write(
        "work",
        **{
            "acme/__init__.py": "from .one import One\nfrom .two import Two as Both\nfrom .three import made\n"
            f"{package}made = made()\ndef own(): pass\n",
            "acme/one.py": "",
            "acme/two.py": "",
            "acme/three.py": "",
            "first.py": "from acme import One",
            "second.py": "from acme import Both",
            "third.py": "from acme import made",
            "fourth.py": "from acme import *",
            "fifth.py": "import acme",
            "sixth.py": "import acme.one",
        },
    )
    of_all = ("acme", "acme.one", "acme.three", "acme.two")
    for name, handed_on in {
        "first": ("acme", "acme.one"),
        "second": ("acme", "acme.two"),
        "third": of_all,
        "fourth": of_all,
        "fifth": of_all,
        "sixth": ("acme", "acme.one"),
    }.items():
        assert closure(name).modules == tuple(sorted((*(handed_on if package else of_all), name)))


def test_closure_has_only_used_modules_and_libraries(write: Write):
    write("work", **{"none.py": "", "plain.py": "import json, numpy", "deep.py": "import plain, kornia"})
    assert set(closure("none").versions) == {"python"}
    assert set(closure("plain").versions) == {"python", "numpy"}
    assert set(closure("deep").versions) == {"python", "numpy", "kornia", "torch"}
    site = write("work", **{"a.py": "", "b.py": "import c", "c.py": ""})
    before = closure("a", alone=("b",)).digest
    assert closure("a", alone=("b",)).modules == ("a", "b")
    for name, same in {"c.py": True, "b.py": False}.items():
        (site / name).write_text("import c\n")
        forget()
        assert (closure("a", alone=("b",)).digest == before) is same
    assert closure("sys").modules == closure("nowhere.at.all").modules == ()


def test_digest_changes_with_a_version(write: Write, monkeypatch: pytest.MonkeyPatch):
    write("work", **{"plain.py": "import cv2"})
    before = digest("plain")
    forget()
    monkeypatch.setattr(closures.versions, "_version", lambda name: "0.1")
    assert closure("plain").digest != before


def test_closure_includes_compiled_modules_and_invalid_sources(write: Write):
    site = write("work", **{"a.py": "import fast, torn", "fast.abi3.so": "1", "torn.py": "import ("})
    (site / "old").mkdir()
    (site / "old" / "__init__.py").write_text("import fast\nprint 'as it was'")
    (site / "a.py").write_text("import fast, torn\ntry:\n    from old import fast\nexcept SyntaxError: pass\n")
    assert closure("a").modules == ("a", "fast", "old", "torn")
    before = digest("a")
    (site / "fast.abi3.so").write_text("2")
    assert digest("a") != before


def test_closure_reads_a_loaded_module_from_its_own_file_found_or_not(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    write("first", **{"twice.py": "A = 1"})
    import_module("twice")
    before = digest("twice")
    write("second", **{"twice.py": "A = 2"})
    assert digest("twice") == before
    del sys.modules["twice"]
    assert digest("twice") != before
    site = write("work", **{"helper.py": ""})
    loaded = ModuleType("loaded_by_hand")
    loaded.__file__ = str(site / "by_hand.py")
    (site / "by_hand.py").write_text("import helper")
    monkeypatch.setitem(sys.modules, "loaded_by_hand", loaded)
    assert closure("loaded_by_hand").modules == ("helper", "loaded_by_hand")


def test_digest_with_a_file_changed_since_the_start_is_unique_to_the_process(
    write: Write, monkeypatch: pytest.MonkeyPatch
):
    site = write("work", **{"a.py": "import b", "b.py": ""})
    assert not closure("a").settled
    forget()
    monkeypatch.setattr(closures, "STARTED_NS", (site / "b.py").stat().st_ctime_ns + 1)
    settled = closure("a")
    assert settled.settled
    os.utime(site / "b.py", (0, 0))  # as an installer does with files of old
    forget()
    assert not closure("a").settled
    before = closure("a").digest
    forget()
    monkeypatch.setattr(closures, "_OF_THIS_PROCESS", "another")
    assert len({before, closure("a").digest, settled.digest}) == 3


def test_closure_of_a_function_is_that_of_its_file(write: Write):
    exec("def f(): pass", namespace := {"__name__": "made"})
    assert closure_of_function(namespace["f"]) is None
    found = closure_of_function(test_closure_has_only_used_modules_and_libraries)
    assert found is not None
    assert {"tangible_core.provenance.closure"} <= set(found.modules)
    own = '"""Use:\n\n    from own import thing\n"""\n\nfrom .part import thing as thing\n\n__getattr__ = None\n'
    write("src", **{"own/__init__.py": own, "own/part.py": "thing = 1\n", "asks.py": "from own import thing\n"})
    assert "own.part" in closure("asks").modules
