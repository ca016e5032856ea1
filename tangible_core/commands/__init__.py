"""What the command line does, one command a file; each is imported when it is called."""
