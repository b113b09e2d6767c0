"""Agents with Habitat's interface as agents of this project: `--agent habitat:package.module:CLASS`.

Scripts and environments for Habitat run on the real habitat-lab (`sim.app.bridges.habitat_sim`); docs/habitat.md
describes both.
"""
