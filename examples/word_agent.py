"""`my_agent.py` for goals in words: `stubborn run --agent examples.word_agent:AGENT --split words-seen`."""

from dataclasses import replace

from examples import my_agent
from examples.my_agent import Wanderer, WandererConfig
from sim import CameraModel, RobotModel, Segmenter
from stubborn.detection.wished import WishedSegmenter


class WordWanderer(Wanderer):
    """Stops when objects that the words may mean fill the view."""

    def __init__(self, segmenter: Segmenter, camera: CameraModel, config: WandererConfig) -> None:
        self.wished = WishedSegmenter(segmenter, camera)
        super().__init__(self.wished, config)

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode; `goal` is a category or words."""
        self.wished.ask(goal)
        super().reset(self.wished.category, seed)  # scores of this category are now those of the goal


def make(
    *, camera: CameraModel, robot: RobotModel, segmenter: Segmenter, config: WandererConfig | None, **others: object
) -> WordWanderer:
    """Returns the agent."""
    return WordWanderer(segmenter, camera, config or WandererConfig())


AGENT = replace(my_agent.AGENT, make=make, description="drives at random, for goals in words", words=("rgb",))
