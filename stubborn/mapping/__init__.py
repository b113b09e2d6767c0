"""Map layers from observations: obstacles, collision marks, object scores.

Imports `stubborn.navmap` and `stubborn.raster`.
"""
