"""Experiments and tables for the makers of the project; not part of the installed package."""
