"""Colour, depth and segmentation images of a compiled model, rendered offscreen with shadows of the lamps."""
