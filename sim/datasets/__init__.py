"""Labelled views for training segmentation networks, and their WebDataset shards.

Imports env and the rooms below it."""
