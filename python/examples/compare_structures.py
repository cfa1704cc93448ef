"""How fast structures are built and traced, on a mesh of your own.

    python3 compare_structures.py [mesh.obj ...] [--accel bvh2 --accel bvh8,max_leaf=2] [--rays 1000000] [--plot FILE]

Without files the mesh is a knot. All structures must give the same hits. Times are the best of --repeat runs; for figures to
publish take clarity.bench(), which refuses what was disturbed."""
import argparse
import time

import numpy as np

import clarity


def knot(around, across):
    """A closed tube along a torus knot."""
    t, s = np.meshgrid(np.linspace(0, 2 * np.pi, around, endpoint=False), np.linspace(0, 2 * np.pi, across, endpoint=False), indexing="ij")

    def middle(t):
        return np.stack([(2 + np.cos(3 * t)) * np.cos(2 * t), (2 + np.cos(3 * t)) * np.sin(2 * t), np.sin(3 * t)], axis=-1)

    along = middle(t + 1e-3) - middle(t - 1e-3)
    side = np.cross(along, [0, 0, 1])
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    up = np.cross(side, along)
    up /= np.linalg.norm(up, axis=-1, keepdims=True)
    vertices = middle(t) + 0.4 * (np.cos(s)[..., None] * side + np.sin(s)[..., None] * up)
    i, k = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = i * across + k, (i + 1) % around * across + k
    c, d = (i + 1) % around * across + (k + 1) % across, i * across + (k + 1) % across
    faces = np.concatenate([np.stack([a, b, c], axis=-1).reshape(-1, 3), np.stack([a, c, d], axis=-1).reshape(-1, 3)])
    return vertices.reshape(-1, 3).astype(np.float32), faces.astype(np.uint32)


def rays_through(bounds, count, seed=1):
    """From a sphere around the scene towards points inside its box."""
    random = np.random.default_rng(seed)
    middle, size = bounds.mean(0), np.linalg.norm(bounds[1] - bounds[0])
    origins = random.standard_normal((count, 3))
    origins = middle + size * origins / np.linalg.norm(origins, axis=1, keepdims=True)
    return origins, bounds[0] + random.random((count, 3)) * (bounds[1] - bounds[0]) - origins


def compare(scene, structures, count, repeat=5, device=""):
    """A dictionary for each structure: its name, seconds until it could be traced, and millions of rays a second."""
    origins, directions = rays_through(scene.bounds, count)
    rows, expected = [], None
    for accel in structures:
        begin = time.perf_counter()
        rt = scene.on(device, accel)
        made = time.perf_counter() - begin
        rays = rt.pack(origins, directions)
        hit = rt.closest(rays)  # compiles the kernels
        best = np.inf
        for _ in range(repeat):
            begin = time.perf_counter()
            rt.closest(rays, out=hit)
            best = min(best, time.perf_counter() - begin)
        if expected is None:
            expected = hit
        elif not (np.array_equal(hit.prim, expected.prim) and np.array_equal(hit.t, expected.t)):
            raise SystemExit(f"{accel} and {structures[0]} do not give the same hits")
        rows.append({"accel": accel, "made_s": made, "mrays_per_s": count / best / 1e6, "hits": int(hit.mask.sum())})
    return rows


def plot(rows, file):
    try:
        from matplotlib import pyplot
    except ImportError:
        return print("no plot: matplotlib is not installed (package python3-matplotlib)")
    names = [row["accel"] for row in rows]
    figure, axes = pyplot.subplots(1, 2, figsize=(9, 4), layout="constrained")
    for axis, key, title in ((axes[0], "mrays_per_s", "Mrays/s (more is better)"), (axes[1], "made_s", "seconds until rays can be traced")):
        axis.bar(names, [row[key] for row in rows])
        axis.set_title(title)
        axis.set_ylim(0)
    figure.savefig(file)
    print(f"{file} shows it")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("files", nargs="*")
    words.add_argument("--accel", action="append", help="may be repeated; default: bvh2 and bvh8")
    words.add_argument("--rays", type=int, default=1000000)
    words.add_argument("--repeat", type=int, default=5)
    words.add_argument("--triangles", type=int, default=500000, help="of the knot, about")
    words.add_argument("--device", default="", help="as of clarity --device")
    words.add_argument("--plot", default="structures.png", help="the file for the chart")
    asked = words.parse_args()
    across = max(3, int(np.sqrt(asked.triangles / 32)))
    scene = clarity.load(*asked.files) if asked.files else clarity.Scene(*knot(16 * across, across))
    rows = compare(scene, asked.accel or ["bvh2", "bvh8"], asked.rays, asked.repeat, asked.device)
    print(f"{scene.info['triangles']} triangles, {asked.rays} rays, {rows[0]['hits']} hits")
    for row in rows:
        print(f"{row['accel']:24} ready after {row['made_s']:.2f} s  {row['mrays_per_s']:8.1f} Mrays/s")
    plot(rows, asked.plot)


if __name__ == "__main__":
    main()
