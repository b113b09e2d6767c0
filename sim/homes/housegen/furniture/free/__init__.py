"""Furniture of the pool `wide`: generators that combine parts at random, so that shapes hardly repeat.

No split of episodes shows them: they add variety to the training of perception. Houses of this pool also show the
styles of `train`. Sizes follow the same sources as those of `train`, but vary more.
"""
