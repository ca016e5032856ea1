"""Haply's Inverse3, through the service that its maker installs."""
