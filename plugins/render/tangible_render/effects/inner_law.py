"""The option for an inner force law: its name, or {use: its name} with its options."""

from collections.abc import Callable
from typing import Any

from tangible_core.errors import TangibleError
from tangible_core.plugins import ForceRenderer

Law = str | dict[str, Any]
# A function that returns the reason why a class cannot be the inner force law; empty if it can.
Refusal = Callable[[type[ForceRenderer]], str]


def build_law(law: Law, refusal: Refusal) -> tuple[str, ForceRenderer]:
    """Return the name and the method. Raises: ValueError if it has no name or is refused, TangibleError."""
    from tangible_core.plugins.registry import load_method

    options: dict[str, Any] = {"use": law} if isinstance(law, str) else dict(law)
    name = options.pop("use", None)
    if not isinstance(name, str):
        raise ValueError("a force law needs a name, {use: ...}")
    cls = load_method("render", name)
    if why := refusal(cls):
        raise ValueError(f"{name} {why}")
    return name, cls(**options)


def complete_options(law: Law, refusal: Refusal) -> dict[str, Any]:
    """Return the force law's name and all of its options. Raises: ValueError if the name or an option is wrong."""
    try:
        name, method = build_law(law, refusal)
    except TangibleError as error:
        raise ValueError(str(error)) from error
    return {"use": name, **method.model_dump(mode="json")}
