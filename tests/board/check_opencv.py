"""OpenCV sees the same tags as vantage-board, and neither corners nor poses better.

usage: check_opencv.py [--self-test] FILM.y4m OUT

`FILM.json` is the truth that the example `fake_camera` wrote, `OUT` what `track_film` made of the
film. Pixels: ours are from the frame's corner, OpenCV's from the first pixel's centre.
"""

import contextlib
import copy
import io
import json
import re
import sys
from pathlib import Path

import cv2
import numpy as np

import write_codes

HALF_PIXEL = 0.5


class Mismatch(Exception):
    """Something is not as it must be."""


def require(condition, words):
    if not condition:
        raise Mismatch(words)


def read_film(path, truth):
    """Luma of every frame, 0 to 255."""
    data = np.fromfile(path, np.uint8)
    start = bytes(data[:200]).index(b"\n") + 1
    width, height = truth["width"], truth["height"]
    frames = data[start:].reshape(-1, len(b"FRAME\n") + width * height * 3 // 2)
    luma = frames[:, 6 : 6 + width * height].astype(np.float32)
    luma = np.clip(np.round((luma - 16) * 255 / 219), 0, 255).astype(np.uint8)
    return luma.reshape(-1, height, width)


def corners_on_board(board, tag):
    """Clockwise from the tag's upper left corner, z = 0."""
    size, pitch = board["tagSizeM"], board["tagSizeM"] + board["gapM"]
    row, column = divmod(tag - board["firstId"], board["columns"])
    x = column * pitch - 0.5 * (board["columns"] * pitch - board["gapM"])
    y = 0.5 * (board["rows"] * pitch - board["gapM"]) - row * pitch
    return np.array([[x, y, 0], [x + size, y, 0], [x + size, y - size, 0], [x, y - size, 0]])


def project(truth, pose, tag):
    """Where the corners of a tag fall, pixels."""
    x, y, z = ((corners_on_board(truth["board"], tag) - pose[:, 3]) @ pose[:, :3]).T
    focal = truth["focalPx"]
    return np.stack([truth["cx"] - focal * x / z, truth["cy"] + focal * y / z], axis=1)


def detector():
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    return cv2.aruco.ArucoDetector(family, parameters)


def opencv_tags(found, luma):
    corners, ids, _ = found.detectMarkers(luma)
    if ids is None:
        return {}
    return {int(i): c.reshape(4, 2) + HALF_PIXEL for i, c in zip(ids.flatten(), corners)}


def opencv_pose(tags, truth):
    """world_from_camera with OpenGL's camera axes, shape (3, 4)."""
    points = np.concatenate([corners_on_board(truth["board"], tag) for tag in tags])
    pixels = np.concatenate(list(tags.values()))
    focal = truth["focalPx"]
    camera = np.array([[focal, 0, truth["cx"]], [0, focal, truth["cy"]], [0, 0, 1.0]])
    _, turn, move = cv2.solvePnP(points, pixels, camera, None, flags=cv2.SOLVEPNP_IPPE)
    turn, move = cv2.solvePnPRefineLM(points, pixels, camera, None, turn, move)
    rotation = cv2.Rodrigues(turn)[0].T
    return np.hstack([rotation * [1, -1, -1], -rotation @ move])


def pose_error(pose, true):
    """Degrees, and the distance between the places as a share of that from the board."""
    turn = pose[:, :3] @ true[:, :3].T
    # For a rotation by a small angle the sine says more than the cosine.
    sine = 0.5 * np.linalg.norm([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    angle = np.degrees(np.arctan2(sine, 0.5 * (np.trace(turn) - 1)))
    return angle, np.linalg.norm(pose[:, 3] - true[:, 3]) / np.linalg.norm(true[:, 3])


def check_tracking(truth, seen, tracked):
    """`seen`: OpenCV's tags of every frame."""
    require(len(seen) == len(truth["frames"]) == len(tracked["given"]), "the film has other frames")
    corners = {"vantage": [], "opencv": []}
    errors = {"vantage": [], "opencv": [], "learned": []}
    for frame, theirs, given, learned in zip(
        truth["frames"], seen, tracked["given"], tracked["learned"]
    ):
        if frame["kind"] != "steady":
            continue
        true = np.array(frame["pose"]).reshape(3, 4)
        ours = {int(i): np.array(c).reshape(4, 2) for i, c in given["tags"].items()}
        for name, tags in (("vantage", ours), ("opencv", theirs)):
            for tag, pixels in tags.items():
                corners[name].extend(np.linalg.norm(pixels - project(truth, true, tag), axis=1))
        require("pose" in given and not given["isAmbiguous"], "a steady frame has no sure pose")
        errors["vantage"].append(pose_error(np.array(given["pose"]).reshape(3, 4), true))
        errors["opencv"].append(pose_error(opencv_pose(theirs, truth), true))
        if learned["isCalibrated"]:
            errors["learned"].append(pose_error(np.array(learned["pose"]).reshape(3, 4), true))
    medians = {name: np.median(values, axis=0) for name, values in errors.items()}
    worst = {name: np.max(values, axis=0) for name, values in errors.items()}
    for name, off in corners.items():
        print(
            f"{name}: {len(off) // 4} tags in {len(errors['vantage'])} steady frames, corners off by"
            f" {np.median(off):.2f} px (median), 99 % by less than {np.quantile(off, 0.99):.2f} px"
        )
    for name in errors:
        (angle, share), (most_angle, most_share) = medians[name], worst[name]
        print(
            f"{name}: {len(errors[name])} poses, median {angle:.3f} degrees and {100 * share:.3f} % of the"
            f" distance, at most {most_angle:.3f} and {100 * most_share:.3f} %"
        )
    require(len(corners["vantage"]) >= 0.98 * len(corners["opencv"]), "OpenCV sees more tags")
    for share in (0.5, 0.99):
        ours, theirs = (np.quantile(off, share) for off in corners.values())
        require(ours <= theirs, "OpenCV's corners are better")
    require(np.median(corners["vantage"]) < 0.25, "corners are off")
    for name in ("vantage", "learned"):
        require(medians[name][0] < 1.0 and medians[name][1] < 0.02, f"{name}: poses are off")
    require(np.all(medians["vantage"] <= medians["opencv"]), "OpenCV's poses are better")
    require(len(errors["learned"]) > 0.7 * len(errors["vantage"]), "the camera was learned late")
    calibration = tracked["calibration"]
    require(calibration is not None, "the camera was not learned")
    off = calibration["focalPx"] / truth["focalPx"] - 1
    print(f"focal length learned from {calibration['views']} views: {100 * off:+.2f} %")
    require(abs(off) < 0.01, "the focal length is off")


def check_quality(truth, tracked):
    kinds = {}
    for frame, found in zip(truth["frames"], tracked["given"]):
        kinds.setdefault(frame["kind"], []).append(found)
    value = lambda kind, name: np.array([found[name] for found in kinds[kind]])
    sharp = np.quantile(value("steady", "sharpness"), 0.05)
    print(
        f"sharpness: steady {sharp:.3f} (5 %), blurred at most {value('blurred', 'sharpness').max():.3f};"
        f" mean luma: steady {np.median(value('steady', 'meanLuma')):.0f},"
        f" dark {value('dark', 'meanLuma').max():.0f};"
        f" blown out: steady {value('steady', 'brightShare').max():.2f},"
        f" bright {value('bright', 'brightShare').min():.2f}"
    )
    require(value("blurred", "sharpness").max() < 0.6 * sharp, "blur is not seen")
    require(value("dark", "meanLuma").max() < 40, "darkness is not seen")
    require(value("bright", "brightShare").min() > 0.1, "brightness is not seen")
    require(value("steady", "brightShare").max() < 0.05, "good frames are called too bright")
    require(all("pose" not in found for found in kinds["lost"]), "a lost board has a pose")


def check_drawing(svg, board):
    """The drawing, at 8 pixels a millimetre, shows OpenCV every tag, upright and true to size."""
    scale = 8
    width, height = (float(v) for v in re.search(r'viewBox="0 0 (\S+) (\S+)"', svg).groups())
    require(f'width="{width:g}mm" height="{height:g}mm"' in svg, "the drawing is not in millimetres")
    sheet = np.full((int(height * scale), int(width * scale)), 255, np.uint8)
    for run in re.findall(r"M(\S+) (\S+)h(\S+)v(\S+)h-\S+z", svg):
        x, y, w, h = (float(v) * scale for v in run)
        sheet[round(y) : round(y + h), round(x) : round(x + w)] = 0
    tags = opencv_tags(detector(), sheet)
    require(len(tags) == board["columns"] * board["rows"], f"OpenCV sees {len(tags)} tags of the drawing")
    for tag, corners in tags.items():
        x, y, _ = (1000 * corners_on_board(board, tag)).T
        expected = np.stack([0.5 * width + x, 0.5 * height - y], axis=1)
        error = np.abs(corners / scale - expected).max()
        require(error < 0.2, f"tag {tag} is drawn {error:.2f} mm off")
    print(f"drawing: OpenCV sees all {len(tags)} tags where they belong")


def check(truth, seen, tracked, svg):
    require(write_codes.TARGET.read_text() == write_codes.text(), "codes.rs is not OpenCV's table")
    check_drawing(svg, truth["board"])
    check_tracking(truth, seen, tracked)
    check_quality(truth, tracked)


def faults(tracked, svg):
    """What must be found out: each a name, tracked frames and a drawing."""

    def spoilt(change):
        copied = copy.deepcopy(tracked)
        for frame in copied["given"]:
            change(frame)
        return copied

    def shift(frame):
        frame["tags"] = {i: [v + HALF_PIXEL for v in c] for i, c in frame["tags"].items()}

    def farther(frame):
        if "pose" in frame:
            frame["pose"][11] += 0.02

    def fewer(frame):
        frame["tags"] = dict(list(frame["tags"].items())[1:])

    def duller(frame):
        frame["sharpness"] = 1.0

    yield "corners by half a pixel", spoilt(shift), svg
    yield "poses by two centimetres", spoilt(farther), svg
    yield "a tag less in each frame", spoilt(fewer), svg
    yield "the same sharpness everywhere", spoilt(duller), svg
    yield "no calibration", {**tracked, "calibration": None}, svg
    yield "a drawing of another size", tracked, svg.replace("mm", "cm")
    first = re.search(r"M\S+ \S+h", svg).group()
    yield "a drawing without a tag's edge", tracked, svg.replace(first, "M0 0h", 1)


def main(arguments):
    self_test = arguments[:1] == ["--self-test"]
    film, out = (Path(argument) for argument in arguments[self_test:])
    truth = json.loads(film.with_suffix(".json").read_text())
    tracked = json.loads((out / "tracked.json").read_text())
    svg = (out / "board.svg").read_text()
    found = detector()
    seen = [opencv_tags(found, luma) for luma in read_film(film, truth)]
    if not self_test:
        check(truth, seen, tracked, svg)
        print(f"one frame takes {tracked['medianMs']:.1f} ms here (median)")
        return
    for name, spoilt, drawing in faults(tracked, svg):
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                check(truth, seen, spoilt, drawing)
        except Mismatch as found:
            print(f"found out: {name} ({found})")
        else:
            raise Mismatch(f"{name} went unnoticed")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except Mismatch as error:
        sys.exit(f"board: {error}")
