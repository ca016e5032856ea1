"""The ground of every page: its address and key, who is let in, and the hand that it moves."""
