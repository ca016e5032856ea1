"""The block `materials:`."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Discriminator, Tag

from ...errors import ConfigError, MaterialError
from ...files.yaml.source import Location, Source
from ...materials.assignment import NEUTRAL, find, load_library
from ...materials.rules import MaterialRule, Number
from ...scene.workspace import Section


class MaterialChoice(Section):
    """The material of each segment; of each part, with `parts:` or `heights:`."""

    rules: tuple[MaterialRule, ...] = ()
    """Rules for segments or parts; of several that fit, the first one wins. A material under `parts:` goes before
    them."""
    by: Annotated[
        Annotated[Literal["roughness", "rules"], Tag(":word")] | Annotated[dict[Number, str], Tag(":labels")],
        Discriminator(lambda value: ":labels" if isinstance(value, dict) else ":word"),
    ] = "roughness"
    """The choice for segments without a rule. `roughness`: by rank, the roughest segment of the picture gets the
    roughest material. A map: from the number of a segment to material, for all of its parts. `rules`: they get
    `default`."""
    default: str = NEUTRAL
    """The material of all other segments."""
    library: Path | None = None
    """A YAML file with custom materials, in addition to the built-in ones."""
    fit: Literal["device", "never"] = "device"
    """`device`: stiffness, texture and damping of each material are limited to what the device renders stably, and the
    outcome of the touch names them. `never`: materials stay as they are, and the guard scales the whole force."""


def check_material_names(source: Source, location: Location, choice: MaterialChoice) -> None:
    """Complain of materials that are not in the library; a library that cannot be read is its reader's complaint."""
    try:
        library = load_library(choice.library)
    except ConfigError:
        return
    names: list[tuple[Location, str]] = [(("default",), choice.default)]
    names += [(("rules", number, "material"), rule.material) for number, rule in enumerate(choice.rules)]
    labels = ("by",) if "by" in source.tree[location[0]] else ()
    names += [((*labels, label), name) for label, name in (choice.by.items() if isinstance(choice.by, dict) else ())]
    for place, name in names:
        try:
            find(name, library)
        except MaterialError as error:
            source.complain((*location, *place), str(error))
