"""`python -m stubborn` is the command `stubborn`; the commands belong to the simulator."""

import importlib

if __name__ == "__main__":
    raise SystemExit(importlib.import_module("sim.app.commands.main").entry())
