"""Run every check of a kind one by one: by pytest, or by `tangible check`."""

import logging
import os
import traceback
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, cast

from ..errors import BrokenMethod, DeviceAbsent, ModelAbsent, TangibleError, UnknownName, did_you_mean
from ..plugins.interfaces import HapticDevice
from ..plugins.registry import Registry, default_registry
from .checks import Check, CheckFailure
from .every_method import LISTING_CHECKS, OPTION_CHECKS
from .kinds import depth, device, export, film, render, texture, touch

log: logging.Logger = logging.getLogger(__name__)

# The checks of each kind; those of `every_method` come before them.
FAMILIES: dict[str, tuple[Check, ...]] = {
    "depth": depth.CHECKS,
    "texture": texture.CHECKS,
    "render": (*render.CHECKS, *touch.CHECKS, *film.CHECKS),
    "device": device.CHECKS,
    "export": export.CHECKS,
}
PASSES = "it passes, though the method declares that it fails ({reason}): take {check} out of its expected_failures"
# Environment variable that lets a test suite push with real devices; `tangible check device NAME` needs none.
MOTORS = "TANGIBLE_MOTORS"


class CheckResult(NamedTuple):
    """The result of a check, its failure or the demand that is met; "not run" without the device or model."""

    name: str
    passed: bool
    message: str
    expected_failure: str = ""
    """The reason that the method declares for failing this check; empty if it declares none."""

    @property
    def as_declared(self) -> bool:
        """True if it passed, or failed as declared; a check that passes though declared to fail is not."""
        return self.passed != bool(self.expected_failure)


def checks(kind: str) -> tuple[Check, ...]:
    """Return every check of this kind, in the order in which they run. Raises: UnknownName."""
    if kind not in FAMILIES:
        raise UnknownName("kind of methods", kind, FAMILIES)
    return (*LISTING_CHECKS, *OPTION_CHECKS, *FAMILIES[kind])


def conforms(
    kind: str, name: str, expected_failures: Mapping[str, str] | None = None, **options: Any
) -> Callable[..., None]:
    """Return a pytest test with a case for every check; `test_mine = conforms("depth", "mine")` is a whole test module.

    Parameters: kind and name as for `load_method`; expected_failures maps the name of a check to the reason why the
    method fails it, in addition to those that its class declares (the test fails if such a check passes); options of
    the method.
    Raises: ValueError if expected_failures names a check that does not exist.
    """
    import pytest

    reasons = dict(expected_failures or {})
    if complaint := _unknown(kind, reasons):
        raise ValueError(complaint)

    @pytest.mark.parametrize("check", [pytest.param(check, id=check.__name__) for check in checks(kind)])
    def test_conforms(check: Check) -> None:
        declared = {**_declared_failures(default_registry(), kind, name), **reasons}.get(check.__name__, "")
        try:
            if check in device.WITH_MOTORS and _would_push(name, options):
                pytest.skip(f"a real device is there, and this pushes: let its grip hang free, and set {MOTORS}=1")
            _run(default_registry(), check, kind, name, options)
        except (DeviceAbsent, ModelAbsent) as absent:  # its message has a check of its own, which passes
            pytest.skip(f"not run: {absent}")
        except Exception:
            if declared:
                pytest.xfail(declared)
            raise
        if declared:
            pytest.fail(PASSES.format(check=check.__name__, reason=declared))

    return test_conforms


def _would_push(name: str, options: dict[str, Any]) -> bool:
    """Test whether a device is real and connected, and MOTORS does not let it push. Raises: DeviceAbsent."""
    device = cast(HapticDevice, default_registry().load("device", name)(**options))
    if os.environ.get(MOTORS) or device.spec().simulated:
        return False
    device.open().close()
    return True


def run_checks(kind: str, name: str, registry: Registry | None = None, **options: Any) -> Iterator[CheckResult]:
    """Run every check on an installed method, without pytest; yield results. Raises: UnknownMethod, BrokenMethod."""
    methods = registry or default_registry()
    reasons = _declared_failures(methods, kind, name)
    for check in checks(kind):
        reason = reasons.get(check.__name__, "")
        try:
            _run(methods, check, kind, name, options)
        except (DeviceAbsent, ModelAbsent) as absent:
            yield CheckResult(check.__name__, not reason, f"not run: {absent}", reason)
        except Exception as error:
            log.debug("%s %s fails in %s", kind, name, check.__name__, exc_info=True)
            yield CheckResult(check.__name__, False, _describe(error), reason)
        else:
            message = PASSES.format(check=check.__name__, reason=reason) if reason else demand(check)
            yield CheckResult(check.__name__, True, message, reason)


def _declared_failures(registry: Registry, kind: str, name: str) -> Mapping[str, str]:
    """Return the checks that the class declares to fail, with its reasons. Raises: UnknownMethod, BrokenMethod."""
    reasons = registry.load(kind, name).expected_failures
    if complaint := _unknown(kind, reasons):
        raise BrokenMethod(f"{kind} method {name}: {complaint}")
    return reasons


def _unknown(kind: str, reasons: Mapping[str, str]) -> str:
    """Return a complaint about the first name that is not a check of this kind; empty if all are."""
    names = [check.__name__ for check in checks(kind)]
    unknown = next((reason for reason in reasons if reason not in names), None)
    if unknown is None:
        return ""
    return f"expected_failures: no {kind} check is named {unknown!r}{did_you_mean(unknown, names)}"


def demand(check: Check) -> str:
    """Return the demand of a check: its docstring's first paragraph, without "Check that"."""
    sentence = " ".join((check.__doc__ or "").split("\n\n")[0].split()).removeprefix("Check that ")
    return sentence[:1].upper() + sentence[1:]


def _run(registry: Registry, check: Check, kind: str, name: str, options: dict[str, Any]) -> None:
    if check in LISTING_CHECKS:
        check(registry.find(kind, name))
    else:
        check(registry.load(kind, name)(**options))


def _describe(error: Exception) -> str:
    if isinstance(error, CheckFailure | TangibleError):
        return str(error)
    last = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {error} ({Path(last.filename).name}:{last.lineno}; --log-level debug shows all)"
