"""The road of a whole matcher: what comes before and after the matching itself, dense or feature by feature."""
