"""Reinforcement learning of the explorer `semexp` in plans."""
