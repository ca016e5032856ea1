"""Drawings in vectors: SVG, and a page of a PDF. Their texts, and the parts of an SVG, are known and not guessed."""

from .page import VectorPage as VectorPage
from .page import framed_texts as framed_texts
from .page import rank_labels as rank_labels
from .reading import is_vectors as is_vectors
from .reading import read_vectors as read_vectors
