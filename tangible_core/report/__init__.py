"""What a run is shown by: one sheet of pictures and one file of figures."""

from .errors import disparity_errors
from .figures import write_figures
from .sheet import draw_sheet

__all__ = ["disparity_errors", "draw_sheet", "write_figures"]
