"""Candidates of the goal: approach, verification, acceptance or rejection."""
