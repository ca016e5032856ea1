"""The analysis of a finished study: figures with their intervals, plots, a table for a paper, and plain sentences."""
