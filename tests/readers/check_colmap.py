"""COLMAP's reader opens sparse/0 and agrees with transforms.json, sparse_pc.ply and the photos.

usage: check_colmap.py [--self-test] DIR_TRAINER
"""

import json
import re

import numpy as np
import pycolmap
from PIL import Image, ImageFilter

from expected import (
    Mismatch,
    edit_transforms,
    main,
    nudge_pose,
    read_ply,
    read_transforms,
    require,
    require_close,
    turn_camera,
)


def check(folder):
    transforms, poses = read_transforms(folder / "transforms.json")
    positions, colours = read_ply(folder / transforms["ply_file_path"])
    require(
        [path.name for path in folder.rglob("*.ply")] == [transforms["ply_file_path"]],
        "there is more than one .ply in the folder",
    )
    for kind in ("text", "binary"):
        model = read_model(folder / "sparse" / "0", kind)
        check_camera(model, transforms, kind)
        check_poses(model, poses, folder, kind)
        check_points(model, positions, colours, kind)
        print(
            f"colmap {kind}: {len(model.images)} images, {len(model.points3D)} points, poses to 1e-6"
        )
    check_silhouettes(model, folder)


def read_model(folder, kind):
    model = pycolmap.Reconstruction()
    read = model.read_text if kind == "text" else model.read_binary
    try:
        read(str(folder))
    except Exception as error:  # whatever a reader raises on foreign bytes
        raise Mismatch(f"colmap {kind}: the model does not open: {error}") from None
    return model


def check_camera(model, transforms, kind):
    require(len(model.cameras) == 1, f"colmap {kind}: {len(model.cameras)} cameras where 1 is due")
    camera = next(iter(model.cameras.values()))
    require(camera.model.name == "PINHOLE", f"colmap {kind}: camera model {camera.model.name}")
    require(
        (camera.width, camera.height) == (transforms["w"], transforms["h"]),
        f"colmap {kind}: the camera has {camera.width} x {camera.height} pixels",
    )
    due = [transforms[key] for key in ("fl_x", "fl_y", "cx", "cy")]
    require_close(camera.params, due, f"colmap {kind}: fx fy cx cy")


def check_poses(model, poses, folder, kind):
    require(
        model.num_reg_images() == len(poses),
        f"colmap {kind}: {model.num_reg_images()} images where {len(poses)} are due",
    )
    for image in model.images.values():
        path = (folder / "images" / image.name).resolve()
        require(path.is_file(), f"colmap {kind}: {image.name} is not among the images")
        require(path in poses, f"colmap {kind}: {image.name} is not in transforms.json")
        world_from_camera = image.cam_from_world().inverse().matrix()
        what = f"colmap {kind}: {image.name}"
        require_close(world_from_camera[:, :3], poses[path][:, :3], f"{what}: rotation")
        require_close(world_from_camera[:, 3], poses[path][:, 3], f"{what}: position")
        require(image.num_points2D() == 0, f"{what}: has features")


def check_points(model, positions, colours, kind):
    require(
        len(model.points3D) == len(positions),
        f"colmap {kind}: {len(model.points3D)} points where {len(positions)} are due",
    )
    require(len(positions) >= 100, f"colmap {kind}: fewer than 100 points")
    points = [model.points3D[key] for key in sorted(model.points3D.keys())]
    require_close([point.xyz for point in points], positions, f"colmap {kind}: points")
    require_close([point.color for point in points], colours, f"colmap {kind}: colours")


def check_silhouettes(model, folder):
    """Every point of the surface, seen or hidden, falls on the object in every photo.

    This is the one check that a convention wrong in all files alike would fail. It needs photos
    with a transparent background.
    """
    hits = total = 0
    camera = next(iter(model.cameras.values()))
    positions = np.array([point.xyz for point in model.points3D.values()])
    for image in model.images.values():
        with Image.open(folder / "images" / image.name) as photo:
            alpha = photo.convert("RGBA").getchannel("A")
        if alpha.getextrema()[0] == 255:
            print("colmap photos: opaque, so silhouettes were not compared")
            return
        # Two pixels wider: points are not pixel centres, and edges are antialiased.
        alpha = np.array(alpha.filter(ImageFilter.MaxFilter(5)))
        in_camera = image.cam_from_world() * positions
        require((in_camera[:, 2] > 0).all(), f"colmap photos: points behind {image.name}")
        pixels = np.floor(camera.img_from_cam(in_camera)).astype(int)
        size = [camera.width, camera.height]
        pixels = pixels[((pixels >= 0) & (pixels < size)).all(axis=1)]
        hits += int((alpha[pixels[:, 1], pixels[:, 0]] > 0).sum())
        total += len(pixels)
    require(
        total > 0 and hits >= 0.95 * total,
        f"colmap photos: only {hits} of {total} projected points fall on the object",
    )
    print(f"colmap photos: {hits} of {total} projected points fall on the object")


def edit_text(name, pattern, replacement):
    def fault(folder):
        path = folder / "sparse" / "0" / name
        text, count = re.subn(pattern, replacement, path.read_text(), count=1, flags=re.MULTILINE)
        assert count == 1, f"{name} has no {pattern}"
        path.write_text(text)

    return fault


def turn_everything(folder):
    """Turns every camera upside down, in all files alike, so that only the photos can tell."""
    model = read_model(folder / "sparse" / "0", "text")
    half_turn = pycolmap.Rigid3d(np.array([[-1.0, 0, 0, 0], [0, -1, 0, 0], [0, 0, 1, 0]]))
    for frame in model.frames.values():
        frame.rig_from_world = half_turn * frame.rig_from_world
    # Off the axis too, or a symmetric object would hide the turn.
    transforms = json.loads((folder / "transforms.json").read_text())
    for frame in transforms["frames"]:
        for row in frame["transform_matrix"][:3]:
            row[0], row[1] = -row[0], -row[1]
    camera = next(iter(model.cameras.values()))
    camera.params = [*camera.params[:2], camera.params[2] * 1.6, camera.params[3]]
    transforms["cx"] *= 1.6
    model.write_text(str(folder / "sparse" / "0"))
    model.write_binary(str(folder / "sparse" / "0"))
    (folder / "transforms.json").write_text(json.dumps(transforms))


FAULTS = [
    ("a camera moved by 2e-5", 0, edit_transforms("transforms.json", nudge_pose)),
    ("a camera of the other axes", 0, edit_transforms("transforms.json", turn_camera)),
    ("another focal length", 0, edit_transforms("transforms.json", lambda t: t.update(fl_y=9.0))),
    ("a frame left out", 0, edit_transforms("transforms.json", lambda t: t["frames"].pop())),
    ("a missing blank line", 0, edit_text("images.txt", r"^\n", "")),
    ("a renamed image", 0, edit_text("images.txt", "frame_00001", "frame_99999")),
    ("a missing point", 0, edit_text("points3D.txt", r"^1 .*\n", "")),
    ("a second .ply", 0, lambda folder: (folder / "mesh.ply").write_bytes(b"ply\n")),
    ("a missing model file", 0, lambda folder: (folder / "sparse/0/images.bin").unlink()),
    ("photos beside the object", 0, turn_everything),
]

if __name__ == "__main__":
    main(check, FAULTS, "DIR_TRAINER")
