"""Free-form furniture of the pool `wide`: generators that combine parts at random, so that shapes hardly repeat."""
