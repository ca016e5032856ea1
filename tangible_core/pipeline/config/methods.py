"""A method as a configuration names it: by the name of an installed plugin, or as an object made in Python."""

from dataclasses import dataclass
from typing import Any, Generic, TypeVar, cast

from ...errors import ConfigError, TangibleError, UnknownMethod, quoted
from ...files.yaml.source import Location, Source
from ...plugins.interfaces import KINDS, Method
from ...plugins.registry import Registry

M = TypeVar("M", bound=Method, covariant=True)


@dataclass(frozen=True)
class NamedMethod(Generic[M]):
    """A method with the name that a file gives it."""

    name: str
    origin: str
    """The package and version that the method comes from; empty for a class that no installed plugin names."""
    method: M

    def as_written(self, kind: str) -> dict[str, Any]:
        """Return the block of a file for this method. Raises: ConfigError for a method that no file can name."""
        if not self.origin:
            raise ConfigError(
                f"{kind}: {self.name} is not an installed plugin, and a file names its methods; install it with an "
                f"entry point tangible.{kind} (docs/how-to/write-a-plugin.md)"
            )
        return {"use": self.name, **self.method.model_dump(mode="json")}


def choose(source: Source, location: Location, kind: str, block: Any, registry: Registry) -> NamedMethod[Any] | None:
    """Make the method that a block of a file names, with its options; None after a complaint."""
    if isinstance(block, str):
        block = {"use": block}
    if not isinstance(block, dict) or not isinstance(cast(Any, block).get("use"), str):
        names = ", ".join(registry.names(kind))
        return source.complain(location, f"{kind} needs the name of a method, {{use: ...}}; installed: {names}")
    options = dict(cast("dict[str, Any]", block))
    name = options.pop("use")
    try:
        listing, cls = registry.find(kind, name), registry.load(kind, name)
    except TangibleError as error:
        source.complain((*location, "use"), str(error))
        if isinstance(error, UnknownMethod) and error.meant:  # its options are checked in the same run
            choose(source, location, kind, {**options, "use": error.meant}, registry)
        return None
    method = source.model(location, cls, options)
    return None if method is None else NamedMethod(name, listing.origin, method)


def named_method(kind: str, method: M, registry: Registry) -> NamedMethod[M]:
    """Find the name by which a file would name this method; without a plugin, that of its class, and no origin."""
    check_kind(kind, method)
    cls = type(method)
    target = f"{cls.__module__}:{cls.__qualname__}"
    for listing in registry.listings:
        if (listing.kind, listing.target) == (kind, target):
            alone = listing.name in registry.names(kind)
            return NamedMethod(
                listing.name if alone else f"{listing.distribution}/{listing.name}", listing.origin, method
            )
    return NamedMethod(cls.__qualname__, "", method)


def check_kind(kind: str, method: object) -> None:
    """Refuse a method of another kind. Raises: ConfigError."""
    interface = KINDS[cast(Any, kind)]
    if not isinstance(method, interface):
        raise ConfigError(
            f"{kind}: takes a name, or an object of a class of {interface.__name__}, not {quoted(method)}"
        )
