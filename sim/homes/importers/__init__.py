"""Turns houses of other projects into folders of houses in this project's format; one module for each source."""
