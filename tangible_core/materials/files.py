"""Files of materials: YAML in, checked materials out; every complaint at once, each with file:line:column."""

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, cast

from pydantic import AfterValidator, ConfigDict, Discriminator, Field, Tag

from ..data import Material, Texture
from ..data.quantities import Quantities
from ..errors import MaterialError, did_you_mean, quoted, shown
from ..files.yaml.source import Source, Tree, parse_source, read_text

VALUES = tuple(each.name for each in fields(Material) if each.name not in ("name", "source"))
REQUIRED = ("stiffness_n_per_m", "damping_n_s_per_m", "static_friction", "dynamic_friction")


def _explained(key: str) -> str:
    known = (*VALUES, "others")
    if key not in known:
        raise ValueError(f"source of {quoted(key)}, which is not a property{did_you_mean(key, known)}")
    return key


Number = Annotated[float, Field(strict=True, ge=0, allow_inf_nan=False)]
Share = Annotated[float, Field(strict=True, ge=0, le=1)]
Explanations = dict[Annotated[str, AfterValidator(_explained)], str]


class MaterialBlock(Quantities):
    """How a material feels; where a shipped one is changed, what is left out stays."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, title="Material")

    stiffness_n_per_m: Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)]
    """Force for a depth of one metre, N/m. Desktop devices render up to 3000, and up to 900 under a texture."""
    damping_n_s_per_m: Number
    """Force against one metre per second along the normal, N s/m."""
    static_friction: Number
    """Lateral force at which it begins to slide, as a share of the normal force."""
    dynamic_friction: Number
    """Lateral force while it slides, as a share of the normal force; at most the static one."""
    roughness_m: Number = 0.0
    """Amplitude of the fine texture, m; that of one wave of the same power, where it is made of many."""
    grain_m: Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)] = 0.001
    """Wavelength of the fine texture, m: a stroke at 0.12 m/s vibrates with 0.12 / grain_m Hz."""
    texture: Texture = "stochastic"
    """Model of the fine texture. `smooth`: none. `periodic`: lines, or two crossed sets of them. `stochastic`: noise of
    one octave. `stick-slip`: such noise, and friction that sticks and slips once a grain. `drag`: such noise, and the
    drag of a liquid."""
    direction_deg: Annotated[float, Field(strict=True, ge=0, lt=180)] = 0.0
    """Where the lines of the texture run: 0 from left to right, 90 away from the user."""
    anisotropy: Share = 0.0
    """0: alike in all directions (`periodic`: two crossed sets of lines). 1: lines alone."""
    irregularity: Share = 0.0
    """`periodic` alone: share of the power that strays from strict repetition."""
    drag_n_s_per_m: Number = 0.0
    """Lateral force against one metre per second, in contact, N s/m; whatever the model."""
    seed: Annotated[int, Field(strict=True, ge=0)] = 0
    """Another seed is another specimen of the same material."""
    source: Annotated[
        Annotated[str, Tag(":text")] | Annotated[Explanations, Tag(":each")],
        Discriminator(lambda value: ":each" if isinstance(value, dict) else ":text"),
    ] = "guess"
    """Where the values come from: a text, or one for each value, and `others:`. Say `guess` where nobody measured."""


def read_materials(path: Path, base: Mapping[str, Material]) -> Mapping[str, Material]:
    """The base, and what a file adds to it or changes.

    Raises: ConfigError as `parse_materials`, or if there is no such file.
    """
    return parse_materials(read_text(path), path, base)


def parse_materials(text: str, path: Path, base: Mapping[str, Material]) -> Mapping[str, Material]:
    """The base, and what a text adds to it or changes; `path` is what complaints name.

    Raises: ConfigError with every complaint, one a line.
    """
    source = parse_source(text, path, "a library is a mapping from names to materials, such as `ice: {...}`")
    made = {name: _material(source, name, block, base) for name, block in source.tree.items()}
    source.settle()
    return MappingProxyType({**base, **cast("dict[str, Material]", made)})


def _material(source: Source, name: Any, block: Any, base: Mapping[str, Material]) -> Material | None:
    """The material of a block; None after a complaint."""
    if not isinstance(name, str):
        return source.complain((name,), f"{quoted(name)} is no name; write it in quotes")
    if not isinstance(block, dict):
        return source.complain(
            (name,), f"{shown(name)}: a material is a mapping from keys to values, not {quoted(block)}"
        )
    given = cast(Tree, block)
    whole = dict.fromkeys(REQUIRED, 1.0)  # so that each value is checked even where another is missing
    checked = source.model((name,), MaterialBlock, {**whole, **given})
    if missing := [key for key in REQUIRED if key not in given and name not in base]:
        are = "is" if len(missing) == 1 else "are"
        return source.complain((name,), f"{shown(name)}: {', '.join(missing)} {are} missing{did_you_mean(name, base)}")
    try:
        return checked and _merged(name, given, checked, base.get(name), source.path)
    except MaterialError as error:
        return source.complain((name,), str(error))


def _merged(name: str, given: Tree, checked: MaterialBlock, kept: Material | None, path: Path) -> Material:
    """A new material, or a kept one with what is given changed."""
    values: dict[str, Any] = {key: getattr(checked, key) for key in VALUES if key in given}
    said = checked.source
    source = "; ".join(f"{key}: {text}" for key, text in said.items()) if isinstance(said, dict) else said
    if kept is None:
        return Material(name, **values, source=source)
    changed = f"{', '.join(values)}: {path.name}; " if values else ""
    return replace(kept, **values, source=source if "source" in given else changed + kept.source)


def sources_of(material: Material) -> dict[str, str]:
    """Where each value of a material comes from."""
    found: dict[str, str] = {}
    rest: list[str] = []
    for part in material.source.split("; "):
        keys, colon, text = part.partition(": ")
        names = keys.split(", ")
        if colon and set(names) <= {*VALUES, "others"}:
            found = {**dict.fromkeys(names, text), **found}
        else:
            rest.append(part)
    others = "; ".join(rest) or found.pop("others", "guess")
    return {key: found.get(key, others) for key in VALUES}
