"""Families of traps: scenes with a difficulty, a seed and known parameters."""
