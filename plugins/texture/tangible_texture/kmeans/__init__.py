"""k-means: Lloyd's rounds, the number of clusters, and a label map of them."""
