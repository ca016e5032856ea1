"""The places at which a participant answers: a terminal, and a page in the browser."""
