"""A house and a robot as one compiled model: motion, free space, geodesic distances, house checks."""
