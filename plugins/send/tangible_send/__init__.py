"""A page to send: one HTML file with a picture that anybody can explore, without a program and without a network."""
