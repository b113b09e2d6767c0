"""What a style is, and the few words by which rooms ask for furniture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from sim.housegen.furniture.item import Mount, Pool
from sim.housegen.furniture.workbench import Workbench


@dataclass(frozen=True)
class Style:
    """One structure that items of a category can have; its sizes and looks are drawn when it is built."""

    category: str
    name: str
    """Unique within the category."""
    pool: Pool
    """The pool it belongs to, the only one that ever shows it; but `wide` shows train's too."""
    build: Callable[[Workbench], None]
    uses: tuple[str, ...] = ()
    """What hint `use` may ask for."""
    mount: Mount = "floor"
    walk_over: bool = False

    def shown_in(self, pool: Pool) -> bool:
        """Whether houses of this pool may have it."""
        return self.pool == pool or (pool == "wide" and self.pool == "train")


HINTS: frozenset[str] = frozenset(
    {"use", "width_m", "depth_m", "height_m", "looks", "with_sink", "with_hob", "cushions"}
)
"""Every hint that `make_item` knows."""
