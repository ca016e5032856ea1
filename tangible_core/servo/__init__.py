"""What stands between a law and a motor: the guard of every tick."""
