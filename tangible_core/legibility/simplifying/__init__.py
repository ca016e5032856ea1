"""Parts simplified until fingers can read them."""

from .choice import SimplifyChoice as SimplifyChoice
from .simplify import simplify as simplify
