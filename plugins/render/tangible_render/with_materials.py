"""The effects of a surface's materials around any other force law."""

from functools import partial
from typing import Annotated, ClassVar, final

import numpy as np
from pydantic import AfterValidator, Field

from tangible_core.compiled import CompiledTouch
from tangible_core.data import Force, HapticState, HapticSurface
from tangible_core.errors import TangibleError
from tangible_core.materials import find, library
from tangible_core.plugins import ForceRenderer, PlainTouch, Touch
from tangible_render.haptic_textures.table import bristle_stiffness

from .effects.effects_table import EFFECT_COLUMNS, effects_table, initial_memory
from .effects.inner_law import Law, build_law, complete_options


def _refusal(cls: type[ForceRenderer]) -> str:
    return "renders materials itself; use it directly" if cls.renders_materials else ""


_COMPLETE = AfterValidator(partial(complete_options, refusal=_refusal))


def _builtin_name(material: str) -> str:
    try:
        return find(material, library()).name
    except TangibleError as error:
        raise ValueError(str(error)) from error


class WithMaterials(ForceRenderer):
    """Friction that sticks and slips, fine textures and damping of the surface's materials, around any other force law.

    The texture t(x, y) is added to the surface of the inner force law: its force G is evaluated at z - t, and the
    result is (G_x - t_x G_z, G_y - t_y G_z, G_z), which does the same work. So an inner force law that generates no
    energy generates none with a texture, where the material is uniform. Friction and damping, which only take energy,
    are added to G: |G| is the push, damping lies along G, and across it friction, a bristle that sticks up to the
    static friction and slides on the dynamic one. For a lateral force law the push is k d, with k the material's
    stiffness and d the depth; it has no damping.

    If the inner force law uses the stiffness of materials, that is kept. `proxy` renders all of this itself.
    Source: Robles-De-La-Torre & Hayward, Nature 412 (2001), for the texture on level ground; Hayward & Armstrong, A new
    computational model of friction applied to haptic rendering, Experimental Robotics VI, 2000.
    """

    renders_materials: ClassVar[bool] = True
    why_still: ClassVar[str] = (
        "no force law without materials supports moving surfaces; `proxy` does, and renders materials"
    )

    law: Annotated[Law, _COMPLETE, Field(validate_default=True)] = "penalty-gradient"
    """The inner force law: its name, or {use: its name} with its options."""
    friction: bool = True
    """Render friction."""
    texture: bool = True
    """Render fine textures; if false, their drag and their own friction are left out too."""
    damping: bool = True
    """Render the damping of materials; the inner force law keeps its own in either case."""
    material: Annotated[str, AfterValidator(_builtin_name)] | None = None
    """A built-in material for a surface without any; by default such a surface feels like the inner force law alone."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return a new touch on this surface; the inner force law's own where the materials add nothing."""
        _, law = build_law(self.law, _refusal)
        surface = self._with_material(surface)
        touch = law.touch(surface)
        if surface.labels is None or not surface.materials:
            return touch
        labels, table = effects_table(surface, self.friction, self.texture, self.damping and not law.is_lateral)
        if not table[:, EFFECT_COLUMNS].any():
            return touch
        if isinstance(touch, CompiledTouch):
            return _wrap(touch, surface, labels, table, law.is_lateral)
        from .effects.stub_law import stub_law

        stub = CompiledTouch(stub_law, (np.zeros(6), np.zeros(3)), stiffness=touch.stiffness_n_per_m)
        return MaterialsAdapter(touch, _wrap(stub, surface, labels, table, law.is_lateral))

    def _with_material(self, surface: HapticSurface) -> HapticSurface:
        if self.material is None or (surface.labels is not None and surface.materials):
            return surface
        labels = np.zeros(surface.height_m.shape, np.int32)
        return HapticSurface(surface.relief, labels, (find(self.material, library()),))


@final
class MaterialsAdapter(PlainTouch):
    """Materials around a force law in plain Python, by the kernel for compiled ones."""

    def __init__(self, law: Touch, kernel_touch: CompiledTouch) -> None:
        self.stiffness_n_per_m: float | None = kernel_touch.stiffness_n_per_m
        self._law, self._kernel_touch = law, kernel_touch

    def force(self, state: HapticState) -> Force:
        """Return the inner force law's force with the effects of the materials, N."""
        (state_of_law, force_of_law), memory = self._kernel_touch.fixed[0], self._kernel_touch.fixed[-1]
        # The kernel calls `stub_law`: it runs once to learn the state at which to evaluate the force law, after which
        # its memory is restored, and once more with the force for that state.
        before = memory.copy()
        self._kernel_touch.force(state)
        memory[:] = before
        x, y, z, vx, vy, vz = state_of_law.tolist()
        force_of_law[:] = self._law.force(HapticState((x, y, z), (vx, vy, vz), state.time_s, state.buttons))
        return self._kernel_touch.force(state)


def _wrap(
    law: CompiledTouch, surface: HapticSurface, labels: np.ndarray, table: np.ndarray, lateral: bool
) -> CompiledTouch:
    from .effects import kernels

    bristle = float(table[:, kernels.STIFFNESS].max())
    rest = (labels, *map(float, surface.extent_m), table, bristle, initial_memory())
    bristles = max(bristle * bool(table[:, kernels.STATIC].any()), bristle_stiffness(table))
    stiffness = None if law.stiffness_n_per_m is None else max(law.stiffness_n_per_m, bristles)
    if not lateral:
        return CompiledTouch(kernels.tick, (law.fixed, law.address(), *rest), law.memory, stiffness)
    heights = np.ascontiguousarray(surface.height_m, np.float32)
    arguments = (law.fixed, law.address(), heights, *rest)
    return CompiledTouch(kernels.lateral_tick, arguments, law.memory, stiffness)
