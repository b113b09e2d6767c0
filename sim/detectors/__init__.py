"""Simulated detectors that read the true labels and make the errors of a segmentation network."""
