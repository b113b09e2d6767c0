"""Segmenters: from an observation to scores of the goal category.

Imports nothing else of `stubborn`; PyTorch only in the network's modules.
"""
