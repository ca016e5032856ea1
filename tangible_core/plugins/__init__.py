"""What a plugin implements, how it is found, and who watches."""
