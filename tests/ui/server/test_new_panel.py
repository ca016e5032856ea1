"""A new panel of the page is five files: the example of CONTRIBUTING.md, added to a copy of the page and its server."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from page_files import ROOT, WEB, node
from sessions import small_scene

SERVER = Path("plugins/ui/tangible_ui")
PAGE = Path("plugins/ui/web")
FILES = {
    SERVER / "worker/jobs/statistics.py",
    SERVER / "requests/statistics.py",
    PAGE / "src/panels/statistics/words.ts",
    PAGE / "src/panels/statistics/panel.ts",
    PAGE / "src/panels/index.ts",
}
PROGRAM = """
import asyncio, json, sys
from pathlib import Path
import tangible_ui
from tangible_ui.requests import REQUESTS
from tangible_ui.serving.parsing import parse
from tangible_ui.worker.jobs import JOBS
from tangible_ui.worker.state import WorkerState

folder, path = Path(sys.argv[1]), Path(sys.argv[2])
document = {"text": path.read_text(), "path": path, "sets": ["device={use: mock}"]}
state = WorkerState(folder, lambda event, **told: None)
JOBS["make"].do(state, number=1, want="surface", **document)

class Worker:
    async def quick(self, job, **told):
        return JOBS[job].do(state, **told)

class Session:
    worker = Worker()

    def document(self):
        return document

request = parse('{"number": 1, "ask": "statistics"}')
print(json.dumps({"home": tangible_ui.__file__, "answer": asyncio.run(request.ask(Session(), None, **request.told))}))
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page and its server with the example."""
    copy = tmp_path_factory.mktemp("copy")
    ignored = shutil.ignore_patterns("node_modules", "__pycache__", "static")
    shutil.copytree(ROOT / "plugins/ui", copy / "plugins/ui", ignore=ignored)
    (copy / PAGE / "node_modules").symlink_to(WEB / "node_modules")
    for path, text in example().items():
        target = copy / path
        if target.is_file():
            imported, line = text.splitlines()
            (column,) = re.findall(r"const \w+", line)
            before = re.sub(rf"^{column}\b.*$", line, target.read_text("utf-8"), flags=re.M)
            text = before.replace("import { stages }", f"{imported}\nimport {{ stages }}", 1)
        target.parent.mkdir(exist_ok=True)
        target.write_text(text, "utf-8")
    return copy


def example() -> dict[Path, str]:
    """Return the files of the example: each code block, by the path that the text before it names last."""
    section = (ROOT / "CONTRIBUTING.md").read_text("utf-8").partition("## A new panel of the page")[2]
    parts = section.partition("\n## ")[0].split("   ```")
    texts = [re.sub(r"^   ", "", block.partition("\n")[2], flags=re.M) for block in parts[1::2]]
    paths = [re.findall(r"`(plugins/ui/[\w/.]+)`", before)[-1] for before in parts[:-1:2]]
    return dict(zip(map(Path, paths), texts, strict=True))


def test_panel_of_the_contributing_page_touches_five_files() -> None:
    assert example().keys() == FILES
    assert len(FILES) == 5


def test_panel_of_the_contributing_page_passes_the_checks_of_the_page_and_is_built(copy: Path) -> None:
    types, tests, build = "node_modules/typescript/bin/tsc", "test/run.mjs --test-name-pattern=text|circle", "build.mjs"
    for words in (types, tests, build):
        ran = node(*words.split(" "), cwd=copy / PAGE)
        assert ran.returncode == 0, ran.stdout + ran.stderr
    built = "".join(path.read_text("utf-8") for path in (copy / SERVER / "static").glob("*.js"))
    assert "From {low} to {high} mm." in built


def test_request_of_the_contributing_page_is_answered(copy: Path, tmp_path: Path) -> None:
    folder = tmp_path / "drawn"
    folder.mkdir()
    env = {"PYTHONPATH": f"{copy / 'plugins/ui'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"}
    ran = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(folder), str(small_scene(tmp_path))],
        cwd=tmp_path, env=os.environ | env, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr
    found = json.loads(ran.stdout.splitlines()[-1])
    assert Path(found["home"]).is_relative_to(copy)
    assert 0 <= found["answer"]["lowest_m"] < 0.001 < 0.003 < found["answer"]["highest_m"] <= 0.004
