"""Units at the end of the names of options."""

from collections.abc import Mapping
from decimal import Decimal

_LENGTHS = {"m": 1, "cm": "1e-2", "mm": "1e-3", "um": "1e-6"}
UNITS: Mapping[str, Mapping[str, Decimal]] = {
    suffix: {unit: Decimal(worth) for unit, worth in units.items()}
    for suffix, units in {
        "_n_s_per_m": {"N s/m": 1},
        "_n_per_m": {"N/m": 1, "N/cm": 100, "N/mm": 1000},
        "_m_per_s": {"m/s": 1, "cm/s": "1e-2", "mm/s": "1e-3"},
        "_deg": {"deg": 1},
        "_hz": {"Hz": 1, "kHz": 1000},
        "_kg": {"kg": 1, "g": "1e-3"},
        "_m": _LENGTHS,
        "_n": {"N": 1, "mN": "1e-3"},
        "_s": {"s": 1, "ms": "1e-3", "us": "1e-6", "min": 60},
    }.items()
}
"""The end of an option's name -> the units that may be written, each with its worth in the option's own unit."""


def option_units(name: str) -> Mapping[str, Decimal]:
    """Return the units in which an option of this name may be written, its own first; {} if its name has no unit.

    >>> list(option_units("stiffness_n_per_m")), list(option_units("segments"))
    (['N/m', 'N/cm', 'N/mm'], [])
    """
    return next((units for suffix, units in UNITS.items() if name.endswith(suffix)), _NONE)


_NONE: Mapping[str, Decimal] = {}


def option_unit(name: str) -> str:
    """Return the unit of an option of this name; "" if it has none.

    >>> option_unit("stiffness_n_per_m"), option_unit("window_px"), option_unit("segments")
    ('N/m', 'px', '')
    """
    return next((unit for suffix, unit in _OPTION_UNITS.items() if name.endswith(suffix)), "")


def option_title(name: str) -> str:
    """Return an option's name in words, without its unit: the label of a field for it.

    >>> option_title("stiffness_n_per_m"), option_title("least_contrast")
    ('Stiffness', 'Least contrast')
    """
    suffix = next((suffix for suffix in _OPTION_UNITS if name.endswith(suffix)), "")
    words = name.removesuffix(suffix).replace("_", " ").strip()
    return words[:1].upper() + words[1:]


# The end of an option's name -> its unit, including units without alternatives.
_OPTION_UNITS = {suffix: next(iter(units)) for suffix, units in UNITS.items()} | {
    "_px": "px",
    "_mb": "MB",
    "_percent": "%",
}
