"""The sizes of a cell of braille, in metres.

Source: Specification 800, "Braille Books and Pamphlets", section 3.2, National Library Service for the Blind and Print
Disabled, Library of Congress.
"""

DOT_DIAMETER_M = 0.00144
"""The diameter of a dot at its base."""
DOT_HEIGHT_M = 0.00048
"""The height of a dot above the ground."""
DOT_PITCH_M = 0.00234
"""The distance from the centre of a dot to the next of its cell, down and across."""
CELL_PITCH_M = 0.0062
"""The distance from the centre of a dot to the same dot of the next cell."""
LINE_PITCH_M = 0.010
"""The distance from the centre of a dot to the same dot of the next line."""
