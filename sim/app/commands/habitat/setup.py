"""Makes an environment with habitat-lab and habitat-baselines, in which both run on this project.

    stubborn habitat setup
    .venv-habitat/bin/python my_script.py

habitat-lab needs NumPy 1.26 and OpenCV 4, so it gets an environment of its own. `import habitat` finds this project's
`habitat_sim` there, in each process.
"""

from __future__ import annotations

import contextlib
import importlib.metadata
import json
import shutil
import subprocess
import sys
import time
import urllib.parse
import urllib.request
import venv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from sim.app.commands.habitat.script import FOLDER
from sim.core.errors import ConfigError

DISTRIBUTION = "stubborn-objectnav"
FIRST = ("setuptools==65.7.0", "wheel==0.38.4")
"""The last versions that can build gym 0.23, which habitat-lab needs and which has no wheel."""
GYM = "gym==0.23.0"
PINNED = (
    "setuptools>=77",
    "habitat-lab==0.3.320260507",
    "habitat-baselines==0.3.320260507",
    "numpy==1.26.4",
    "opencv-python==4.11.0.86",
    "opencv-python-headless==4.11.0.86",  # the same files, under the name that this project asks for
    "torch==2.13.0",
    "torchvision==0.28.0",
)
"""Versions that were tried together."""
STARTUP = "import sim.app.bridges.habitat_sim.finder as finder; finder.install()\n"
"""The line of the environment that provides `habitat_sim` in each process."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Make an environment with habitat-lab that runs on this project."""

    out: Path = FOLDER
    """Folder of the environment; it must not exist."""


def main(args: Args) -> int:
    """Makes the environment; returns the exit status."""
    begin = time.monotonic()
    python = args.out / "bin" / "python"
    with new_environment(args.out, "habitat-lab, habitat-baselines and this project; about two minutes and 2.5 GB."):
        install(args.out, *FIRST)
        install(args.out, "--no-build-isolation", GYM)
        install(args.out, *PINNED, *this_project())
        (packages,) = args.out.glob("lib/python*/site-packages")
        (packages / "stubborn_habitat_sim.pth").write_text(STARTUP)
        _call([str(python), "-m", "pip", "check"], "The packages do not fit together")
        _call([str(python), "-c", "import habitat"], "habitat-lab cannot be imported")
    print(f"Done in {time.monotonic() - begin:.0f} s: {python} SCRIPT runs scripts for Habitat (docs/habitat.md).")
    return 0


@contextlib.contextmanager
def new_environment(folder: Path, content: str) -> Iterator[None]:
    """Makes an empty environment, prints what it will hold, and removes it if what follows fails or is interrupted.

    Raises:
        ConfigError: the folder exists.
    """
    if folder.exists():
        raise ConfigError(f"'{folder}' exists: remove it, or name another folder with --out.")
    print(f"{folder}: {content}", flush=True)
    try:
        venv.create(folder, with_pip=True)
        yield
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def this_project() -> list[str]:
    """Returns what pip installs to get this project from where it was installed here.

    Raises:
        ConfigError: its place of origin is not known.
    """
    distribution = importlib.metadata.distribution(DISTRIBUTION)
    text = distribution.read_text("direct_url.json")
    if text is None:
        return [f"{DISTRIBUTION}=={distribution.version}"]
    origin = json.loads(text)
    return (
        ["--editable", urllib.request.url2pathname(urllib.parse.urlsplit(origin["url"]).path)]
        if origin.get("dir_info", {}).get("editable")
        else [f"{DISTRIBUTION} @ {origin['url']}"]
    )


def install(folder: Path, *what: str) -> None:
    """Installs packages in an environment; raises ConfigError with what pip printed if it fails."""
    _call(
        [str(folder / "bin" / "python"), "-m", "pip", "install", "--quiet", *what],
        f"pip could not install {' '.join(what)}",
    )


def _call(words: list[str], fault: str) -> None:
    """Runs a command; raises ConfigError with what it printed if it fails."""
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        print(done.stdout[-3000:], file=sys.stderr)
        raise ConfigError(f"{fault}.")
