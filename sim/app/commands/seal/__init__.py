"""Commands of organisers of a challenge: make a sealed split, publish its hash, reveal it after the deadline."""
