"""Connects agents that run in a process of their own, and agents and scripts that are written for Habitat."""
