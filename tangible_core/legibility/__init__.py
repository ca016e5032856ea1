"""Whether fingers can read it: the rules of tactile graphics, and parts that are simplified until they keep them."""

from .choice import SimplifyChoice as SimplifyChoice
from .legible import Legibility as Legibility
from .legible import legibility as legibility
from .simplify import simplify as simplify
