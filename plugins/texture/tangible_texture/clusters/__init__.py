"""Clusters of features without chance, classes of grey levels, and the labels of pixels."""
