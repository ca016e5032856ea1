"""Comparing methods: run time, memory and error of each on the same scenes, side by side."""
