"""Materials: their library, and which segment gets which."""
