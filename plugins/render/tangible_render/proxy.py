"""The proxy, or god-object: a point on the surface, joined to the hand by a spring."""

from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
from jaxtyping import Float64
from pydantic import Field, model_validator

from tangible_core.compiled import CompiledTouch, Tick
from tangible_core.data import HapticSurface
from tangible_core.errors import ConfigError, check_positive
from tangible_core.plugins import Film, Filming, ForceRenderer, Touch
from tangible_render.haptic_textures.table import bristle_stiffness

from .effects.effects_table import material_table, split_textures
from .surface.coefficients import spline_surface, tile_bounds
from .surface.dequantise import Filter

# The largest ball, m: nothing narrower than twice this, a fingertip's width, would be left in a groove.
MAX_RADIUS_M = 0.002


class _Law(NamedTuple):
    """A kernel's kind and its arguments after the surface: the simplest kernel with the effects that occur."""

    kind: Literal["spring", "materials", "textures"]
    arguments: tuple[Any, ...]
    memory: Float64[np.ndarray, "n"]
    stiffness_n_per_m: float


class Proxy(ForceRenderer, Filming):
    """A spring to a proxy (god-object), which stays on the surface: F = k (p - q).

    The default for a surface that you stroke: walls hold the hand, materials have friction, damping and fine textures.
    `penalty` is simpler and shows a slope by its height alone; `grey-level` and `tangible-mask` act sideways only.

    >>> import numpy as np
    >>> from tangible import HapticState, HapticSurface, Proxy, Relief
    >>> touch = Proxy(stiffness_n_per_m=500).touch(HapticSurface(Relief(np.zeros((8, 8), np.float32), (0.08, 0.08))))
    >>> touch.force(HapticState(position_m=(0, 0, 0.001)))  # the hand is above the surface
    Force(x=0.0, y=0.0, z=0.0)
    >>> touch.force(HapticState(position_m=(0, 0, -0.001)))  # a millimetre below: 500 N/m x 0.001 m
    Force(x=0.0, y=0.0, z=0.5)

    The proxy p starts where the hand q passes through the surface, a C2 spline, and then minimises |p - q| downhill
    from its last place, so that a wall holds it back: unlike a penalty force it does not push the hand out at the far
    side. With friction the proxy rests while the force is within the static cone, and slides on the dynamic one: stick
    and slip. Damping acts along the normal and never pulls. The fine textures of materials are added to the surface as
    heights; other effects of a texture, such as drag, are added to the force. Where the stiffness is uniform, no closed
    path gains energy except by sampling: for a hand at rest the proxy only ever comes nearer.

    The surface is the top of a block with vertical sides: a hand that enters from the side, below the rim, is pushed
    back along x or y. The proxy of a hand that appears in the block, or jumps by more than 5 mm in a tick, starts
    straight above the hand; so does a proxy more than 20 mm behind its hand, if the surface above is nearer.

    Surfaces that move are supported as well, see `film`.
    Source: Zilles & Salisbury, A constraint-based god-object method, IROS 1995; Harwin & Melder, Improved haptic
    rendering for multi-finger manipulation using friction cone based god-objects, Eurohaptics 2002.
    """

    renders_materials: ClassVar[bool] = True

    stiffness_n_per_m: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 800.0
    """Stiffness between proxy and hand, where the surface has no materials."""
    damping_n_s_per_m: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    """Damping along the normal, where the surface has no materials."""
    static_friction: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    """Coefficient of static friction, where the surface has no materials."""
    dynamic_friction: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    """Coefficient of dynamic friction, where the surface has no materials."""
    friction: bool = True
    """Render friction; if false, there is none at all, that of materials included."""
    texture: bool = True
    """Render the fine textures of materials; if false, their drag and their own friction are left out too."""
    radius_m: Annotated[float, Field(ge=0, le=MAX_RADIUS_M)] = 0.0
    """Radius of a ball in place of a point at the hand's tip, which rounds edges and bridges grooves narrower than
    itself, as a fingertip does; a tick takes no longer. Not for films."""
    dequantise: Filter = "auto"
    """Smoothing of heights with 17 to 256 distinct values, such as 8-bit pictures have, by at most half a step: auto,
    never, or a standard deviation in cells."""

    @model_validator(mode="after")
    def _dynamic_friction_within_static(self) -> Self:
        if self.dynamic_friction > self.static_friction:
            raise ValueError(
                f"dynamic_friction {self.dynamic_friction} is above static_friction {self.static_friction}; "
                "sliding takes no more force than starting"
            )
        return self

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface, with the simplest kernel for its textures and materials."""
        shape = spline_surface(surface, self.dequantise, self.radius_m)
        # Each kernel has its own module, so that only the required one is compiled.
        law = self._law(surface)
        arguments = (*shape, tile_bounds(shape[0]), *law.arguments)
        return CompiledTouch(_still_tick(law.kind), arguments, law.memory, law.stiffness_n_per_m)

    def film(self, surface: HapticSurface, period_s: float = 0.001, frame_s: float = 1 / 30) -> Film:
        """Return a film that begins with this surface, whose labels and materials stay in place.

        Each place moves at 0.1 m/s at most, and so slowly that the spring force on a hand at rest changes by at most
        0.08 N a tick. Quantised heights are not smoothed.
        """
        from .film.film import create_film

        if self.radius_m:
            raise ConfigError(f"radius_m {self.radius_m:g}: a film is felt with a point; leave out `radius_m`")
        check_positive("period_s", period_s)
        check_positive("frame_s", frame_s)
        law = self._law(surface)
        damping_n_s_per_m = float(law.arguments[1][:, 1].max()) if law.kind != "spring" else 0.0
        spring = law.stiffness_n_per_m, damping_n_s_per_m
        return create_film(
            surface, _moving_tick(law.kind), law.arguments, law.memory, spring, float(period_s), float(frame_s)
        )

    def _law(self, surface: HapticSurface) -> _Law:
        from .contact.approach import REMEMBERED

        memory = np.zeros(REMEMBERED)
        if self.texture and (tables := split_textures(surface, self.friction)):
            labels, table, textures, state = tables
            stiffness = max(float(table[:, 0].max()), bristle_stiffness(textures))
            return _Law("textures", (labels, table, memory, textures, state), memory, stiffness)
        plain = self.stiffness_n_per_m, self.damping_n_s_per_m, self.static_friction, self.dynamic_friction
        labels, table = material_table(surface, plain)
        if not self.friction:
            table[:, 2:] = 0
        if len(table) == 1 and not table[0, 1:].any():
            return _Law("spring", (float(table[0, 0]), memory), memory, float(table[0, 0]))
        return _Law("materials", (labels, table, memory), memory, float(table[:, 0].max()))


def _still_tick(kind: str) -> Tick:
    if kind == "spring":
        from .kernels.proxy_spring import spring_tick as tick
    elif kind == "materials":
        from .kernels.proxy import tick
    else:
        from .kernels.proxy_texture import textured_tick as tick
    return tick


def _moving_tick(kind: str) -> Tick:
    if kind == "spring":
        from .film.proxy_spring_kernels import moving_spring_tick as tick
    elif kind == "materials":
        from .film.proxy_kernels import moving_tick as tick
    else:
        from .film.proxy_texture_kernels import moving_textured_tick as tick
    return tick
