"""A simulated Falcon: its USB chip, its boot loader and firmware, its arms, and the hand that holds it."""
