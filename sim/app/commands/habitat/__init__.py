"""Commands for users of Habitat: an environment with habitat-lab, its data sets, and scripts that are run there."""
