"""A participant's session: the order of trials, where it stopped, and what is kept."""
