"""Keys of results: what a result depends on, in one text or digest."""

import hashlib
from collections.abc import Mapping
from functools import cache
from typing import Any
from uuid import uuid4

from ...data import Material, digest_of
from ...files.reading import content_digest
from ...plugins.interfaces import Method
from ...provenance.closure import closure
from ...provenance.source import source_digest
from ..config.methods import NamedMethod
from ..config.model import PipelineConfig


def product_key(product: str, key: str, inputs: Mapping[str, str]) -> str:
    """Return the key of a product: its own key and those of its inputs, as SHA-256 in hexadecimal digits."""
    parts = (product, key, *(f"{name}={each}" for name, each in inputs.items()))
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def method_identities(config: PipelineConfig) -> str:
    """Return what results depend on of the code and the options of all methods, in one text."""
    return "\n".join(" ".join(method_identity(each)) for each in (config.depth, config.texture, config.render))


def method_identity(chosen: NamedMethod[Any] | None) -> tuple[str, str]:
    """Return a method's name, and all its results depend on: its distribution, code, version, options and files."""
    if chosen is None:
        return "", ""
    method: Method = chosen.method
    cls = type(method)
    code = closure(cls.__module__)
    digest = code.digest if code.modules else source_digest(cls) or uuid4().hex
    options = method.model_dump()  # not as JSON, to which infinity and nothing are the same
    read = "".join(f" {content_digest(path)}" for path in method.reads())
    return chosen.name, f"{chosen.origin} {cls.__module__}:{cls.__qualname__} {digest} v{cls.version} {options}{read}"


@cache
def library_digest(materials: tuple[Material, ...]) -> str:
    """Return the digest of a library; cached, as it has hundreds of values and hardly ever changes in a process."""
    return digest_of(materials)
