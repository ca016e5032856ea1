from .assignment import find as find
from .assignment import library as library
from .assignment import load_library as load_library
from .files import VALUES as VALUES
from .files import value_sources as value_sources
