"""Baselines that the Stubborn agent is compared with.

Imports the agent and its parts.
"""
