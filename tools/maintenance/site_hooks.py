"""Hooks of MkDocs (`mkdocs.yml`): rules of the built site, reported as warnings, which `--strict` turns into errors.

Links to files outside `docs/`, which work on GitHub, become paths of the repository. The pages load nothing from other
hosts, so that they work offline and no other host learns of the reader. Links to other hosts are allowed.
"""

from __future__ import annotations

import logging
import posixpath
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

_LOG = logging.getLogger("mkdocs.hooks.site")
_TAG = re.compile(r"<(script|link|img|iframe|source|video|audio|object|embed)\b[^>]*>", re.IGNORECASE)
_ADDRESS = re.compile(r"""\b(?:src|href|data|srcset|poster)\s*=\s*["']?((?:https?:)?//[^"'\s>]+)""", re.IGNORECASE)
_IN_STYLE = re.compile(r"""(?:url\(|@import)\s*["']?((?:https?:)?//[^"')\s]+)""", re.IGNORECASE)
_UPWARDS = re.compile(r"\[([^\]]+)\]\((\.\./[^)]+)\)")
_MERMAID = re.compile(r"""<(?:pre|div)[^>]*class=["'][^"']*\bmermaid\b""")


def fetched_from_elsewhere(page: str) -> Iterator[str]:
    """Yields the addresses on other hosts that a browser would fetch by itself for this text of HTML or CSS."""
    for tag in _TAG.finditer(page):
        if 'rel="canonical"' not in tag[0]:
            yield from (match[1] for match in _ADDRESS.finditer(tag[0]))
    yield from (match[1] for match in _IN_STYLE.finditer(page))
    if _MERMAID.search(page):
        yield "https://unpkg.com/mermaid (the theme's script draws class mermaid with it: use an SVG file)"


def without_links_outside(markdown: str, page: str) -> str:
    """Returns the text of a page, `tutorials/own_house.md`, with paths in place of links to files outside `docs/`."""

    def replaced(link: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(posixpath.dirname(page), link[2]))
        return f"{link[1]} (`{target.removeprefix('../')}`)" if target.startswith("../") else link[0]

    return _UPWARDS.sub(replaced, markdown)


def on_page_markdown(markdown: str, page: Any, **_: object) -> str:
    """Returns the text of a page for the site."""
    return without_links_outside(markdown, page.file.src_uri)


def on_post_build(config: Mapping[str, str]) -> None:
    """Logs a warning for every page that would load something from another host."""
    site = Path(config["site_dir"])
    for file in sorted([*site.rglob("*.html"), *site.rglob("*.css")]):
        for address in sorted(set(fetched_from_elsewhere(file.read_text(encoding="utf-8")))):
            _LOG.warning("%s would fetch %s", file.relative_to(site), address)
