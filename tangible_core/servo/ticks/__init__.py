"""The ticks of a force loop: their code, clock and schedule, and the rights that keep them on time."""
