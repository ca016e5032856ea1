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


def units_of(name: str) -> Mapping[str, Decimal]:
    """Return the units in which an option of this name may be written, its own first; {} if its name has no unit.

    >>> list(units_of("stiffness_n_per_m")), list(units_of("segments"))
    (['N/m', 'N/cm', 'N/mm'], [])
    """
    return next((units for suffix, units in UNITS.items() if name.endswith(suffix)), _NONE)


_NONE: Mapping[str, Decimal] = {}


def unit_of(name: str) -> str:
    """Return the unit of an option of this name; "" if it has none.

    >>> unit_of("stiffness_n_per_m"), unit_of("window_px"), unit_of("segments")
    ('N/m', 'px', '')
    """
    return next((unit for suffix, unit in _UNIT_OF.items() if name.endswith(suffix)), "")


def title_of(name: str) -> str:
    """Return an option's name in words, without its unit: the label of a field for it.

    >>> title_of("stiffness_n_per_m"), title_of("least_contrast")
    ('Stiffness', 'Least contrast')
    """
    suffix = next((suffix for suffix in _UNIT_OF if name.endswith(suffix)), "")
    words = name.removesuffix(suffix).replace("_", " ").strip()
    return words[:1].upper() + words[1:]


_UNIT_OF = {suffix: next(iter(units)) for suffix, units in UNITS.items()} | {
    "_px": "px",
    "_mb": "MB",
    "_percent": "%",
}
"""The end of an option's name -> its unit, including units without alternatives."""
