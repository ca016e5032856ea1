"""Files for exhibitions, desktops and editors, which no other test reads."""

import json
import re
import shlex
import subprocess
import tomllib
from configparser import ConfigParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from tangible_core.runtime.child_process import python

ROOT = Path(__file__).parents[1]
DEPLOY = ROOT / "deploy"
SCRIPTS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["scripts"]
MIME = "{http://www.freedesktop.org/standards/shared-mime-info}"
KNOWN = {"COPY", "CMD", "ENTRYPOINT", "ENV", "FROM", "RUN", "USER", "VOLUME", "WORKDIR"}


def instructions() -> list[tuple[str, str]]:
    """Return the instructions of the container file, each with its words in one line."""
    text = re.sub(r"^#.*\n", "", (DEPLOY / "Containerfile").read_text("utf-8"), flags=re.MULTILINE)
    lines = re.sub(r"\\\n\s*", " ", text).splitlines()
    return [(name, words) for name, _, words in (line.partition(" ") for line in lines if line)]


def stages() -> dict[str, list[tuple[str, str]]]:
    """Return the instructions of each stage of the container file."""
    found: dict[str, list[tuple[str, str]]] = {}
    for name, words in instructions():
        if name == "FROM":
            found[words.rpartition(" AS ")[2]] = []
        list(found.values())[-1].append((name, words))
    return found


class TestContainer:
    def test_exhibition_runs_the_program_as_no_root_user(self):
        exhibition = stages()["exhibition"]
        assert list(stages())[-1] == "exhibition"
        assert {name for name, _ in instructions()} <= KNOWN
        assert [words for name, words in exhibition if name == "USER"] == ["10001"]
        assert any("useradd --uid 10001 " in words for name, words in stages()["base"] if name == "RUN")
        [entry] = [json.loads(words) for name, words in exhibition if name == "ENTRYPOINT"]
        [words] = [json.loads(words) for name, words in exhibition if name == "CMD"]
        assert entry[0] in SCRIPTS
        assert "--wait" in words

    def test_images_have_stages_and_write_to_the_volume_alone(self):
        settings = dict(stages()["exhibition"])
        folders = dict(word.split("=", 1) for word in shlex.split(settings["ENV"]) if word.startswith("XDG_"))
        assert folders == {f"XDG_{each}_HOME": settings["VOLUME"] for each in ("CACHE", "CONFIG", "DATA", "STATE")}
        bases = [words.split()[0] for name, words in instructions() if name == "FROM"]
        assert all(base in stages() or re.search(r":\d", base) for base in bases)


def test_development_container_and_desktop_entry_are_declared():
    container = json.loads((ROOT / ".devcontainer/devcontainer.json").read_text("utf-8"))
    folder = ROOT / ".devcontainer"
    assert (folder / container["build"]["dockerfile"]).resolve() == DEPLOY / "Containerfile"
    assert (folder / container["build"]["context"]).resolve() == ROOT
    assert container["build"]["target"] in stages()
    desktop = ConfigParser(interpolation=None, delimiters="=")
    desktop.optionxform = str  # pyright: ignore[reportAttributeAccessIssue]
    desktop.read(DEPLOY / "tangible-images.desktop", "utf-8")
    entry = desktop["Desktop Entry"]
    declared = {each.get("type") for each in ElementTree.parse(DEPLOY / "tangible-images.xml").iter(f"{MIME}mime-type")}
    assert entry["Exec"].split()[0] in SCRIPTS
    assert {word for word in entry["MimeType"].split(";") if "x-tangible" in word} == declared


class TestSlim:
    ENTRY = re.compile(r"^([\w.-]+)==[^\n]+\\\n(?: +--hash=\S+(?: \\)?\n?)+", re.MULTILINE)
    WITHOUT = "cv2", "scipy", "skimage", "matplotlib", "PIL", "starlette", "uvicorn", "websockets"
    """The packages that are not in the list, by the names of their modules."""
    HIDE = "import sys; sys.modules.update(dict.fromkeys({names!r})); "

    def test_packages_have_the_digests_of_the_lock(self):
        locked, slim = ((ROOT / name).read_text("utf-8") for name in ("requirements-dev.txt", "deploy/slim.txt"))
        entries = [match[0].strip() for match in self.ENTRY.finditer(slim)]
        assert len(entries) == slim.count("==")
        assert set(entries) <= {match[0].strip() for match in self.ENTRY.finditer(locked)}

    @pytest.mark.whole
    def test_surface_of_heights_is_felt_with_the_listed_packages_alone(self, tmp_path: Path):
        y, x = np.mgrid[:48, :64]
        heights_m = np.float32(1e-3 * np.sin(x / 7) * np.cos(y / 9)) + np.float32(1e-3) * (x > 40)
        np.save(tmp_path / "heights.npy", heights_m)
        words = "scene: {height: heights.npy}\nwant: touch\nrender: {use: proxy}\ndevice: {use: mock}\n"
        (tmp_path / "board.yaml").write_text(words, "utf-8")
        code = self.HIDE.format(names=self.WITHOUT) + "from tangible_core.cli import main; main()"
        command = [*python(code), "feel", "board.yaml", "--seconds", "1", "--record", "hand.nc", "--json"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "hand.nc").stat().st_size > 10_000
        assert json.loads(done.stdout)["figures"]["contact_share"] > 0.5
