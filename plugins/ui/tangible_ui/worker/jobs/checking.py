"""Jobs that say what a text means, or change it, and make nothing."""

from dataclasses import asdict
from hashlib import sha256
from pathlib import Path
from typing import Any, cast

from ruamel.yaml.error import YAMLError

from tangible_core.errors import Complaint, ConfigError, quoted
from tangible_core.files.source import parse_value, plain
from tangible_core.materials.assignment import load_library
from tangible_core.pipeline.config.editing import REMOVE, edited, said, with_overrides
from tangible_core.pipeline.config.schema import json_schema

from ..state import Bench, Job


def check(bench: Bench, text: str, path: Path, sets: list[str]) -> dict[str, Any]:
    """What a pipeline file says, alone and with every default filled in, or what is wrong with it."""
    values, complaints = None, list[Complaint]()
    try:
        values = bench.config_of(text, path, sets).completed()
    except ConfigError as error:
        complaints = list(error.complaints)
    return {
        "text": text,
        "path": str(path),
        "digest": digest_of(text),
        "said": _said(text, path),
        "values": values,
        "complaints": [each._asdict() for each in complaints],
    }


def change(
    bench: Bench,
    text: str,
    path: Path,
    sets: list[str],
    changes: dict[str, Any],
    written: dict[str, str],
    removed: list[str],
) -> dict[str, Any]:
    """A text with some keys changed, and `check` of it.

    changes: values by key, as `render.stiffness_n_per_m`. written: the same, each value in YAML. removed: keys to go.
    Raises: ConfigError if the text is no YAML, or a key leads nowhere; nothing is checked but that it is YAML.
    """
    loaded = {key: _value(key, value) for key, value in written.items()}
    gone = dict.fromkeys(removed, REMOVE)
    return check(bench, edited(text, path, {**gone, **changes, **loaded}), path, sets)


def overridden(bench: Bench, text: str, path: Path, sets: list[str]) -> str:
    """The text with `key.key=value`, each as `--set` takes it. Raises: ConfigError."""
    return with_overrides(text, path, sets)


def schema(bench: Bench) -> dict[str, Any]:
    """The JSON Schema of all methods that are installed."""
    return json_schema(bench.registry, None)


def library(bench: Bench, text: str, path: Path, sets: list[str]) -> list[dict[str, Any]]:
    """The materials that a document can name: figures, and where they come from. Raises: ConfigError."""
    return [asdict(each) for each in load_library(bench.config_of(text, path, sets).materials.library).values()]


def digest_of(text: str) -> str:
    """What two events say that are of the same text."""
    return sha256(text.encode()).hexdigest()[:16]


def _said(text: str, path: Path) -> dict[str, Any] | None:
    try:
        return said(text, path)
    except ConfigError:
        return None


def _value(key: str, written: str) -> Any:
    """Raises: ConfigError for what is no YAML."""
    try:
        return plain(parse_value(written))
    except YAMLError as error:
        sentence = f"{quoted(written)} is not a YAML value: {getattr(error, 'problem', None) or error}"
        location = cast("tuple[str | int, ...]", tuple(key.split(".")))
        raise ConfigError(f"{key}: {sentence}", complaints=[Complaint(location, sentence)]) from error


JOBS = {
    "check": Job(check, quick=True),
    "change": Job(change, quick=True),
    "overridden": Job(overridden, quick=True),
    "schema": Job(schema, quick=True),
    "library": Job(library, quick=True),
}
