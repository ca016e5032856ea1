"""YAML texts: read within bounds, complained of by line and column, and changed in place."""
