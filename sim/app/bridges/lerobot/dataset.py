"""The files of a LeRobot dataset in format v3 (https://huggingface.co/docs/lerobot/lerobot-dataset-v3).

Each episode has a file of its own for its rows, for its video, and for its entry in `meta/episodes`, which is written
last: an export that was stopped goes on after the last complete episode. `finish` writes what concerns all episodes.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import av
import numpy as np
from numpy.typing import NDArray

from sim.app.bridges.lerobot.features import ACTION, FPS, GOAL, IMAGE, STATE, VECTORS, goal_of, picture_of, vector_of
from sim.app.bridges.lerobot.replays import Frame
from sim.app.viewers.video import VideoWriter
from sim.core.errors import ConfigError
from sim.core.files import write_atomically

VERSION = "v3.0"
CHUNK = 1000
"""Files in a folder."""
DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
VIDEO = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
EPISODES = "meta/episodes/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
QUANTILES = (0.01, 0.10, 0.50, 0.90, 0.99)
SCALARS: Mapping[str, str] = {
    "next.reward": "float32", "next.done": "bool", "next.success": "bool", "timestamp": "float32",
    "frame_index": "int64", "episode_index": "int64", "index": "int64", "task_index": "int64",
}  # fmt: skip
"""Columns with one number a row, and their types."""
KEYFRAME_EVERY = 4
"""Frames are read in any order; between key frames, those before them are decoded too."""
_PIXELS = slice(None, None, 4)
"""Every fourth row and column of a picture counts in the statistics."""


def require_pyarrow() -> None:
    """Raises ConfigError if the package that writes Parquet files is not installed."""
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        raise ConfigError("LeRobot datasets need pyarrow: pip install 'stubborn-objectnav[lerobot]'.") from None


class DatasetWriter:
    """Writes a dataset.

    Args:
        folder: of the dataset.
        width_px: of the pictures.

    Raises:
        ConfigError: pyarrow is not installed.
    """

    def __init__(self, folder: Path, width_px: int) -> None:
        require_pyarrow()
        self._folder, self._width_px = folder, width_px

    def has(self, number: int) -> bool:
        """Returns whether an episode is complete."""
        return self._file(EPISODES, number).is_file()

    def length_of(self, number: int) -> int:
        """Returns the number of rows of a complete episode."""
        return int(self._entry(number)["length"])

    def add(self, number: int, goal: str, task: str, task_index: int, first_row: int, frames: Iterable[Frame]) -> int:
        """Writes an episode and returns its number of rows; nothing is complete if `frames` raises an error.

        Args:
            number: of the episode, from 0.
            goal: a category, or words.
            task: the goal as text.
            task_index: number of the text.
            first_row: rows of all episodes before it.
            frames: of the episode.
        """
        import pyarrow as pa

        video = None
        rows: dict[str, list[Any]] = {name: [] for name in (STATE, GOAL, ACTION, *SCALARS)}
        thumbnails = []
        try:
            for i, frame in enumerate(frames):
                picture = picture_of(frame.rgb, self._width_px)
                if video is None:
                    size = picture.shape[1], picture.shape[0]
                    file = self._file(VIDEO, number)
                    video = VideoWriter(file, size_px=size, frames_per_s=FPS, keyframe_every=KEYFRAME_EVERY)
                video.write(picture)
                thumbnails.append(picture[_PIXELS, _PIXELS])
                values = (frame.state, goal_of(goal), vector_of(frame.action))
                numbers = (frame.reward, frame.is_last, frame.reward > 0, i / FPS, i, number, first_row + i, task_index)
                for name, value in zip(rows, (*values, *numbers), strict=True):
                    rows[name].append(value)
        except BaseException:
            if video is not None:
                video.discard()
            raise
        if video is None:
            raise ConfigError(f"Episode {number} has no actions.")
        video.finish()
        count = len(thumbnails)
        columns = {name: np.array(values, SCALARS.get(name, "float32")) for name, values in rows.items()}
        arrays = {}
        for name, column in columns.items():
            flat = pa.array(column.reshape(-1))
            arrays[name] = flat if column.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, column.shape[1])
        _write_parquet(self._file(DATA, number), pa.table(arrays))
        stats = {name: stats_of(column) for name, column in columns.items()} | {IMAGE: image_stats(thumbnails)}
        place = {"chunk_index": number // CHUNK, "file_index": number % CHUNK}
        entry: dict[str, Any] = {"episode_index": number, "tasks": [task], "length": count}
        entry |= {f"data/{name}": value for name, value in place.items()}
        entry |= {"dataset_from_index": first_row, "dataset_to_index": first_row + count}
        entry |= {f"videos/{IMAGE}/{name}": value for name, value in place.items()}
        entry |= {f"videos/{IMAGE}/from_timestamp": 0.0, f"videos/{IMAGE}/to_timestamp": count / FPS}
        entry |= {f"stats/{name}/{key}": value for name, of in stats.items() for key, value in of.items()}
        entry |= {f"meta/episodes/{name}": value for name, value in place.items()}
        _write_parquet(self._file(EPISODES, number), pa.Table.from_pylist([entry]))
        return count

    def finish(self, count: int, tasks: Sequence[str], picture: tuple[int, int], robot: str) -> None:
        """Writes what concerns all episodes: `meta/info.json`, `meta/stats.json` and `meta/tasks.parquet`.

        Args:
            count: number of episodes; all are complete.
            tasks: the texts by their number.
            picture: rows and columns of the pictures.
            robot: type of the robot.
        """
        entries = [self._entry(number) for number in range(count)]
        features: dict[str, Any] = {
            IMAGE: {
                "dtype": "video",
                "shape": [*picture, 3],
                "names": ["height", "width", "channels"],
                "info": {
                    "video.height": picture[0], "video.width": picture[1], "video.codec": self._codec(),
                    "video.pix_fmt": "yuv420p", "video.is_depth_map": False, "video.fps": FPS, "video.channels": 3,
                    "has_audio": False,
                },
            }
        }  # fmt: skip
        for name, entry_names in VECTORS.items():
            features[name] = {"dtype": "float32", "shape": [len(entry_names)], "names": list(entry_names)}
        features |= {name: {"dtype": kind, "shape": [1], "names": None} for name, kind in SCALARS.items()}
        info = {
            "codebase_version": VERSION, "robot_type": robot, "total_episodes": count,
            "total_frames": sum(int(entry["length"]) for entry in entries), "total_tasks": len(tasks),
            "chunks_size": CHUNK, "data_files_size_in_mb": 100, "video_files_size_in_mb": 200, "fps": FPS,
            "splits": {"train": f"0:{count}"}, "data_path": DATA, "video_path": VIDEO, "features": features,
        }  # fmt: skip
        self._write_tasks(tasks)
        stats = {name: joined_stats([_stats_in(entry, name) for entry in entries]) for name in features}
        for name, content in (("stats", stats), ("info", info)):
            write_atomically(self._folder / "meta" / f"{name}.json", json.dumps(content, indent=4) + "\n")

    def _codec(self) -> str:
        """Returns the codec of the first video, such as `h264`; which one is written depends on PyAV."""
        with av.open(str(self._file(VIDEO, 0))) as video:
            return video.streams.video[0].codec.canonical_name

    def _file(self, pattern: str, number: int) -> Path:
        place = {"chunk_index": number // CHUNK, "file_index": number % CHUNK, "video_key": IMAGE}
        return self._folder / pattern.format(**place)

    def _entry(self, number: int) -> dict[str, Any]:
        import pyarrow.parquet as parquet

        return parquet.read_table(self._file(EPISODES, number)).to_pylist()[0]

    def _write_tasks(self, tasks: Sequence[str]) -> None:
        """Writes the texts as the index of a table of pandas, which LeRobot reads."""
        import pyarrow as pa

        index = "__index_level_0__"
        columns = [
            {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64"},
            {"name": None, "field_name": index, "pandas_type": "unicode", "numpy_type": "object"},
        ]
        about = {
            "index_columns": [index],
            "column_indexes": [],
            "columns": [one | {"metadata": None} for one in columns],
        }
        table = pa.table({"task_index": np.arange(len(tasks)), index: list(tasks)})
        table = table.replace_schema_metadata({"pandas": json.dumps(about | {"pandas_version": "2.0.0"})})
        _write_parquet(self._folder / "meta" / "tasks.parquet", table)


def stats_of(column: NDArray) -> dict[str, Any]:
    """Returns the statistics of a column (n, ...) over its rows, as lists."""
    values = column.astype(np.float64).reshape(len(column), -1)
    named = {
        "min": values.min(axis=0),
        "max": values.max(axis=0),
        "mean": values.mean(axis=0),
        "std": values.std(axis=0),
    }
    quantiles = np.quantile(values, QUANTILES, axis=0)
    named |= {f"q{round(100 * share):02d}": row for share, row in zip(QUANTILES, quantiles, strict=True)}
    return {name: value.tolist() for name, value in named.items()} | {"count": [len(column)]}


def image_stats(pictures: Sequence[NDArray[np.uint8]]) -> dict[str, Any]:
    """Returns the statistics of pictures (h, w, 3) by channel, in [0, 1] and of shape (3, 1, 1); count: pictures."""
    pixels = np.concatenate([picture.reshape(-1, 3) for picture in pictures]) / 255.0
    stats = {name: np.reshape(value, (3, 1, 1)).tolist() for name, value in stats_of(pixels).items() if name != "count"}
    return stats | {"count": [len(pictures)]}


def joined_stats(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Returns the statistics of several episodes; quantiles are weighted means, as LeRobot computes them."""
    count = np.array([part["count"][0] for part in parts], np.float64)
    arrays = {name: np.array([part[name] for part in parts], np.float64) for name in parts[0] if name != "count"}
    weighted = {name: np.tensordot(count, values, 1) / count.sum() for name, values in arrays.items()}
    variance = np.tensordot(count, arrays["std"] ** 2 + (arrays["mean"] - weighted["mean"]) ** 2, 1) / count.sum()
    weighted |= {"min": arrays["min"].min(axis=0), "max": arrays["max"].max(axis=0), "std": np.sqrt(variance)}
    return {name: value.tolist() for name, value in weighted.items()} | {"count": [int(count.sum())]}


def _stats_in(entry: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Returns the statistics of a feature in the entry of an episode."""
    start = f"stats/{name}/"
    return {key.removeprefix(start): value for key, value in entry.items() if key.startswith(start)}


def _write_parquet(file: Path, table: Any) -> None:
    import pyarrow as pa
    import pyarrow.parquet as parquet

    stream = pa.BufferOutputStream()
    parquet.write_table(table, stream)
    file.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(file, stream.getvalue().to_pybytes())
