"""The appearance of a home: materials, textures, the looks of its structure, and its light."""
