from .legible import legibility as legibility
from .legible import sizes as sizes
from .neighbours import apart as apart
from .rules import PROFILES as PROFILES
from .rules import Profile as Profile
from .rules import Rule as Rule
from .simplifying.simplify import simplify as simplify
