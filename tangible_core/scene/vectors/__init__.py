"""Drawings in vectors: SVG, and a page of a PDF. Their texts, and the parts of an SVG, are known and not guessed."""

from .page import VectorPage as VectorPage
from .page import frame_texts as frame_texts
from .page import rank_labels as rank_labels
from .pdf import read_pdf as read_pdf
from .svg import read_svg as read_svg
