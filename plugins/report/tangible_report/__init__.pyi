from .sheet import Sheet as Sheet
from .text import Text as Text
