"""An agent behind the client file, for tests: drives at random where depth shows room, and draws a map.

With an argument, the path of a file that does not exist, its first process writes it and exits at its fourth step.
"""

import importlib.util
import os
import sys

import numpy as np

if os.path.exists(os.path.join(os.path.dirname(os.path.abspath(__file__)), "stubborn_client.py")):
    import stubborn_client as client  # pyright: ignore[reportMissingImports]
else:  # in the repository
    ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    FILE = os.path.join(ROOT, "sim", "app", "bridges", "stubborn_client.py")
    SPEC = importlib.util.spec_from_file_location("stubborn_client", FILE)
    assert SPEC is not None and SPEC.loader is not None  # noqa: PT018
    client = importlib.util.module_from_spec(SPEC)
    SPEC.loader.exec_module(client)


class Wanderer:
    """Drives forward, and turns left where something is near or by chance."""

    def reset(self, goal, seed):
        self.goal, self.steps, self.rng = goal, 0, np.random.RandomState(seed)

    def act(self, observation):
        self.steps += 1
        if self.steps == 4 and sys.argv[1:] and not os.path.exists(sys.argv[1]):
            open(sys.argv[1], "w").close()
            sys.exit("The agent broke")
        if self.steps > 60:
            return client.STOP
        depth = observation["depth"]
        near_m = depth[len(depth) // 2].min()
        depth[:] = 0.0  # it is the agent's own
        return client.MOVE_FORWARD if near_m > 0.8 and self.rng.rand() < 0.8 else client.TURN_LEFT

    def stop_confidence(self):
        return np.float32(0.5)

    def stop_target_xy_m(self):
        return np.array([1.0, 0.5])

    def map_image(self):
        return np.full((40, 80, 3), (200, 120, self.steps), np.uint8)

    def state(self):
        return f"step {self.steps}"


if __name__ == "__main__":
    client.serve(lambda setup: Wanderer())
