"""Scenes whose exact answer is known, for tests, benchmarks and comparisons."""
