"""Baselines that the Stubborn agent is compared with."""
