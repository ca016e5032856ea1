"""A distribution of someone else's, built, installed into a fresh environment, and found there."""

import json
import os
import subprocess
import sys
import sysconfig
import venv
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from distributions import distribution

ROOT = Path(__file__).parents[1]
EXAMPLES = tuple(ROOT / "examples" / name for name in ("third_party", "force_law", "device", "exporter"))
EXAMPLE, LAW, DEVICE, EXPORTER = EXAMPLES
HERE = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
"""Where the environment that runs the tests keeps what is installed."""


class Environment:
    """A virtual environment: the examples' wheels are installed in it, the rest, ours and pip too, is borrowed."""

    def __init__(self, folder: Path) -> None:
        venv.create(folder, with_pip=find_spec("pip") is None, symlinks=os.name != "nt")
        scripts = "Scripts" if os.name == "nt" else "bin"
        self.python = folder / scripts / "python"
        paths = {"base": str(folder), "platbase": str(folder)}
        self.site = Path(sysconfig.get_path("purelib", vars=paths))
        borrowed = [f"import site; site.addsitedir({each!r})" for each in sorted(HERE)]
        self.site.joinpath("borrowed.pth").write_text("\n".join(borrowed))

    def install(self, *wheels: Path) -> None:
        """Install wheels, with nothing fetched from anywhere."""
        pip = [self.python, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
        subprocess.run([*pip, *wheels], check=True)

    def run(self, *words: str | Path, cwd: Path, **variables: str) -> subprocess.CompletedProcess[str]:
        """`tangible ...` as its user would call it."""
        command = [self.python, "-c", "from tangible_core.cli import main; main()", *words]
        env = {**os.environ, **variables}
        return subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, check=False)


def build(project: Path, out: Path) -> Path:
    """The wheel of a project, built with the hatchling that is here."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", out]
    subprocess.run(command, cwd=project, capture_output=True, check=True)
    [wheel] = out.iterdir()
    return wheel


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Environment:
    folder = tmp_path_factory.mktemp("fresh")
    environment = Environment(folder / "venv")
    environment.install(*(build(project, folder / project.name) for project in EXAMPLES))
    return environment


def test_third_party_plugin_is_listed(environment, tmp_path):
    ran = environment.run("plugins", "--json", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    rows = {(row["kind"], row["name"]): row for row in json.loads(ran.stdout)}
    assert rows["depth", "acme-blocks"]["origin"].startswith("acme-tangible 1.0.0")
    assert "the winner takes all" in rows["depth", "acme-blocks"]["summary"]
    assert rows["depth", "opencv-sgbm"]["origin"].startswith("tangible-images")
    assert "acme-blocks" in environment.run("plugins", cwd=tmp_path).stdout


@pytest.mark.whole
def test_third_party_plugin_and_its_tests_pass(environment, tmp_path):
    ran = environment.run("check", "depth", "acme-blocks", cwd=tmp_path)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "0 failed" in ran.stdout
    folders = [example / "tests" for example in EXAMPLES]
    command = [environment.python, "-m", "pytest", "-v", "-p", "no:cacheprovider", *folders]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    for file in (file for folder in folders for file in folder.glob("test_*.py")):
        assert f"{file.name}::" in ran.stdout


@pytest.mark.whole
def test_third_party_force_law_and_device_work_together(environment, tmp_path):
    law = ["--set", "render.use=acme-cushion-compiled"]
    ran = environment.run("feel", DEVICE / "handle.yaml", *law, "--seconds", "0.5", "--verbose", cwd=tmp_path)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "acme-cushion-compiled" in ran.stdout
    figures = dict(line.split() for line in ran.stdout.partition("figure ")[2].splitlines()[1:])
    assert float(figures["peak_force_n"]) > 0


@pytest.mark.whole
def test_third_party_exporter_method_and_observer_take_part(environment, tmp_path):
    tmp_path.joinpath("map.yaml").write_text("scene: {height: map.npy}\nexport: [acme-contours]\n")
    np.save(tmp_path / "map.npy", np.hypot(*np.indices((12, 20))))
    ran = environment.run("export", "map.yaml", "--out", "out", cwd=tmp_path)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert 'width="80.000mm" height="48.000mm"' in tmp_path.joinpath("out/map.svg").read_text()
    diary = tmp_path / "diary.txt"
    ran = environment.run("run", EXAMPLE / "blocks.yaml", "--out", "out", cwd=tmp_path, ACME_DIARY=str(diary))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    heard = dict(line.split(": ", 1) for line in diary.read_text().splitlines())
    assert heard["disparity"].startswith("ran")
    assert heard["surface"].startswith("ran")


@pytest.mark.whole
def test_third_party_option_misspelt_is_reported_with_place_and_hint(environment, tmp_path):
    tmp_path.joinpath("wrong.yaml").write_text(
        "scene: builtin/motorcycle\nwant: surface\ndepth: {use: acme-blocks, windw_px: 9}\n"
    )
    ran = environment.run("plan", "wrong.yaml", cwd=tmp_path)
    assert ran.returncode == 2
    assert "wrong.yaml:3:" in ran.stderr
    assert "did you mean 'window_px'?" in ran.stderr
    assert "Traceback" not in ran.stderr


def test_broken_plugin_leaves_the_others_working(environment, tmp_path):
    methods = {"broken": "broken:Method", "acme-blocks": "broken:Blocks"}
    points = {"tangible.depth": methods, "tangible.hooks": {"broken": "broken"}}
    distribution(tmp_path, "broken", points, broken="import a_module_that_is_not_there\n")
    there = {"PYTHONPATH": str(tmp_path)}
    listed = environment.run("plugins", "--json", cwd=tmp_path, **there)
    assert listed.returncode == 0, listed.stderr
    assert {"broken", "acme-blocks", "opencv-sgbm"} <= {row["name"] for row in json.loads(listed.stdout)}
    broken = environment.run("check", "depth", "broken", cwd=tmp_path, **there)
    assert broken.returncode == 2
    assert "cannot be loaded: ModuleNotFoundError: No module named 'a_module_that_is_not_there'" in broken.stderr
    assert "Traceback (most recent call last)" not in broken.stderr.split("depth method")[-1]
    two = environment.run("check", "depth", "acme-blocks", cwd=tmp_path, **there)
    assert two.returncode == 2
    assert "write acme-tangible/acme-blocks or broken/acme-blocks" in two.stderr
    assert environment.run("check", "depth", "acme-tangible/acme-blocks", cwd=tmp_path, **there).returncode == 0
