"""The version of the physics: with the same version, the same actions lead to the same motions and metrics."""

PHYSICS_VERSION = 1
"""Increased with every change after which the same actions in the same house give other motions, collisions or scores.

A run records it, and `stubborn verify` replays the actions of a run with the same version only.
"""
