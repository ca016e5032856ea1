"""Which disparities occur in a pair, and whether its rows correspond: found before anything is matched."""
