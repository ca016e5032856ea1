"""Files of materials in YAML, checked at once: every complaint has its file:line:column."""

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, cast

from pydantic import AfterValidator, Discriminator, Field, Tag

from ..data import Material, Texture
from ..data.quantities import Quantities
from ..errors import MaterialError, did_you_mean, quoted, shown
from ..files.yaml.source import Source, Tree, parse_source, read_text

VALUES = tuple(field.name for field in fields(Material) if field.name not in ("name", "source"))
REQUIRED = ("stiffness_n_per_m", "damping_n_s_per_m", "static_friction", "dynamic_friction")


def _check_key(key: str) -> str:
    keys = (*VALUES, "others")
    if key not in keys:
        raise ValueError(f"source of {quoted(key)}, which is not a property{did_you_mean(key, keys)}")
    return key


Number = Annotated[float, Field(strict=True, ge=0, allow_inf_nan=False)]
Share = Annotated[float, Field(strict=True, ge=0, le=1)]
Explanations = dict[Annotated[str, AfterValidator(_check_key)], str]


class MaterialBlock(Quantities):
    """The values of a material; for a shipped one, values that are left out stay."""

    stiffness_n_per_m: Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)]
    """Force for a depth of one metre, N/m. Desktop devices render up to 3000, and up to 900 under a texture."""
    damping_n_s_per_m: Number
    """Force against one metre per second along the normal, N s/m."""
    static_friction: Number
    """Lateral force at which sliding starts, as a share of the normal force."""
    dynamic_friction: Number
    """Lateral force during sliding, as a share of the normal force; at most the static one."""
    roughness_m: Number = 0.0
    """Amplitude of the fine texture, m; for a sum of waves, that of one wave of the same power."""
    grain_m: Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)] = 0.001
    """Wavelength of the fine texture, m: a stroke at 0.12 m/s vibrates with 0.12 / grain_m Hz."""
    texture: Texture = "stochastic"
    """Model of the fine texture. `smooth`: none. `periodic`: lines, or two crossed sets of them. `stochastic`: noise of
    one octave. `stick-slip`: such noise, and friction that sticks and slips once a grain. `drag`: such noise, and the
    drag of a liquid."""
    direction_deg: Annotated[float, Field(strict=True, ge=0, lt=180)] = 0.0
    """Direction of the lines of the texture: 0 from left to right, 90 away from the user."""
    anisotropy: Share = 0.0
    """Directedness: 0, the same in all directions (`periodic`: two crossed sets of lines); 1, one set of lines."""
    irregularity: Share = 0.0
    """Share of the power that deviates from strict repetition, for `periodic` only."""
    drag_n_s_per_m: Number = 0.0
    """Lateral force against one metre per second, in contact, N s/m; for every model."""
    seed: Annotated[int, Field(strict=True, ge=0)] = 0
    """Seed of the random texture: another seed is another specimen of the material."""
    source: Annotated[
        Annotated[str, Tag(":text")] | Annotated[Explanations, Tag(":each")],
        Discriminator(lambda value: ":each" if isinstance(value, dict) else ":text"),
    ] = "guess"
    """Source of the values: a text, or one for each value and `others:`. Write `guess` for unmeasured values."""


def read_materials(path: Path, base: Mapping[str, Material]) -> Mapping[str, Material]:
    """Read a file that adds materials to the base, or changes them. Raises: ConfigError as `parse_materials`."""
    return parse_materials(read_text(path), path, base)


def parse_materials(text: str, path: Path, base: Mapping[str, Material]) -> Mapping[str, Material]:
    """Parse a text that adds materials to the base, or changes them. Raises: ConfigError with every complaint."""
    source = parse_source(text, path, "a library is a mapping from names to materials, such as `ice: {...}`")
    materials = {name: _material(source, name, block, base) for name, block in source.tree.items()}
    source.settle()
    return MappingProxyType({**base, **cast("dict[str, Material]", materials)})


def _material(source: Source, name: Any, block: Any, base: Mapping[str, Material]) -> Material | None:
    """Return the material of a block; None after a complaint."""
    if not isinstance(name, str):
        return source.complain((name,), f"{quoted(name)} is not a name; write it in quotes")
    if not isinstance(block, dict):
        return source.complain(
            (name,), f"{shown(name)}: a material is a mapping from keys to values, not {quoted(block)}"
        )
    values = cast(Tree, block)
    whole = dict.fromkeys(REQUIRED, 1.0)  # so that values are checked even if others are missing
    model = source.model((name,), MaterialBlock, {**whole, **values})
    if missing := [key for key in REQUIRED if key not in values and name not in base]:
        are = "is" if len(missing) == 1 else "are"
        return source.complain((name,), f"{shown(name)}: {', '.join(missing)} {are} missing{did_you_mean(name, base)}")
    try:
        return model and _merge(name, values, model, base.get(name), source.path)
    except MaterialError as error:
        return source.complain((name,), str(error))


def _merge(name: str, block: Tree, model: MaterialBlock, base: Material | None, path: Path) -> Material:
    values: dict[str, Any] = {key: getattr(model, key) for key in VALUES if key in block}
    origin = model.source
    source = "; ".join(f"{key}: {text}" for key, text in origin.items()) if isinstance(origin, dict) else origin
    if base is None:
        return Material(name, **values, source=source)
    prefix = f"{', '.join(values)}: {path.name}; " if values else ""
    return replace(base, **values, source=source if "source" in block else prefix + base.source)


def value_sources(material: Material) -> dict[str, str]:
    """Return the source of each value of a material."""
    sources: dict[str, str] = {}
    rest: list[str] = []
    for part in material.source.split("; "):
        keys, colon, text = part.partition(": ")
        names = keys.split(", ")
        if colon and set(names) <= {*VALUES, "others"}:
            sources = {**dict.fromkeys(names, text), **sources}
        else:
            rest.append(part)
    others = "; ".join(rest) or sources.pop("others", "guess")
    return {key: sources.get(key, others) for key in VALUES}
