"""The files of a run and of exports, written whole or not at all."""
