"""Writes texture/*.rgb, texture/*.lbp, texture.txt and hue_saturation.txt: see README.md."""

import colorsys
import pathlib

import numpy as np
from skimage import data
from skimage.color import rgb2hsv
from skimage.feature import local_binary_pattern

HERE = pathlib.Path(__file__).parent
SIZE = 48  # pixels on each side of a crop
MARGIN = 3  # the pattern's radius: nearer to the border scikit-image reads zeros
# Name, picture, row and column of the crop's upper left corner.
CROPS = [
    ("astronaut", data.astronaut, 60, 130),
    ("coffee", data.coffee, 200, 330),
    ("chelsea", data.chelsea, 90, 120),
    ("rocket", data.rocket, 160, 300),
]


def hue_saturation(rgb):
    """Both channels in 8 bits, by the textbook's formula in integers, rounded half up."""
    r, g, b = (rgb[..., channel].astype(np.int64) for channel in range(3))
    brightest, darkest = np.maximum(np.maximum(r, g), b), np.minimum(np.minimum(r, g), b)
    spread = brightest - darkest
    safe = np.where(spread == 0, 1, spread)
    sixths = np.select(
        [brightest == r, brightest == g],
        [np.mod(g - b, 6 * safe), b - r + 2 * safe],
        r - g + 4 * safe,
    )
    hue = np.where(spread == 0, 0, (256 * sixths + 3 * safe) // (6 * safe) % 256)
    saturation = (255 * spread + brightest // 2) // np.maximum(brightest, 1)
    return hue.astype(np.uint8), saturation.astype(np.uint8)


def main():
    (HERE / "texture").mkdir(exist_ok=True)
    lines = ["# Written by texture.py: crop, share of pixels whose code is not 7 in hue, saturation"]
    for name, picture, row, column in CROPS:
        crop = picture()[row : row + SIZE, column : column + SIZE, :3]
        (HERE / "texture" / f"{name}.rgb").write_bytes(np.ascontiguousarray(crop).tobytes())
        planes = hue_saturation(crop)
        codes = [local_binary_pattern(plane, P=3, R=3, method="default") for plane in planes]
        inside = [code.astype(np.uint8)[MARGIN:-MARGIN, MARGIN:-MARGIN] for code in codes]
        packed = inside[0] | inside[1] << 3
        (HERE / "texture" / f"{name}.lbp").write_bytes(packed.tobytes())
        shares = [1 - np.mean(code == 7) for code in inside]
        lines.append(f"{name} {shares[0]:.9f} {shares[1]:.9f}")
    (HERE / "texture.txt").write_text("\n".join(lines) + "\n")

    chance = np.random.default_rng(1)
    colours = np.concatenate(
        [
            np.stack(np.meshgrid(*3 * [[0, 1, 128, 255]]), -1).reshape(-1, 3),
            chance.integers(0, 256, (200, 3)),
            # Nearly grey and nearly black, where one step of a channel is a large step of both.
            chance.integers(0, 6, (50, 3)),
            np.clip(chance.integers(20, 250, (50, 1)) + chance.integers(-2, 3, (50, 3)), 0, 255),
        ]
    )
    lines = ["# Written by texture.py: red green blue (0 to 255), hue and saturation (0 to 1)"]
    for colour in colours:
        hue, saturation, _ = colorsys.rgb_to_hsv(*(colour / 255))
        theirs = rgb2hsv(colour.reshape(1, 1, 3) / 255)[0, 0]
        assert np.allclose([hue, saturation], theirs[:2], atol=1e-12), colour
        lines.append("{} {} {} {:.7f} {:.7f}".format(*colour, hue, saturation))
    (HERE / "hue_saturation.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
