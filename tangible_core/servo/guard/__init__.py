"""What stands between a law and a motor: limits, softening, passivity."""
