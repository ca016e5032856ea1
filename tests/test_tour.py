"""The notebook in examples runs from top to bottom, and is that of its script."""

import ast
import importlib.util
import linecache
import sys
from pathlib import Path
from types import ModuleType

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.fixture(scope="module")
def maker() -> ModuleType:
    spec = importlib.util.spec_from_file_location("notebook", EXAMPLES / "notebook.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_notebook_is_that_of_the_script(maker: ModuleType):
    script = (EXAMPLES / "tour.py").read_text(encoding="utf-8")
    assert (EXAMPLES / "tour.ipynb").read_text(encoding="utf-8") == maker.notebook(script), (
        "run: python examples/notebook.py"
    )


def run_cell(module: ModuleType, number: int, text: str) -> object:
    """The value of a cell's last line, as a notebook shows it; None where that is a statement."""
    name = f"<cell {number} of the tour>"
    linecache.cache[name] = len(text), None, text.splitlines(keepends=True), name
    tree = ast.parse(text, name)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, name, "exec"), vars(module))
    if last is None:
        return None
    return eval(compile(ast.Expression(last.value), name, "eval"), vars(module))


@pytest.mark.whole
def test_notebook_runs_and_shows_its_products(maker: ModuleType, monkeypatch: pytest.MonkeyPatch):
    from matplotlib import pyplot

    module = ModuleType("tour")
    monkeypatch.setitem(sys.modules, "tour", module)
    shown: dict[str, str] = {}
    found = maker.cells((EXAMPLES / "tour.py").read_text(encoding="utf-8"))
    for number, text in enumerate(text for kind, text in found if kind == "code"):
        value = run_cell(module, number, text)
        if hasattr(value, "_repr_html_"):
            shown[type(value).__name__] = value._repr_html_()
    pyplot.close("all")
    assert {"Plan", "DisparityMap", "HapticSurface", "Outcomes", "Recording", "Run"} <= set(shown)
    assert all(html.startswith(("<img ", "<table>")) for html in shown.values())
    assert module.recording.peak_force_n > 0
