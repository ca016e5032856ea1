"""What a test needs beyond Python's packages: a browser, npm's packages, the page itself, programs that read files."""

import os
from typing import NoReturn

import pytest


def lacking(what: str) -> NoReturn:
    """Skip with the reason on a person's machine; where everything must be there, as in CI, fail."""
    required = any(
        os.environ.get(name, "").lower() not in ("", "0", "false") for name in ("CI", "TANGIBLE_UI_REQUIRED")
    )
    if required:
        pytest.fail(what, pytrace=False)
    pytest.skip(what)
