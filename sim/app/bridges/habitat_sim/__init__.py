"""The part of `habitat_sim` that habitat-lab and published agents use, over this project's houses, robot and camera.

`sim.app.bridges.habitat_sim.finder` provides it under the name `habitat_sim`, so that habitat-lab's own simulator
class (`Sim-v0`), tasks, measures and data sets run on MuJoCo unchanged. Frames are Habitat's: y up, an agent without
rotation looks along -z; `sim.episodes.habitat` converts them.

| module | content |
|---|---|
| `finder` | makes `import habitat_sim`, `magnum` and `corrade` work, and refuses names that have no meaning here |
| `settings` | configurations and enumerations: records without behaviour |
| `simulator` | `Simulator`: one house, one robot, its cameras |
| `agent` | `Agent`, its state and its sensors |
| `pathfinder` | `PathFinder` over the robot's free space, and the greedy follower |
| `semantics` | the semantic scene: objects, rooms, storeys |
| `maths` | vectors and quaternions of magnum, `habitat_sim.utils.common` |
"""
