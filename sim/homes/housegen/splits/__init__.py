"""The shipped splits: recipes of their houses, and the list and cache of houses that are generated on first use."""
