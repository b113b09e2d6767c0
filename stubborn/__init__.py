"""The Stubborn agent (Luo et al. 2022), its ablations and baselines. Nothing here imports MuJoCo.

`stubborn` holds the names that users of the agents need. A name is imported from its module when it is first used, so
that `import stubborn` does not import torch.
"""

import lazy_loader

from sim.core.deprecation import moved_names

_get, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__getattr__ = moved_names(__name__, {"LabelledView": "sim", "ViewDataset": "sim"}, _get)
