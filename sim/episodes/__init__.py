"""Splits and episode files: which house, start and goal each episode has."""
