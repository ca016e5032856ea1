"""Numbers with a unit: an option's name ends with its unit, and a number may be written with a unit of its kind."""

import re
from collections.abc import Mapping
from decimal import Decimal
from inspect import cleandoc, getdoc
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, cast, get_args, get_origin
from weakref import WeakKeyDictionary

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, ValidationError, ValidationInfo, field_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from ..errors import OptionError
from .option_errors import sentences_about
from .options import field_texts, options_as_text
from .units import option_title, option_unit, option_units

_DIGITS = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_QUANTITY = re.compile(rf"\s*((?>{_DIGITS}))\s*(\D.*?)\s*")


class _Blocks(type(BaseModel)):
    """The class of all blocks of options: what is wrong with the options of a new one is an OptionError."""

    @property
    def __doc__(cls) -> str | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        model = cast("type[BaseModel]", cls)
        if cls not in _TEXTS and model.__pydantic_complete__:
            _TEXTS[cls] = vars(cls).get("__doc__")  # which the schema of the options asks for
            _TEXTS[cls] = "\n\n".join(filter(None, (getdoc(cls), options_as_text(model))))
        return _TEXTS.get(cls, vars(cls).get("__doc__"))

    if not TYPE_CHECKING:  # the signature of each block is that of its fields

        def __call__(cls, *values: Any, **options: Any) -> Any:
            if values:
                names = ", ".join(f"{name}=..." for name in list(cls.model_fields)[:MAX_NAMED]) or "it has none"
                raise OptionError(f"{cls.__name__}: write options with their names, such as {names}")
            try:
                return super().__call__(**options)
            except ValidationError as error:
                sentences = [text for _, text in sentences_about(error, cls, options)]
            raise OptionError(*(f"{cls.__name__}: {sentence}" for sentence in sentences))


_TEXTS = WeakKeyDictionary[type, str | None]()
"""The documentation of classes with that of their options, once it was requested."""
MAX_NAMED = 3


class Quantities(BaseModel, metaclass=_Blocks):
    """The base of all blocks of options. A number whose name ends with a unit may be text with a unit of that kind.

    Raises: OptionError for an unknown option, or a value that an option cannot have.

    >>> class Block(Quantities):
    ...     width_m: float
    >>> Block(width_m="6 mm").width_m, Block(width_m=0.006).width_m
    (0.006, 0.006)
    """

    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid")

    @field_validator("*", mode="before")
    @classmethod
    def _parse_number(cls, value: Any, info: ValidationInfo) -> Any:
        """Convert text with a unit to a number; true, which is 1 to pydantic, is not one. Raises: ValueError."""
        name = info.field_name or ""
        if isinstance(value, bool):
            kinds = _kinds(cls.model_fields[name].annotation)
            if {float, int} & kinds and not {bool, Path} & kinds:  # what may be a file as well has a check of its own
                raise ValueError("Input should be a valid number")
        units = option_units(name)
        if units and isinstance(value, list | tuple):
            return [_as_number(number, units) for number in cast("list[Any]", value)]
        return _as_number(value, units)

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler, /) -> JsonSchemaValue:
        schema = handler(core)
        block = handler.resolve_ref_schema(schema)
        if text := vars(cls).get("__doc__"):
            block["description"] = cleandoc(text)
        block["title"] = option_title(re.sub(r"(?<=[a-z])(?=[A-Z])", "_", cls.__name__).lower())
        texts = field_texts(cls)
        for name, option in block.get("properties", {}).items():
            if name in texts:
                option.setdefault("description", texts[name])
            option["title"] = option_title(name)
            if unit := option_unit(name):
                option["unit"] = unit
            if units := option_units(name):
                _allow_text(option, units)
        return schema


def _kinds(hint: Any) -> set[Any]:
    """Return the types that an annotation is made of.

    >>> _kinds(tuple[Annotated[float, "finite"], bool | None]) == {float, bool, type(None)}
    True
    """
    parts = get_args(hint)[: 1 if get_origin(hint) is Annotated else None]
    return {kind for part in parts for kind in _kinds(part)} if parts else {hint}


def _as_number(value: Any, units: Mapping[str, Decimal]) -> Any:
    """Return a number with a unit as the number in the option's own unit; any other value as it is."""
    match = _QUANTITY.fullmatch(value) if units and isinstance(value, str) else None
    if match is None:
        return value
    worth = next((factor for unit, factor in units.items() if _plain(unit) == _plain(match[2])), None)
    if worth is None:
        raise ValueError(f"write a number in {next(iter(units))}, or with one of the units {', '.join(units)}")
    try:
        return float(Decimal(match[1]) * worth)  # in decimals: 30 um is 3e-05 to the last digit
    except ArithmeticError as error:
        raise ValueError("this number is too large") from error


MAX_WITH_UNIT = 1e9  # above it, a number is a mistake to complain about as it is


def with_units(value: Any, name: str = "", before: Any = None) -> Any:
    """Return a number as text in the unit in which the option was written before, and so the numbers of a block.

    An option that was not written gets millimetres, or its own unit where it is not a length below a metre.

    >>> with_units(0.0045, "relief_m", "6 mm"), with_units(0.0045, "relief_m", 0.006)
    ('4.5 mm', 0.0045)
    >>> with_units({"height_m": 0.0061, "segments": 6})
    {'height_m': '6.1 mm', 'segments': 6}
    """
    if isinstance(value, dict):
        block, old = cast("dict[Any, Any]", value), cast("dict[Any, Any]", before if isinstance(before, dict) else {})
        return {key: with_units(part, str(key), old.get(key)) for key, part in block.items()}
    units = option_units(name)
    if not units or isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        return value
    if before is None and abs(value) < MAX_WITH_UNIT:
        before = f"1 {'mm' if 'mm' in units and abs(value) < 1 else next(iter(units))}"
    match = _QUANTITY.fullmatch(before) if isinstance(before, str) else None
    worth = match and next((factor for unit, factor in units.items() if _plain(unit) == _plain(match[2])), None)
    return f"{(Decimal(repr(value)) / Decimal(worth)).normalize():f} {match[2]}" if match and worth else value


def _plain(unit: str) -> str:
    """Return the plain form of a unit: `N s/m`, `N·s/m` and `Ns/m` are one, and so are the two signs for micro."""
    return re.sub(r"[\s*·]", "", unit).translate({0xB5: "u", 0x3BC: "u"})


def _allow_text(schema: dict[str, Any], units: Mapping[str, Decimal]) -> None:
    """Allow text with a unit for each number in the schema of an option."""
    for part in ("anyOf", "prefixItems"):
        if part in schema:
            schema[part] = [form for option in schema[part] for form in _forms(option, units, nested=part != "anyOf")]
    if schema.get("type") == "number":
        schema["anyOf"] = _forms({key: schema.pop(key) for key in _OF_NUMBERS if key in schema}, units)


def _forms(form: dict[str, Any], units: Mapping[str, Decimal], nested: bool = False) -> list[dict[str, Any]]:
    if form.get("type") != "number":
        _allow_text(form, units)
        return [form]
    example = f"6 {'mm' if 'mm' in units else next(iter(units))}"
    forms = [form, {"type": "string", "pattern": rf"^{_DIGITS}\s*({'|'.join(units)})$", "examples": [example]}]
    return [{"anyOf": forms}] if nested else forms


_OF_NUMBERS = ("type", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")
