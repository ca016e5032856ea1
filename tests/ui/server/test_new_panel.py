"""A new panel of the page, as CONTRIBUTING.md adds it: otherwise a contributor is led astray."""

import re
import shutil
from pathlib import Path

import pytest

from page_files import ROOT, STATIC, WEB, node

SERVER = Path("plugins/ui/tangible_ui")
PAGE = Path("plugins/ui/web")
FILES = {
    SERVER / "worker/jobs/statistics.py",
    PAGE / "src/panels/statistics/words.ts",
    PAGE / "src/panels/statistics/panel.ts",
    PAGE / "src/panels/index.ts",
}
pytestmark = pytest.mark.whole


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page and its server with the example."""
    copy = tmp_path_factory.mktemp("copy")
    ignored = shutil.ignore_patterns("node_modules", "__pycache__", "static")
    for each in ("ui", "web", "send", "study"):
        shutil.copytree(ROOT / "plugins" / each, copy / "plugins" / each, ignore=ignored)
    (copy / WEB.relative_to(ROOT) / "node_modules").symlink_to(WEB / "node_modules")
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


def test_panel_touches_four_files() -> None:
    assert example().keys() == FILES


def test_panel_of_the_contributing_page_passes_the_checks_of_the_page_and_is_built(copy: Path) -> None:
    types, tests, build = "node_modules/typescript/bin/tsc", "test/run.mjs --test-name-pattern=text|circle", "build.mjs"
    for words in (types, tests, build):
        ran = node(*words.split(" "), cwd=copy / WEB.relative_to(ROOT))
        assert ran.returncode == 0, ran.stdout + ran.stderr
    built = "".join(path.read_text("utf-8") for path in (copy / STATIC.relative_to(ROOT)).glob("*.js"))
    assert "From {low} to {high} mm." in built
