"""`python -m sim.cli` is the command `stubborn`."""

from sim.app.commands.main import entry

__all__ = ["entry"]

if __name__ == "__main__":
    raise SystemExit(entry())
