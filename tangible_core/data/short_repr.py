"""Objects in a line: arrays by their size and range, long values cut."""

from dataclasses import fields, is_dataclass
from typing import Any, cast

import numpy as np

from ..errors import quoted


def short_repr(value: Any) -> str:
    """Return the name of a dataclass's object with its fields that are not at their defaults.

    >>> from tangible_core.data import DisparityMap
    >>> short_repr(DisparityMap(np.arange(6, dtype=np.float32).reshape(2, 3)))
    'DisparityMap(disparity_px=<float32 (2, 3), 0 to 5>, confidence=<float32 (2, 3), 1 to 1>)'
    """
    shown = ((each.name, getattr(value, each.name)) for each in fields(value) if _differs(value, each))
    return f"{type(value).__name__}({', '.join(f'{name}={_part(part)}' for name, part in shown)})"


def _differs(value: Any, field: Any) -> bool:
    own = getattr(value, field.name)
    return isinstance(own, np.ndarray) or (own is not field.default and own != field.default)


def _part(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return _array(cast(np.ndarray, value))
    if isinstance(value, tuple):
        return quoted(tuple(getattr(each, "name", each) for each in cast("tuple[Any, ...]", value)))
    return repr(value) if is_dataclass(value) else quoted(value)


def _array(array: np.ndarray) -> str:
    """Return an array's type, shape and range; NaN and infinity are left out of the range."""
    text = f"{array.dtype} {array.shape}"
    known = array[np.isfinite(array)] if array.dtype.kind in "fc" else array
    if not known.size or array.dtype.kind not in "buif":
        return f"<{text}>"
    unknown = ", some NaN" if known.size < array.size else ""
    return f"<{text}, {known.min():g} to {known.max():g}{unknown}>"
