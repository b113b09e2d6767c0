"""Commands that judge a segmentation network: its figures, its mistakes in episodes, the objects that it misses."""
