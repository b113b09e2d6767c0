"""Demonstrations for imitation, and the fit of the appearance of colours and pictures."""
