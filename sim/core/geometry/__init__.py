"""Plane geometry without MuJoCo: poses, grids over the floor, convex bodies."""
