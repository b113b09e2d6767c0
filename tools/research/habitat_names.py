"""Counts which names of habitat-lab and habitat-sim that a repository imports can be imported here.

    .venv-habitat/bin/python -m tools.research.habitat_names CHECKOUT [CHECKOUT ...] --out published_names.csv

A name of habitat-sim that can be named but does nothing here (`sim.app.bridges.habitat_sim.finder`) counts as missing.
Names of older versions of habitat-lab count where `stubborn habitat` provides them. Copies of habitat-lab inside a
checkout are not looked at.
"""

from __future__ import annotations

import ast
import importlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim.app import cli
from sim.app.bridges.habitat_sim.finder import NotHere, is_placeholder
from sim.core.files import csv_text, write_atomically

COPIES = ("habitat-lab", "habitat_lab", "habitat-baselines", "habitat_baselines")
"""Folders of checkouts that hold a copy of habitat-lab."""
PACKAGES = ("habitat", "habitat_baselines", "habitat_sim", "magnum")


@dataclass(frozen=True)
class Args:
    """Count which names of habitat-lab and habitat-sim that repositories import can be imported here."""

    checkouts: tyro.conf.Positional[tuple[Path, ...]]
    """Folders of repositories."""
    out: cli.OutFile = Path("published_names.csv")
    """The table."""


def main(args: Args) -> int:
    """Prints and writes a row for each checkout; returns the exit status."""
    import stubborn_habitat  # provides habitat_sim to this process
    from sim.app.bridges.habitat_sim import legacy  # needs habitat-lab

    print(stubborn_habitat.configure())
    legacy.install()
    rows = []
    for checkout in args.checkouts:
        own = [file for file in checkout.rglob("*.py") if not any(part in COPIES for part in file.parts)]
        names = sorted({name for file in own for name in _imports(file)})
        missing = [name for name in names if not _is_there(name)]
        row: dict[str, object] = {"repository": checkout.name}
        for package in ("habitat", "habitat_baselines", "habitat_sim"):
            here = [name for name in names if name.split(".")[0] == package]
            row[package] = f"{sum(name not in missing for name in here)}/{len(here)}"
        row["missing"] = " ".join(missing)
        rows.append(row)
        print(row)
    write_atomically(args.out, csv_text(list(rows[0]), (row.values() for row in rows)))
    return 0


def _imports(file: Path) -> Iterator[str]:
    """Yields the names `package.module.name` that a file imports from these packages, and attributes of habitat_sim."""
    try:
        tree = ast.parse(file.read_text(errors="replace"))
    except SyntaxError:
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.split(".")[0] in PACKAGES)
        elif isinstance(node, ast.ImportFrom) and not node.level and (node.module or "").split(".")[0] in PACKAGES:
            yield from (f"{node.module}.{alias.name}" for alias in node.names if alias.name != "*")
        elif isinstance(node, ast.Attribute):
            name = ast.unparse(node)
            if name.startswith("habitat_sim.") and name.replace(".", "").replace("_", "").isalnum():
                yield name


def _is_there(name: str) -> bool:
    """Returns whether a module, or a name in one, can be imported and is more than a placeholder."""
    parts = name.split(".")
    for cut in range(len(parts), 0, -1):
        try:
            found: object = importlib.import_module(".".join(parts[:cut]))
        except ImportError:
            continue
        except Exception:  # a module that cannot be loaded here
            return False
        if is_placeholder(found) and cut > 1:
            continue
        try:
            for part in parts[cut:]:
                found = getattr(found, part)
        except (AttributeError, NotImplementedError):
            return False
        return not isinstance(found, NotHere) and not is_placeholder(found)
    return False


if __name__ == "__main__":
    raise SystemExit(cli.run(Args, main))
