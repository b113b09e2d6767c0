"""Families of traps: scenes with a difficulty and a seed, whose parameters are known."""
