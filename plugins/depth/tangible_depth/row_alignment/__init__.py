"""Whether the rows of a pair correspond, and by how much they are offset: start at `common_rows`."""
