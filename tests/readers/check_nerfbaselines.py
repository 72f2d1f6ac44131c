"""nerfbaselines' dataset loaders open both profiles and agree with the transforms files.

usage: check_nerfbaselines.py [--self-test] DIR_TRAINER DIR_SYNTHETIC
"""

import contextlib
import io
import json
import logging
from pathlib import Path

import numpy as np
from nerfbaselines.datasets import dataset_load_features, load_dataset
from nerfbaselines.datasets.nerfstudio import load_nerfstudio_dataset
from PIL import Image

from expected import (
    Mismatch,
    edit_transforms,
    main,
    nudge_pose,
    read_pixels,
    read_ply,
    read_transforms,
    require,
    require_close,
    turn_camera,
)

# The loaders hold poses and intrinsics as float32: distances of 4 round at 2.4e-7.
PIXEL_TOLERANCE = 1e-3


def check(trainer, synthetic):
    transforms, poses = read_transforms(trainer / "transforms.json")
    check_splits("colmap loader", load, trainer, transforms, poses)
    check_splits("nerfstudio loader", load_nerfstudio, trainer, transforms, poses)
    check_cloud(trainer, transforms)

    for split in ("train", "test"):
        transforms, poses = read_transforms(synthetic / f"transforms_{split}.json")
        seen = check_frames("blender loader", load(synthetic, split), transforms, poses)
        require(seen == set(poses), f"blender loader: {split} has {len(seen)} of {len(poses)} frames")
        print(f"blender loader: {len(seen)} {split} frames")
    read_transforms(synthetic / "transforms_val.json")
    _, test = read_transforms(synthetic / "transforms_test.json")
    _, train = read_transforms(synthetic / "transforms_train.json")
    require(not set(train) & set(test), "a frame is both in train and in test")


def load(folder, split, features=frozenset()):
    """As a user calls it: nb-info.json in the folder names the loader."""
    return opened(lambda: load_dataset(str(folder), split, features=features), folder, split)


def load_nerfstudio(folder, split):
    """The folder's other format, which nb-info.json does not name."""
    return opened(
        lambda: dataset_load_features(load_nerfstudio_dataset(str(folder), split)), folder, split
    )


def opened(read, folder, split):
    try:
        with contextlib.redirect_stderr(io.StringIO()):  # progress bars
            return read()
    except Exception as error:  # whatever a reader raises on foreign bytes
        raise Mismatch(f"{folder.name} does not open ({split}): {error}") from None


def check_splits(reader, read, folder, transforms, poses):
    """A loader that holds frames out by itself: each frame is in one split, none in both."""
    train = check_frames(reader, read(folder, "train"), transforms, poses)
    test = check_frames(reader, read(folder, "test"), transforms, poses)
    require(not train & test, f"{reader}: a frame is both in train and in test")
    require(train | test == set(poses), f"{reader}: {len(train | test)} of {len(poses)} frames")
    print(f"{reader}: {len(train)} train and {len(test)} test frames")


def check_frames(reader, dataset, transforms, poses):
    """Pose, intrinsics, size and pixels of each frame; returns the paths seen."""
    cameras = dataset["cameras"]
    due = [transforms[key] for key in ("fl_x", "fl_y", "cx", "cy")]
    if reader == "blender loader" and transforms["w"] != transforms["h"]:
        due[3] = due[2]  # it puts the principal point at w / 2 in both directions
    paths = [Path(path).resolve() for path in dataset["image_paths"]]
    for index, path in enumerate(paths):
        what = f"{reader}: {path.name}"
        require(path in poses, f"{what}: not in the transforms file")
        require_close(cameras.poses[index][:3, :3], poses[path][:, :3], f"{what}: rotation")
        require_close(cameras.poses[index][:3, 3], poses[path][:, 3], f"{what}: position")
        require_close(cameras.intrinsics[index], due, f"{what}: fx fy cx cy", PIXEL_TOLERANCE)
        size = [transforms["w"], transforms["h"]]
        require_close(cameras.image_sizes[index], size, f"{what}: size")
        distortion = cameras.distortion_parameters[index]
        require_close(distortion, np.zeros_like(distortion), f"{what}: distortion")
        pixels, expected = dataset["images"][index], read_pixels(path)
        require(expected.shape == (*size[::-1], 4), f"{what}: the PNG has shape {expected.shape}")
        require(np.array_equal(pixels, expected), f"{what}: pixels differ from the PNG's")
    return set(paths)


def check_cloud(folder, transforms):
    features = frozenset(("points3D_xyz", "points3D_rgb"))
    dataset = load(folder, "train", features)
    positions, colours = read_ply(folder / transforms["ply_file_path"])
    require_close(dataset["points3D_xyz"], positions, "colmap loader: points")
    require_close(dataset["points3D_rgb"], colours, "colmap loader: colours")
    print(f"colmap loader: {len(positions)} points")


def swap_photos(first, second):
    """Exchanges two file paths in a transforms file: each pose has another's photo."""

    def change(content):
        a, b = content["frames"][first], content["frames"][second]
        a["file_path"], b["file_path"] = b["file_path"], a["file_path"]

    return change


def shrink_photo(folder):
    path = folder / "images" / "frame_00001.png"
    with Image.open(path) as image:
        image.resize((8, 8)).save(path)


def flatten_photo(folder):
    path = folder / "train" / "r_0.png"
    with Image.open(path) as image:
        image.convert("RGB").save(path)


def leak(folder):
    """Puts a training frame among the test frames."""
    train = json.loads((folder / "transforms_train.json").read_text(encoding="utf-8"))
    edit_transforms("transforms_test.json", lambda t: t["frames"].append(train["frames"][0]))(folder)


# A fault in transforms.json is found because the loader of sparse/0 then disagrees with it; one in
# transforms_train.json because it is no rotation, or no file, or not the camera of the photos.
FAULTS = [
    ("a camera moved by 2e-5", 0, edit_transforms("transforms.json", nudge_pose)),
    ("a camera of the other axes", 0, edit_transforms("transforms.json", turn_camera)),
    ("two photos exchanged", 0, edit_transforms("transforms.json", swap_photos(0, 1))),
    ("another focal length", 0, edit_transforms("transforms.json", lambda t: t.update(fl_x=9.0))),
    ("a frame left out", 0, edit_transforms("transforms.json", lambda t: t["frames"].pop())),
    ("a photo of another size", 0, shrink_photo),
    ("no word on which loader", 0, lambda folder: (folder / "nb-info.json").unlink()),
    ("a photo without alpha", 1, flatten_photo),
    ("a missing photo", 1, lambda folder: (folder / "test/r_0.png").unlink()),
    ("another field of view", 1, edit_transforms(
        "transforms_train.json", lambda t: t.update(camera_angle_x=0.1))),
    ("a training frame in the test", 1, leak),
    ("no test frames", 1, edit_transforms("transforms_test.json", lambda t: t["frames"].clear())),
    ("no validation file", 1, lambda folder: (folder / "transforms_val.json").unlink()),
]

if __name__ == "__main__":
    logging.disable(logging.WARNING)
    main(check, FAULTS, "DIR_TRAINER DIR_SYNTHETIC")
