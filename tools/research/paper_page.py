"""Makes docs/tables/paper.md from the archive of result lines: the tables of the paper, its figures beside ours."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from sim.app.commands.reproduce.paper_tables import PAPER_TABLES, table_named
from sim.app.commands.reproduce.reproduce import Args, episodes_of, make_table
from sim.core.errors import ConfigError
from tools.research.result_archive import ARCHIVE

PAPER = "paper.md"
EPISODES = 200
"""The first episodes of val, as far as all runs of a table have them."""
ABOUT = f"""\
# The paper's tables

Columns that begin with *paper* are of Luo et al. (2022), from MP3D houses in Habitat; all others are measured here, in
generated houses with contacts. Compare orders and differences of agents, not the figures. `gt` is ground-truth
segmentation, `rednet` the network that ships. `cloned`, a small end-to-end agent, stands beside the paper's EEAux
and is not that agent.

`stubborn reproduce all --episodes 200 --workers 2` runs all of it again, and resumes; each table states its hours. This
page is made from the [result lines]({ARCHIVE.name}) by `python -m tools.research.result_tables`.

"""


def paper_page(folder: Path) -> str:
    """Returns the page.

    Args:
        folder: the unpacked archive; it receives the tables too.

    Raises:
        ConfigError: a run is missing.
    """
    part = episodes_of(Args(table="all", episodes=EPISODES, minutes=0.0, out=folder))
    pages: list[str] = []
    for name in PAPER_TABLES:
        page = make_table(part, name, table_named(name).setups(), Console(quiet=True))
        if page is None:
            raise ConfigError(f"'{ARCHIVE.name}' lacks a run of the paper's table '{name}'.")
        pages.append(page)
    return ABOUT + "\n".join(pages)
