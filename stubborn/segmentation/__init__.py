"""Segmenters: from an observation to scores of the goal category."""
