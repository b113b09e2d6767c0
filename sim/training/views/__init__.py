"""Labelled views for training segmentation networks, and their WebDataset shards."""
