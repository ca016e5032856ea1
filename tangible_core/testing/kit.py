"""Every check of a kind, run one by one: by pytest, or by `tangible check`."""

import logging
import os
import traceback
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, cast

from ..errors import DeviceAbsent, TangibleError, UnknownMethod, did_you_mean
from ..plugins.interfaces import HapticDevice
from ..plugins.registry import Registry, default_registry
from . import checks_depth, checks_device, checks_listing, checks_options, checks_render, checks_texture, checks_touch
from .checks import Check, CheckFailure

log = logging.getLogger(__name__)

FAMILIES: dict[str, tuple[Check, ...]] = {
    "depth": checks_depth.CHECKS,
    "texture": checks_texture.CHECKS,
    "render": (*checks_render.CHECKS, *checks_touch.CHECKS),
    "device": checks_device.CHECKS,
}
"""What each kind is asked on top of what every method is asked."""


MOTORS = "TANGIBLE_MOTORS"
"""Environment variable that lets a test suite push with real devices; `tangible check device NAME` does so as asked."""


class CheckResult(NamedTuple):
    """What became of one check; a failed one's message says why, a passed one's what was demanded.

    Where a device is not there, what could be asked is passed and what could not be says so.
    """

    name: str
    passed: bool
    message: str


def checks(kind: str) -> tuple[Check, ...]:
    """Every check of this kind, in the order in which they run.

    Raises: UnknownMethod if there is no such kind.
    """
    if kind not in FAMILIES:
        raise UnknownMethod("plugin", kind, FAMILIES)
    return (*checks_listing.CHECKS, *checks_options.CHECKS, *FAMILIES[kind])


def conforms(
    kind: str, name: str, expected_failures: Mapping[str, str] | None = None, **options: Any
) -> Callable[..., None]:
    """A pytest test of every check; `test_mine = conforms("depth", "mine")` is a whole test module.

    Parameters: kind and name as in `load_method`; expected_failures maps the name of a check to the reason why the
    method does not keep it (it must then fail, or the test does); options as the method's own.
    Raises: ValueError if expected_failures names a check that does not exist.
    """
    import pytest

    known = {check.__name__: check for check in checks(kind)}
    reasons = dict(expected_failures or {})
    for unknown in reasons.keys() - known.keys():
        raise ValueError(f"expected_failures: no {kind} check is named {unknown!r}{did_you_mean(unknown, known)}")

    marks = {name: pytest.mark.xfail(reason=reason, strict=True) for name, reason in reasons.items()}
    cases = [
        pytest.param(check, id=name, marks=[marks[name]] if name in marks else []) for name, check in known.items()
    ]

    @pytest.mark.parametrize("check", cases)
    def test_conforms(check: Check) -> None:
        try:
            if check in checks_device.WITH_MOTORS and _would_push(name, options):
                pytest.skip(f"a real device is there, and this pushes: let its grip hang free, and set {MOTORS}=1")
            _run(default_registry(), check, kind, name, options)
        except DeviceAbsent as absent:  # that it is said is a check of its own, and passes
            pytest.skip(f"nothing to ask: {absent}")

    return test_conforms


def _would_push(name: str, options: dict[str, Any]) -> bool:
    """Whether a device is real and there, and nobody allowed it to push. Raises: DeviceAbsent if it is not there."""
    device = cast(HapticDevice, default_registry().load("device", name)(**options))
    if MOTORS in os.environ or device.spec().simulated:
        return False
    device.open().close()
    return True


def run_checks(kind: str, name: str, registry: Registry | None = None, **options: Any) -> Iterator[CheckResult]:
    """Run every check against an installed method, without pytest; each result comes as soon as it is known.

    Raises: UnknownMethod, BrokenMethod.
    """
    installed = registry or default_registry()
    installed.load(kind, name)
    for check in checks(kind):
        try:
            _run(installed, check, kind, name, options)
        except DeviceAbsent as absent:
            yield CheckResult(check.__name__, True, f"not asked: {absent}")
        except Exception as error:
            log.debug("%s %s fails in %s", kind, name, check.__name__, exc_info=True)
            yield CheckResult(check.__name__, False, _in_words(error))
        else:
            yield CheckResult(check.__name__, True, " ".join((check.__doc__ or "").split("\n\n")[0].split()))


def _run(registry: Registry, check: Check, kind: str, name: str, options: dict[str, Any]) -> None:
    """What is seen before use is checked of the listing, the rest of the method, made anew for each check."""
    if check in checks_listing.CHECKS:
        check(registry.find(kind, name))
    else:
        check(registry.load(kind, name)(**options))


def _in_words(error: Exception) -> str:
    if isinstance(error, CheckFailure | TangibleError):
        return str(error)
    last = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {error} ({Path(last.filename).name}:{last.lineno}; --log-level debug shows all)"
