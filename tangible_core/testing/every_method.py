"""Checks that every method keeps, whatever its kind: of its listing, and of its options, a small frozen value."""

import json
import pickle
import re
import subprocess

from pydantic import ValidationError

from ..data.options import field_texts
from ..errors import OptionError
from ..plugins.interfaces import Method
from ..plugins.registry import Listing
from ..runtime.child_process import python
from .checks import Check, CheckFailure, checks_in, demand

# Packages that take longer to import than a listing of plugins may take.
HEAVY = ("torch", "kornia", "cv2", "skimage", "numba", "usb", "scipy", "matplotlib")


def name_is_plain(listing: Listing) -> None:
    """Check that the name is lower-case words joined by hyphens: it is typed in YAML and at the command line."""
    word = r"([a-z]|[1-9][a-z]{2})[a-z0-9]*"  # a file format may be called 3mf; 1e3 and 0xff are numbers in YAML
    demand(
        re.fullmatch(rf"{word}(-[a-z0-9]+)*", listing.name),
        f"the name is {listing.name!r}; write it as lower-case words joined by hyphens",
    )


def summary_is_there(listing: Listing) -> None:
    """Check that the class has a docstring, whose first line `tangible plugins` shows as the method's summary."""
    demand(
        listing.summary and not listing.summary.startswith("("),
        f"no summary can be read for {listing.target}: {listing.summary or 'the first line is empty'}",
    )
    demand(len(listing.summary) <= 120, f"the summary is {len(listing.summary)} characters long; 120 fit a line")


def import_is_light(listing: Listing) -> None:
    """Check that the class's module imports no heavy package: a plan imports the module, and must be quick."""
    module = listing.point.module
    code = f"import {module}; print(*(name for name in {HEAVY} if name in sys.modules))"
    ran = subprocess.run(python(code), capture_output=True, text=True, check=False)
    demand(ran.returncode == 0, f"{module} cannot be imported: {(ran.stderr.strip() or '?').splitlines()[-1]}")
    demand(
        not ran.stdout.split(),
        f"importing {module} imports {', '.join(ran.stdout.split())}; import these inside the function that needs them",
    )


LISTING_CHECKS: tuple[Check, ...] = checks_in(__name__)


def every_option_has_a_default(method: Method) -> None:
    """Check that the method can be created without options, so that its name is enough to try it."""
    missing = [name for name, field in type(method).model_fields.items() if field.is_required()]
    demand(not missing, f"{', '.join(missing)} must be given; give every option a default")
    type(method)()


def every_option_is_described(method: Method) -> None:
    """Check that each option has a docstring below it: the help that `tangible schema` and editors show."""
    fields, texts = type(method).model_fields, field_texts(type(method))
    bare = [name for name, field in fields.items() if not (field.description or texts.get(name))]
    demand(not bare, f"{', '.join(bare)} has no docstring; write one under the field")


def options_are_frozen(method: Method) -> None:
    """Check that a method cannot be changed: it is shared, hashed into cache keys and sent to other processes."""
    demand(type(method).model_config.get("frozen"), "model_config has lost frozen=True")
    for name in type(method).model_fields:
        try:
            setattr(method, name, getattr(method, name))
        except ValidationError:
            continue
        raise CheckFailure(f"{name} can be set after the method was created")


def unknown_options_are_refused(method: Method) -> None:
    """Check that a misspelt option is an error and not ignored."""
    try:
        type(method)(**{"no_such_option": 1})
    except OptionError:
        return
    raise CheckFailure("an option that does not exist is accepted; keep extra='forbid'")


def options_survive_json(method: Method) -> None:
    """Check that the method is equal after it was written as JSON and read: a run saves its configuration so."""
    back = type(method).model_validate_json(method.model_dump_json())
    demand(back == method, f"{method!r} comes back from JSON as {back!r}")


def schema_can_be_made(method: Method) -> None:
    """Check that the options have a JSON Schema: editors complete and check configurations with it."""
    json.dumps(type(method).model_json_schema())


def pickle_is_small(method: Method) -> None:
    """Check that the method is equal after a pickle of less than 4 kB: options only, no arrays, no models."""
    data = pickle.dumps(method)
    demand(len(data) < 4096, f"the pickle is {len(data)} bytes; keep what is large out of the fields")
    demand(pickle.loads(data) == method, "the method is not equal to itself after a pickle round trip")


OPTION_CHECKS: tuple[Check, ...] = checks_in(__name__)[len(LISTING_CHECKS) :]
