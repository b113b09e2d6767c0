"""Runs a random agent and the Stubborn agent in the same episode of the Gymnasium environment.

python examples/gym_agents.py
"""

import gymnasium
from gymnasium.wrappers import RecordEpisodeStatistics

import stubborn
from sim import ObjectNavEnv
from stubborn import GroundTruthSegmenter


def run_episode(name: str, episode_id: str = "val_0011", max_steps: int = 500) -> dict:
    """Runs one episode with the agent of a name; returns the last `info`."""
    env = gymnasium.make("sim.gym:stubborn/ObjectNav-v0", sensors=("depth", "semantic"), max_steps=max_steps)
    world, env = env.unwrapped, RecordEpisodeStatistics(env)
    assert isinstance(world, ObjectNavEnv)
    agent = stubborn.make(name, camera=world.camera_model, robot=world.robot_model, segmenter=GroundTruthSegmenter())
    observation, info = env.reset(options={"episode_id": episode_id})
    agent.reset(info["goal"], seed=0)
    done = False
    while not done:
        observation, _, terminated, truncated, info = env.step(agent.act(observation))
        done = terminated or truncated
    env.close()
    return info


if __name__ == "__main__":
    for name in ("random", "stubborn"):
        info = run_episode(name)
        print(
            f"{name}: {info['goal']} {'found' if info['success'] else 'not found'} after {info['episode']['l']} steps, "
            f"{info['collisions']} collisions, SPL {info['spl']:.2f}"
        )
