"""Whether fingers can read it: the rules of tactile graphics, and parts that are simplified until they keep them."""

from .choice import SimplifyChoice as SimplifyChoice
from .legible import Legibility as Legibility
from .legible import legibility as legibility
from .legible import sizes as sizes
from .materials import apart as apart
from .rules import PROFILES as PROFILES
from .rules import Profile as Profile
from .rules import Rule as Rule
from .simplify import simplify as simplify
