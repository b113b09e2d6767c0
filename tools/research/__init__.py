"""Experiments and the tables of the documentation."""
