"""Haply's Inverse3, through the service that its maker installs; and a service that is not there, to try it with."""
