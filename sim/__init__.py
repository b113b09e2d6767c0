"""The world: procedural apartments, a wheeled robot with contacts, cameras, the ObjectNav task and its runner.

`sim` names what users of the simulator need. A name is imported from its module when it is first used, so that
`import sim` imports neither MuJoCo nor Gymnasium nor torch. `import sim.gym` registers the Gymnasium environment.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
