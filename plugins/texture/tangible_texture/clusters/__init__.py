"""Classes of features or of grey levels, and the labels that come of them."""
