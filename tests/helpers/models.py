"""Small OBJ models for tests of the import: boxes, in folders with a table and in catalogues of Sweet Home 3D."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

Box = tuple[float, float, float, float, float, float]
"""Lowest x, y, z, then highest, in the axes of OBJ files: y is up, and z points to the front."""

CHAIR: Mapping[str, Sequence[Box]] = {
    "wood": [(x, 0, z, x + 4, 45, z + 4) for x in (-25, 21) for z in (-25, 21)],
    "cloth": [(-25, 45, -25, 25, 50, 25), (-25, 50, -25, 25, 100, -20)],
}
"""A chair of 0.5 m x 0.5 m x 1 m in centimetres; its back is at the smallest z."""
TABLE: Mapping[str, Sequence[Box]] = {
    "wood": [
        *((x, 0, z, x + 0.05, 0.7, z + 0.05) for x in (-0.7, 0.65) for z in (-0.4, 0.35)),
        (-0.7, 0.7, -0.4, 0.7, 0.74, 0.4),
    ]
}
"""A table of 1.4 m x 0.8 m in metres."""
MATERIALS = "newmtl wood\nKd 0.6 0.4 0.2\nnewmtl cloth\nKd 0.1 0.2 0.8\n"
_FACES = ((1, 4, 3, 2), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8))
LICENCE = "CC0 -- of a test"


def obj_text(parts: Mapping[str, Sequence[Box]]) -> str:
    """Returns the text of an OBJ file with boxes by material."""
    lines, count = ["mtllib model.mtl"], 0
    for material, boxes in parts.items():
        lines.append(f"usemtl {material}")
        for x0, y0, z0, x1, y1, z1 in boxes:
            corners = [(x, y, z) for z in (z0, z1) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
            lines += [f"v {x} {y} {z}" for x, y, z in corners]
            lines += ["f " + " ".join(str(count + n) for n in face) for face in _FACES]
            count += 8
    return "\n".join(lines) + "\n"


def write_folder(folder: Path, chairs: int = 1) -> Path:
    """Writes a folder with chairs, a dining table and a list of them for `stubborn import furniture`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.mtl").write_text(MATERIALS)
    rows = ["file,category,uses,width_m,depth_m,height_m,front_deg,license,author,mount"]
    for n in range(chairs):
        (folder / f"chair{n}.obj").write_text(obj_text(CHAIR))
        rows.append(f"chair{n}.obj,chair,dining,0.5,0.5,{0.9 + 0.01 * n},0,{LICENCE},Somebody,floor")
    (folder / "table.obj").write_text(obj_text(TABLE))
    rows.append(f"table.obj,table,dining desk,1.4,0.8,0.74,0,{LICENCE},Somebody,floor")
    (folder / "models.csv").write_text("\n".join(rows) + "\n")
    return folder


def write_catalogue(file: Path, entries: Sequence[Mapping[str, str]], files: Mapping[str, str]) -> Path:
    """Writes a catalogue of Sweet Home 3D with these properties of its models and these files."""
    lines = ["name=Test", f"license={LICENCE}"]
    for n, entry in enumerate(entries, start=1):
        lines += [f"{key}#{n}={value}" for key, value in entry.items()]
    file.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("PluginFurnitureCatalog.properties", "\n".join(lines) + "\n")
        for name, text in files.items():
            archive.writestr(name, text)
    return file


def properties(ident: str, model: str, **others: str) -> dict[str, str]:
    """Returns the properties of a chair's entry; the given ones are added or replace others."""
    usual = {"id": f"Test#{ident}", "name": "Chair", "category": "Living room", "model": model, "creator": "Somebody"}
    return usual | {"width": "50", "depth": "50", "height": "100"} | others
