"""The hook modules that come with the program; plugins like any other."""
