"""Fits of the plain numbers that agents read: fusion of views, context of objects, verifiers."""
