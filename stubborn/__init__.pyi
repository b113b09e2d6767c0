"""The names of `stubborn` and their modules, for type checkers and for `lazy_loader`."""

from .agent import AgentConfig as AgentConfig
from .agents import SPECS as SPECS
from .agents import make as make
from .detection.verification import Verifier as Verifier
from .exploration.explorer import Exploration as Exploration
from .exploration.explorer import Explorer as Explorer
from .exploration.explorer import ExplorerConfig as ExplorerConfig
from .exploration.explorer import Ground as Ground
from .mapping.navmap import NavMap as NavMap
from .planning.planner import Goal as Goal
from .planning.planner import Route as Route
from .segmentation.ground_truth import GroundTruthSegmenter as GroundTruthSegmenter
from .segmentation.network import NetworkSegmenter as NetworkSegmenter

__all__ = [
    "SPECS",
    "AgentConfig",
    "Exploration",
    "Explorer",
    "ExplorerConfig",
    "Goal",
    "Ground",
    "GroundTruthSegmenter",
    "NavMap",
    "NetworkSegmenter",
    "Route",
    "Verifier",
    "make",
]
