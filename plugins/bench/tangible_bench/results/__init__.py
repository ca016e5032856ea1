"""Results: rows summed up, as tables and plots, and compared with earlier rows."""
