"""Drawings: whether a picture is one, its areas, its lines, and the places of its texts."""

from .areas import Areas as Areas
from .areas import find_areas as find_areas
from .areas import nearest as nearest
from .charts import bar_values as bar_values
from .ink import Ink as Ink
from .ink import find_ink as find_ink
from .ink import noise_level as noise_level
from .kind import DrawnPicture as DrawnPicture
from .kind import KindFound as KindFound
from .kind import PictureKind as PictureKind
from .kind import kind_sentence as kind_sentence
from .kind import picture_kind as picture_kind
from .lines import Lines as Lines
from .lines import find_lines as find_lines
from .marks import Marks as Marks
from .marks import find_marks as find_marks
from .text import Text as Text
from .text import find_texts as find_texts
