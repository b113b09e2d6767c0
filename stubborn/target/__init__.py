"""Candidates of the goal: approach, verification, acceptance or rejection.

Imports exploration, planning and mapping.
"""
