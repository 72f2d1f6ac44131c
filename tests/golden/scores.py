"""Writes scores.txt and smoothing.txt: see README.md."""

import pathlib

import numpy as np

HERE = pathlib.Path(__file__).parent
FACES, VIEWS = 24, 10
# Name, d_Q, d_T, sigma_Q, beta_Q.
READINGS = [
    ("default", 0.5, 0.25, 1.0, 1.0),
    ("literal", 0.5, 0.25, 1.0, 1.0),
    ("default", 0.3, 0.7, 1.0, 1.0),
    ("literal", 0.8, 0.1, 2.5, 0.4),
]


def scene():
    """A ball of faces and cameras around it; every number is a single-precision one."""
    chance = np.random.default_rng(7)
    normal = chance.normal(size=(FACES, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    area = chance.uniform(0.5, 1.5, FACES)
    faces = {
        "centroid": normal * 0.5 + chance.normal(size=(FACES, 3)) * 0.05,
        "normal": normal,
        "area": area / area.sum(),
        "complexity": np.where(chance.random(FACES) < 0.2, 0, chance.exponential(size=FACES)),
    }
    camera = chance.normal(size=(VIEWS, 3))
    camera *= 2 / np.linalg.norm(camera, axis=1, keepdims=True)
    faces, camera = {k: np.float32(v) for k, v in faces.items()}, np.float32(camera)
    towards = camera[:, None] - faces["centroid"]
    seen = (towards * faces["normal"]).sum(-1) > 0.1  # (views, faces)
    seen &= chance.random(seen.shape) > 0.1
    # A few faces that are wound the wrong way.
    faces["normal"][::7] *= -1
    textured = np.where(seen, chance.integers(0, 60, seen.shape), 0)
    background = chance.integers(0, 30, VIEWS)
    pixels = textured.sum(1) + background + 10
    return faces, camera, seen, textured, background, pixels


def scores(form, d_q, d_t, sigma, beta, total, faces, camera, seen, textured, background, pixels):
    """C, Q, D, T of these views, from the equations."""
    literal = form == "literal"
    area, mass = faces["area"].astype(float), faces["complexity"].astype(float)
    weight = np.full(FACES, 1 / FACES) if literal else area
    times = seen.sum(0)

    c = weight[times > 0].sum()

    discounted = (1 - d_q**times) / (1 - d_q)  # 1 + d + d^2 + ...
    if literal:
        q = (beta * mass * discounted + 1).sum() / (FACES * (5 * sigma) ** 2)
    else:
        q = (area * mass * discounted).sum() * (1 - d_q) / (area * mass).sum()

    d = 0.0
    for face in np.flatnonzero(times):
        rays = camera[seen[:, face]].astype(float) - faces["centroid"][face].astype(float)
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        cosine = rays @ faces["normal"][face].astype(float)
        incidence = np.degrees(np.arccos(np.clip(cosine if literal else abs(cosine), -1, 1)))
        psi = 1 - 1 / (1 + np.exp(-(incidence - 90) - 10))
        product = np.prod(np.var(rays, axis=0))
        d += weight[face] * psi.mean() * (product if literal else 3 * np.cbrt(product))

    before = np.cumsum(seen, 0) - seen  # how often a face was seen before each view
    counted = (textured * d_t**before * seen).sum(1) + background
    shares = counted / (2 * pixels)
    t = shares.mean() if literal else shares.sum() / total
    return c, q, d, t


def main():
    faces, camera, seen, textured, background, pixels = scene()
    total = float(np.float32(1.75))
    text = lambda numbers: " ".join(f"{float(x):.9g}" for x in np.ravel(numbers))
    lines = ["# Written by scores.py: the surface, what each view shows of it, and all scores."]
    lines.append(f"texture_total {total}")
    for j in range(FACES):
        row = [faces["centroid"][j], faces["normal"][j], [faces["area"][j], faces["complexity"][j]]]
        lines.append(f"face {text(np.concatenate(row))}")
    for k in range(VIEWS):
        shown = " ".join(f"{j}:{textured[k, j]}" for j in np.flatnonzero(seen[k]))
        lines.append(f"view {text(camera[k])} {background[k]} {pixels[k]} {shown}")
    for reading in READINGS:
        lines.append("reading {} {} {} {} {}".format(*reading))
        for n in range(1, VIEWS + 1):
            parts = (x[:n] for x in (camera, seen, textured, background, pixels))
            lines.append(f"scores {text(scores(*reading, total, faces, *parts))}")
    (HERE / "scores.txt").write_text("\n".join(lines) + "\n")

    x = np.float32(np.concatenate([np.linspace(-0.5, 1.5, 81), [-20, -9, 9, 20]]))
    xi = np.clip(1 / (1 + np.exp(-3 * np.e * x.astype(float) + 3 * 0.5 * np.e)), 0, 1)
    lines = ["# Written by scores.py: x, xi(x)"] + [text(pair) for pair in zip(x, xi)]
    (HERE / "smoothing.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
