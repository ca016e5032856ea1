"""The marks of a page: written as SVG, read again, rendered to PDF and pixels, and the gaps between them measured."""
