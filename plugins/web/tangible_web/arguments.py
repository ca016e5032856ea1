"""Check of what a page sends with a request, by the annotations of the function that answers it."""

import inspect
import json
from collections.abc import Callable
from functools import cache
from typing import Any, get_type_hints

from pydantic import BaseModel, ConfigDict, ValidationError, create_model

from tangible_core.errors import ConfigError, shown

MAX_SHOWN = 200


def checked_arguments(name: str, answer: Callable[..., Any], own: int, said: dict[str, Any]) -> dict[str, Any]:
    """Return a page's arguments of a function, without its `own` first, checked by type. Raises: ConfigError."""
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in inspect.signature(answer).parameters.values()):
        return said  # it checks them itself
    try:
        found = _model(answer, own).model_validate_json(json.dumps(said))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "arguments"
        raise ConfigError(shown(f"{name}: {where}: {first['msg']}", MAX_SHOWN)) from error
    except RecursionError as error:
        raise ConfigError(f"{name}: the arguments are nested too deeply") from error
    return {key: getattr(found, key) for key in found.model_fields_set}


@cache
def _model(answer: Callable[..., Any], own: int) -> type[BaseModel]:
    """Return a model of the arguments after the first `own`, and no others."""
    types = get_type_hints(answer)
    rest = list(inspect.signature(answer).parameters.values())[own:]
    fields: dict[str, Any] = {
        each.name: (types[each.name], ... if each.default is each.empty else each.default) for each in rest
    }
    return create_model(answer.__name__, __config__=ConfigDict(extra="forbid", strict=True), **fields)
