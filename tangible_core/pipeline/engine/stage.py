"""The base of all stages: each makes one product from a scene by a configuration."""

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from importlib import import_module
from typing import Any, ClassVar, NamedTuple, final
from uuid import uuid4

from ...data import Material, Outcome, Record, Views, digest_of
from ...errors import BrokenMethod, ConfigError, TangibleError
from ...files.reading import content_digest
from ...plugins.interfaces import Method, Skippable
from ...plugins.registry import Registry, default_registry
from ...provenance.closure import closure
from ...scene import scaling
from ...scene.scene import Scene
from ..config.methods import NamedMethod
from ..config.model import PipelineConfig
from . import working_grid
from .cache import Cache
from .working_grid import WorkingGrid

Inputs = Mapping[str, Any]  # products by name; None for a product that was skipped


class StageEvent(NamedTuple):
    """The start of a stage, or its outcome."""

    product: str
    method: str
    outcome: Outcome | None = None
    """None at the start."""


Progress = Callable[[StageEvent], None]
"""A listener, called at the start and the end of every stage in the thread that makes it."""


def ignore_event(event: StageEvent) -> None:
    """Do nothing: there is no listener."""


@final
@dataclass(frozen=True, eq=False)
class Context:
    """The configuration and the scene that the stages of one engine share."""

    config: PipelineConfig
    scene: Scene
    # Products that need no stage, as the scene provides them.
    scene_products: Mapping[str, Record] = field(default_factory=dict[str, Record])
    registry: Registry = field(default_factory=default_registry)  # the installed methods and hooks

    @cached_property
    def grid(self) -> WorkingGrid:
        """The grid on which products are made."""
        return WorkingGrid(self.scene, self.config.size)

    @cached_property
    def no_segments(self) -> str | None:
        """The reason why there are no segments; None if there are."""
        return None if "segments" in self.scene_products else stage_class("segments")(self).skip


class Stage(ABC):
    """The making of one product: its inputs, the reason to skip it, and the key of its cached result."""

    product: ClassVar[str]
    cached: ClassVar[bool] = True
    """False for a product that cannot be kept between runs."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.config: PipelineConfig = context.config
        self.grid: WorkingGrid = context.grid

    @property
    def method(self) -> str:
        """The method's name for people; "core" where the core makes the product."""
        return "core"

    @property
    @abstractmethod
    def needs(self) -> tuple[str, ...]:
        """The products that it is made from, in the order in which they are made."""

    @cached_property
    @abstractmethod
    def key(self) -> str:
        """A text that differs wherever results of equal inputs may differ: code, options, grid."""

    @abstractmethod
    def make(self, inputs: Inputs) -> Any:
        """Return the product on the working grid. Raises: TangibleError; whatever a plugin raises."""

    def full_size(self, value: Any) -> Any:
        """Return the product for every pixel of the pictures; as it is, if it has no pixels."""
        return value

    def finish(self, value: Any) -> Any:
        """Return the product checked, and with names; done at each request, as no cached result depends on it."""
        return value

    @cached_property
    def skip(self) -> str | None:
        """The reason why this scene does not need the product; None if it does."""
        return None

    @property
    def note(self) -> str:
        """The part of the work that this scene does not need; "" for none."""
        return ""

    @cached_property
    def refusal(self) -> TangibleError | None:
        """The error that making would end with, as far as it is known before anything runs."""
        return None

    @property
    def in_outcomes(self) -> bool:
        """False for a product that outcomes leave out unless it was made."""
        return True

    def code(self, *modules: str) -> str:
        """Return the digests of these modules, each with the text of the stage, this module, the grid and the cache."""
        own = (type(self).__module__, __name__, working_grid.__name__, Cache.__module__)
        return " ".join(closure(module, alone=own).digest for module in modules)

    @property
    def reduction(self) -> str:
        """The part of the key that inputs of the pictures' size add, as they are brought to the working grid."""
        plain = self.grid.factor == 1 and self.grid.scene.shown is None
        return "" if plain else f" {self.code(scaling.__name__)} {self.grid.key}"

    @property
    def views(self) -> Views:
        """The pictures on the working grid. Raises: ConfigError for a scene without."""
        if self.grid.views is None:
            raise no_picture(self.context.scene)
        return self.grid.views


class MethodStage(Stage):
    """A stage whose product a plugin's method makes."""

    kind: ClassVar[str]
    """The key of the configuration that names the method."""

    @property
    def choice(self) -> NamedMethod[Any] | None:
        """The configured method, if any."""
        return getattr(self.config, self.kind)

    @property
    def required_choice(self) -> NamedMethod[Any]:
        """The configured method. Raises: ConfigError without one."""
        if self.choice is None:
            raise self.config.missing(self.kind)
        return self.choice

    @property
    def method(self) -> str:
        """The method's name in the configuration."""
        return self.identity[0]

    @cached_property
    def identity(self) -> tuple[str, str]:
        """The method's name, and all that its results depend on."""
        return method_identity(self.choice)

    @cached_property
    def skip(self) -> str | None:
        """The method's own reason why this scene does not need it; None if it gives none."""
        method, views = self.choice and self.choice.method, self.context.scene.views
        return method.skip(views) if isinstance(method, Skippable) and views is not None else None

    def check_shape(self, what: str, shape: tuple[int, ...], picture_shape: tuple[int, ...]) -> None:
        """Raise BrokenMethod for a result of another size: enlarged to the pictures' size it would pass unseen."""
        if shape != picture_shape:
            choice = self.required_choice
            raise BrokenMethod(
                f"{self.kind} method {choice.name} ({choice.origin}) made {what} of {_size(shape)} for a picture of "
                f"{_size(picture_shape)}; `tangible check {self.kind} {choice.name}` shows the rules that it breaks"
            )


def stage_class(product: str) -> type[Stage]:
    """Return the class `ProductStage` of `stages/product.py`."""
    module = import_module(f"{__package__}.stages.{product}")
    return getattr(module, f"{product.capitalize()}Stage")


def no_picture(scene: Scene) -> ConfigError:
    """Return the error of a scene without a picture where one is needed."""
    return ConfigError(f"the scene {scene.name} has no picture; give one with `photo:` or `left:` and `right:`")


def _size(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, reversed(shape)))


def product_key(product: str, key: str, inputs: Mapping[str, str]) -> str:
    """Return the key of a product: its own key and those of its inputs, as SHA-256 in hexadecimal digits."""
    parts = (product, key, *(f"{name}={key_of_input}" for name, key_of_input in inputs.items()))
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def method_identities(config: PipelineConfig) -> str:
    """Return what results depend on of the code and the options of all methods, in one text."""
    return "\n".join(" ".join(method_identity(method)) for method in (config.depth, config.texture, config.render))


def method_identity(choice: NamedMethod[Any] | None) -> tuple[str, str]:
    """Return a method's name, and all its results depend on: its distribution, code, version, options and files."""
    if choice is None:
        return "", ""
    method: Method = choice.method
    cls = type(method)
    code = closure(cls.__module__)
    digest = code.digest if code.modules else uuid4().hex  # a class of a notebook may be another one by now
    options = method.model_dump()  # not as JSON, to which infinity and nothing are the same
    read = "".join(f" {content_digest(path)}" for path in method.reads())
    return choice.name, f"{choice.origin} {cls.__module__}:{cls.__qualname__} {digest} v{cls.version} {options}{read}"


@cache
def library_digest(materials: tuple[Material, ...]) -> str:
    """Return the digest of a library; cached, as it has hundreds of values and hardly ever changes in a process."""
    return digest_of(materials)
