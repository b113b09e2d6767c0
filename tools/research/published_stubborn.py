"""The published code of the Stubborn agent, with true masks in place of its network: no weights, no verification.

Its repository is https://github.com/Improbable-AI/Stubborn. This file runs in the environment of that agent, in the
folder of its repository, and imports nothing of this project; `tools.research.compare_published` starts it:

    PYTHONPATH=Stubborn:FOLDER_OF_THIS_FILE python stubborn_client.py published_stubborn:WithTrueMasks

Its file `obj_id_data.pickle` must exist: without examples in it (an empty list), the agent accepts every candidate, as
this project's agent does with true masks.
"""

import numpy as np
import torch
from agent import agent_helper  # pyright: ignore[reportMissingImports]
from agent.stubborn_agent import StubbornAgent  # pyright: ignore[reportMissingImports]
from arguments import get_args  # pyright: ignore[reportMissingImports]

CATEGORIES = 40
"""Number of the categories of mpcat40 without void."""
SURE = 10.0
"""Score of the true category of a pixel; the agent multiplies scores by 0.1."""


class TrueMasks(agent_helper.QuickSemanticPredRedNet):
    """The agent's segmentation, whose network is replaced by a function of the true labels."""

    def __init__(self, args: object) -> None:
        self.args = args
        self.threshold = 0.7  # as in the class that this one replaces
        self.gt_mask = None
        self.labels = np.zeros((1, 1), np.int32)
        """mpcat40 ids of the current image, (h, w)."""

    def segmentation_model(self, *_: object) -> tuple[torch.Tensor, None]:
        """Returns the scores of the categories, float32 (1, 40, h, w), and None in place of the labels."""
        scores = np.zeros((1 + CATEGORIES, *self.labels.shape), np.float32)
        np.put_along_axis(scores, self.labels[None].astype(np.int64), SURE, axis=0)
        return torch.from_numpy(scores[None, 1:]), None


class WithTrueMasks(StubbornAgent):
    """The agent with the observation `semantic` in place of its network.

    Args:
        task_config: configuration of the run.
        timestep_limit: the agent stops after this many steps without a goal; the published command has 451.
    """

    def __init__(self, task_config: object, timestep_limit: int = 451) -> None:
        agent_helper.QuickSemanticPredRedNet = TrueMasks
        args = get_args()
        args.timestep_limit = timestep_limit
        StubbornAgent.__init__(self, args, task_config)

    def act(self, observations: dict[str, np.ndarray]) -> object:
        """Returns the agent's action."""
        self.agent_helper.sem_pred_rednet.labels = observations["semantic"][:, :, 0]
        return StubbornAgent.act(self, observations)
