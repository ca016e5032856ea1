"""Windows compared along a row: normalised correlation and squared differences."""
