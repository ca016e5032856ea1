"""The force loop as the page's server has it: the page's hand, other devices, another law beside, recordings."""
