"""The output of `--help`. Otherwise it would take a second to appear."""

import subprocess
import sys


def test_help_imports_neither_numpy_nor_the_pipeline():
    code = (
        "import sys; sys.argv[1:] = ['--help']\nfrom tangible_core.cli import main\ntry: main()\nfinally: "
        "print([name for name in sys.modules if name in ('numpy', 'tangible_core.pipeline')], file=sys.stderr)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stderr.strip() == "[]"
