"""LeRobot: recorded runs as its datasets, and the environment in the form that its policies expect.

| module | content |
|---|---|
| `features` | observation, state, action and task as LeRobot names them; the environment and the datasets share them |
| `replays` | the frames of a recorded episode, by its actions in physics |
| `dataset` | the files of a dataset in format v3 |
| `environment` | the Gymnasium environment for `lerobot-eval`; the package `lerobot_env_stubborn` registers it |

None of them imports `lerobot`.
"""
