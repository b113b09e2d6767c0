"""Viewers of running episodes: video, window, Rerun log, terminal."""
