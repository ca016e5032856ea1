"""Braille: text as cells of six dots, and where the dots lie in metres."""

from tangible_legibility.rules import CELL_PITCH_M as CELL_PITCH_M
from tangible_legibility.rules import DOT_DIAMETER_M as DOT_DIAMETER_M
from tangible_legibility.rules import DOT_HEIGHT_M as DOT_HEIGHT_M
from tangible_legibility.rules import DOT_PITCH_M as DOT_PITCH_M
from tangible_legibility.rules import LINE_PITCH_M as LINE_PITCH_M

from .cells import Cells as Cells
from .cells import as_ascii as as_ascii
from .cells import as_unicode as as_unicode
from .cells import dots as dots
from .cells import height_m as height_m
from .cells import width_m as width_m
from .translation import BrailleChoice as BrailleChoice
from .translation import in_grade as in_grade
from .translation import title_in_braille as title_in_braille
from .translation import translate as translate
from .translation import visible as visible
from .translation import wrapped as wrapped
from .translation import written_by as written_by
