"""Where the proxy comes into contact, and where it rests."""
