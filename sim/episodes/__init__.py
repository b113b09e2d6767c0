"""Splits and episode files: which house, start and goal each episode has.

Imports task, housegen and the rooms below them."""
