"""Viewers of running episodes: video, window, Rerun log, terminal.

Imports env and the rooms below it."""
