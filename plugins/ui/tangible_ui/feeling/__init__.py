"""The server's force loop: the page's hand, other devices, a second force law to compare, recordings."""
