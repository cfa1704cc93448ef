"""Which parts of a terrain an observer sees, and how much of the sky each part sees.

    python3 terrain_visibility.py [--size 400] [--directions 64] [--device gpu] [--plot FILE]

The terrain is a grid of heights; put your own in place of hills()."""
import argparse

import numpy as np

import clarity


def hills(size):
    """Heights of a grid of points over the unit square."""
    x, y = np.meshgrid(np.linspace(0, 1, size), np.linspace(0, 1, size))
    return 0.08 * np.sin(9 * x) * np.cos(7 * y) + 0.02 * np.sin(31 * x + 3) * np.sin(23 * y)


def points_of(heights):
    rows, columns = heights.shape
    x, y = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    return np.stack([x, y, heights], axis=-1)


def mesh_of(points):
    """Two triangles for each square of four points."""
    rows, columns = points.shape[:2]
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.stack([corner, corner + 1, corner + columns + 1], axis=-1)
    upper = np.stack([corner, corner + columns + 1, corner + columns], axis=-1)
    return clarity.Scene(points.reshape(-1, 3).astype(np.float32), np.concatenate([lower, upper]).astype(np.uint32))


def seen_from(rt, eye, points, above=1e-3):
    """Whether nothing lies between the eye and each point; points are lifted a little, so that they do not hide themselves."""
    to_points = points + [0, 0, above] - eye
    return ~rt.any(eye, to_points, t_max=1)  # t = 1 is at the point


def sky_share(rt, points, directions, above=1e-3, seed=1):
    """The share of the sky that each point sees, as a flat surface gathers it: directions are drawn with the cosine's density."""
    random = np.random.default_rng(seed)
    free = np.zeros(points.shape[:-1])
    origins = points + [0, 0, above]
    for k in range(directions):
        radius, angle = np.sqrt((k + random.random()) / directions), 2 * np.pi * random.random()
        direction = [radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1 - radius * radius)]
        free += ~rt.any(origins, direction)
    return free / directions


def plot(seen, sky, eye, file):
    try:
        from matplotlib import pyplot
    except ImportError:
        return print("no plot: matplotlib is not installed (package python3-matplotlib)")
    figure, axes = pyplot.subplots(1, 2, figsize=(10, 4.5), layout="constrained")
    for axis, values, title in ((axes[0], seen, "seen by the observer (cross)"), (axes[1], sky, "share of the sky")):
        figure.colorbar(axis.imshow(values, origin="lower", extent=(0, 1, 0, 1), vmin=0, vmax=1), ax=axis)
        axis.set_title(title)
    axes[0].plot(eye[0], eye[1], "rx", markersize=10)
    figure.savefig(file)
    print(f"{file} shows both")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--size", type=int, default=400, help="points along a side")
    words.add_argument("--directions", type=int, default=64, help="of the sky, from each point")
    words.add_argument("--device", default="", help="as of clarity --device")
    words.add_argument("--plot", default="terrain.png", help="the file for the two maps")
    asked = words.parse_args()
    points = points_of(hills(asked.size))
    rt = mesh_of(points).on(asked.device)
    eye = np.array([0.5, 0.5, points[asked.size // 2, asked.size // 2, 2] + 0.05])
    seen = seen_from(rt, eye, points)
    sky = sky_share(rt, points, asked.directions)
    print(f"seen from the middle: {100 * seen.mean():.1f} % of the points")
    print(f"share of the sky: {sky.min():.2f} to {sky.max():.2f}, {sky.mean():.2f} on average")
    plot(seen, sky, eye, asked.plot)


if __name__ == "__main__":
    main()
