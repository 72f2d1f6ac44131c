"""Writes similarity/*.rgb and similarity.txt: see README.md."""

import pathlib

import numpy as np
from skimage import data
from skimage.filters import gaussian
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

HERE = pathlib.Path(__file__).parent
WIDTH, HEIGHT = 40, 28  # pixels: neither square nor a multiple of the window
# Name, picture, row and column of the crop's upper left corner.
CROPS = [
    ("astronaut", data.astronaut, 60, 130),
    ("coffee", data.coffee, 200, 330),
]


def changed(picture, kind, chance):
    if kind == "noise":
        picture = picture + chance.normal(0, 20, picture.shape)
    elif kind == "blur":
        picture = gaussian(picture.astype(float), 1.2, channel_axis=2, preserve_range=True)
    elif kind == "darker":
        picture = picture * 0.7
    return np.clip(np.round(picture), 0, 255).astype(np.uint8)


def main():
    (HERE / "similarity").mkdir(exist_ok=True)
    chance = np.random.default_rng(7)
    lines = [f"# by similarity.py: name, change, PSNR, SSIM of crops {WIDTH} x {HEIGHT}"]
    for name, source, row, column in CROPS:
        truth = source()[row : row + HEIGHT, column : column + WIDTH, :3]
        (HERE / "similarity" / f"{name}.rgb").write_bytes(truth.tobytes())
        for kind in ["noise", "blur", "darker"]:
            found = changed(truth.astype(float), kind, chance)
            (HERE / "similarity" / f"{name}-{kind}.rgb").write_bytes(found.tobytes())
            a, b = found / 255.0, truth / 255.0
            psnr = peak_signal_noise_ratio(b, a, data_range=1)
            ssim = structural_similarity(
                a,
                b,
                channel_axis=2,
                data_range=1,
                gaussian_weights=True,
                sigma=1.5,
                use_sample_covariance=False,
            )
            lines.append(f"{name} {kind} {psnr:.9f} {ssim:.9f}")
    (HERE / "similarity.txt").write_text("\n".join(lines) + "\n")


main()
