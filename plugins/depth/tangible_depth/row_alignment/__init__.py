"""The tests whether the rows of a pair correspond, and their constant offset: start at `common_rows`."""
