"""The Stubborn agent (Luo et al. 2022), its ablations and baselines. Nothing here imports MuJoCo.

`stubborn` holds the names that users of the agents need. A name is imported from its module when it is first used, so
that `import stubborn` does not import torch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stubborn.agent import AgentConfig
    from stubborn.agents import SPECS, make
    from stubborn.detection.verification import Verifier
    from stubborn.exploration.explorer import Exploration, Explorer, ExplorerConfig, Ground
    from stubborn.mapping.navmap import NavMap
    from stubborn.planning.planner import Goal, Route
    from stubborn.segmentation.dataset import LabelledView, ViewDataset
    from stubborn.segmentation.ground_truth import GroundTruthSegmenter
    from stubborn.segmentation.network import NetworkSegmenter

__all__ = [
    "SPECS",
    "AgentConfig",
    "Exploration",
    "Explorer",
    "ExplorerConfig",
    "Goal",
    "Ground",
    "GroundTruthSegmenter",
    "LabelledView",
    "NavMap",
    "NetworkSegmenter",
    "Route",
    "Verifier",
    "ViewDataset",
    "make",
]

_MODULE_OF = {
    "SPECS": "stubborn.agents",
    "AgentConfig": "stubborn.agent",
    "Exploration": "stubborn.exploration.explorer",
    "Explorer": "stubborn.exploration.explorer",
    "ExplorerConfig": "stubborn.exploration.explorer",
    "Goal": "stubborn.planning.planner",
    "Ground": "stubborn.exploration.explorer",
    "GroundTruthSegmenter": "stubborn.segmentation.ground_truth",
    "LabelledView": "stubborn.segmentation.dataset",
    "NavMap": "stubborn.mapping.navmap",
    "NetworkSegmenter": "stubborn.segmentation.network",
    "Route": "stubborn.planning.planner",
    "Verifier": "stubborn.detection.verification",
    "ViewDataset": "stubborn.segmentation.dataset",
    "make": "stubborn.agents",
}


if not TYPE_CHECKING:  # a type checker reports names that do not exist only without this function

    def __getattr__(name: str) -> Any:
        """Returns a name of `__all__` from its module, which is imported now."""
        if name not in _MODULE_OF:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib import import_module

        value = getattr(import_module(_MODULE_OF[name]), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """Returns the names of `__all__` and the names that are already imported."""
    return sorted({*globals(), *__all__})
