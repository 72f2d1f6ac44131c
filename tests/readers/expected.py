"""What the files of an export say, read plainly, and the words for a difference.

Poses are `world_from_camera` with OpenCV camera axes (+X right, +Y down, +Z ahead), shape (3, 4),
in which both readers speak. `transforms.json` has OpenGL axes: y and z are turned round here.
"""

import contextlib
import io
import json
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

TOLERANCE = 1e-6


class Mismatch(Exception):
    """A reader understood something else than the export says."""


def require(condition, words):
    if not condition:
        raise Mismatch(words)


def require_close(got, expected, what, tolerance=TOLERANCE):
    got, expected = np.asarray(got, dtype=np.float64), np.asarray(expected, dtype=np.float64)
    require(got.shape == expected.shape, f"{what}: shape {got.shape} where {expected.shape} is due")
    error = float(np.abs(got - expected).max(initial=0.0))
    # Written this way round, NaN fails.
    require(error <= tolerance, f"{what}: off by {error:.3g}, allowed {tolerance:.3g}")


def read_transforms(path):
    """One transforms file: its dictionary, and {absolute image path: pose}."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise Mismatch(f"{path.name} is missing") from None
    poses = {}
    for frame in content["frames"]:
        image = (path.parent / frame["file_path"]).resolve()
        if not image.suffix:
            image = image.with_name(image.name + ".png")
        pose = np.array(frame["transform_matrix"], dtype=np.float64)
        require_close(pose[3], [0, 0, 0, 1], f"{path.name}: last row of {frame['file_path']}")
        require_close(pose[:3, :3].T @ pose[:3, :3], np.eye(3), f"{path.name}: rotation")
        require_close(np.linalg.det(pose[:3, :3]), 1.0, f"{path.name}: handedness")
        require(image not in poses, f"{path.name}: {frame['file_path']} is listed twice")
        poses[image] = pose[:3] * [1.0, -1.0, -1.0, 1.0]
    require(poses, f"{path.name} lists no frames")
    return content, poses


def read_pixels(path):
    """Shape (height, width, channels), uint8."""
    from PIL import Image  # only the readers of photos have it

    with Image.open(path) as image:
        return np.array(image)


def read_ply(path):
    """Positions (n, 3) and colours (n, 3) of the one kind of PLY that the export writes."""
    data = path.read_bytes()
    header, _, body = data.partition(b"end_header\n")
    count = next(
        int(line.split()[-1]) for line in header.splitlines() if line.startswith(b"element vertex")
    )
    row = np.dtype([("xyz", "<f4", 3), ("rgb", "u1", 3)])
    require(len(body) == count * row.itemsize, f"{path.name}: {count} points, {len(body)} bytes")
    rows = np.frombuffer(body, row)
    return rows["xyz"].astype(np.float64), rows["rgb"]


def edit_transforms(name, change):
    """A fault for `main`: applies `change` to the dictionary of a transforms file."""

    def fault(folder):
        path = folder / name
        content = json.loads(path.read_text(encoding="utf-8"))
        change(content)
        path.write_text(json.dumps(content), encoding="utf-8")

    return fault


def nudge_pose(content):
    content["frames"][-1]["transform_matrix"][1][3] += 2e-5


def turn_camera(content):
    """Two axes swapped in sign: still a rotation, of another convention."""
    for row in content["frames"][0]["transform_matrix"][:3]:
        row[1], row[2] = -row[1], -row[2]


def main(check, faults, usage):
    """Runs `check(*folders)`; with --self-test also on copies with one fault each.

    `faults`: rows of (words, position of the folder among the arguments, function of the copy).
    """
    arguments = [argument for argument in sys.argv[1:] if argument != "--self-test"]
    if len(arguments) != len(usage.split()):
        sys.exit(f"usage: {Path(sys.argv[0]).name} [--self-test] {usage}")
    folders = [Path(argument).resolve() for argument in arguments]
    try:
        check(*folders)
        if "--self-test" in sys.argv:
            for words, position, break_it in faults:
                found = find_fault(check, folders, position, break_it)
                require(found, f"self-test: {words} went unnoticed")
                print(f"self-test: {words} -> {found}")
    except Mismatch as mismatch:
        sys.exit(f"FAILED {mismatch}")
    print("ok")


def find_fault(check, folders, position, break_it):
    with tempfile.TemporaryDirectory() as home:
        copy = Path(home).resolve() / folders[position].name
        shutil.copytree(folders[position], copy)
        break_it(copy)
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                check(*(copy if i == position else folder for i, folder in enumerate(folders)))
        except Mismatch as mismatch:
            return str(mismatch)
    return None
