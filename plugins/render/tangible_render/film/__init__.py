"""Surfaces that move under the proxy: three slots for what comes next, and the ticks that go from one to another."""
