"""Artist-made furniture that the user has installed: read once by `stubborn import furniture`, then used in houses.

`sources` reads the installed models, `labels` decides their categories, `meshes`, `reduction` and `solids` make
geometry of it, `library` writes and reads the folder of imported models, and `catalogue` makes styles of furniture of
them. No model is part of this repository, and houses that are made without such a folder do not change.
"""
