"""What a filter gains over more samples: the path tracer's picture with few samples, filtered with the help of normals and distances,
against one with many.

    python3 denoising_study.py scenes/cornell.scene [--size 256x256] [--spp 1 4 16 64] [--reference 1024] [--plot FILE]

The filter is a cross-bilateral one (Eisemann, Durand 2004, Flash Photography Enhancement via Intrinsic Relighting): a pixel becomes the
mean of its neighbourhood, in which neighbours count less that lie on another surface."""
import argparse

import numpy as np

import clarity


def bilateral(image, normals, distance, radius=3, of_normals=0.1, of_distance=0.03):
    """of_normals, of_distance: differences that count much less; distances by their share."""
    depth = np.where(np.isfinite(distance), distance, 1e6)
    total, weights = np.zeros_like(image, np.float64), np.zeros(image.shape[:2] + (1,))

    def moved(array, dy, dx):
        return np.roll(array, (dy, dx), (0, 1))

    def come_around(by):
        """Rows or columns that np.roll() has brought in from the other side of the picture: they do not count."""
        return slice(by) if by >= 0 else slice(by, None)

    for dy in range(-radius, radius + 1):
        for dx in range(-radius, radius + 1):
            there = np.ones(image.shape[:2])
            there[come_around(dy)] = 0
            there[:, come_around(dx)] = 0
            turned = np.sum((normals - moved(normals, dy, dx)) ** 2, -1) / of_normals
            nearer = np.abs(np.log(depth / moved(depth, dy, dx))) / of_distance
            weight = (there * np.exp(-(dy * dy + dx * dx) / (radius * radius) - turned - nearer))[..., None]
            total += weight * moved(image, dy, dx)
            weights += weight
    return total / weights


def error_of(image, reference):
    """Relative root mean square error. Pixels count less the brighter they are, as to the eye."""
    return float(np.sqrt(np.mean((image - reference) ** 2 / (reference**2 + 1e-2))))


def study(rt, width, height, samples, reference_samples, **view):
    """Errors for each number of samples: (samples, plain, filtered); and pictures by their names."""
    path = dict(tracer="path", **view)
    reference = rt.render(width, height, spp=reference_samples, seed=7, **path)
    normals, distance = (rt.render(width, height, aov=aov, **view) for aov in ("normal", "t"))
    rows, pictures = [], {}
    for spp in samples:
        image = rt.render(width, height, spp=spp, **path)
        filtered = bilateral(image, normals, distance)
        rows.append((spp, error_of(image, reference), error_of(filtered, reference)))
        if spp == samples[0]:
            pictures.update({f"{spp} samples": image, f"{spp} samples, filtered": filtered})
    return rows, {**pictures, f"{reference_samples} samples": reference}


def plot(rows, pictures, file):
    try:
        from matplotlib import pyplot
    except ImportError:
        return print("no plot: matplotlib is not installed (package python3-matplotlib)")
    figure, axes = pyplot.subplots(1, 4, figsize=(14, 3.8), layout="constrained")
    for axis, (name, picture) in zip(axes, pictures.items()):
        axis.imshow(np.clip(picture, 0, 1) ** (1 / 2.2))
        axis.set_title(name)
        axis.set_axis_off()
    samples, plain, filtered = zip(*rows)
    axes[3].loglog(samples, plain, "o-", label="path tracer")
    axes[3].loglog(samples, filtered, "o-", label="filtered")
    axes[3].set_xlabel("samples a pixel")
    axes[3].set_ylabel("relative error")
    axes[3].legend()
    figure.savefig(file)
    print(f"{file} shows it")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("files", nargs="+")
    words.add_argument("--size", default="256x256")
    words.add_argument("--spp", type=int, nargs="+", default=[1, 4, 16, 64])
    words.add_argument("--reference", type=int, default=1024, help="its samples a pixel")
    words.add_argument("--device", default="", help="as of clarity --device")
    words.add_argument("--plot", default="denoising.png", help="the file for pictures and chart")
    asked = words.parse_args()
    width, height = map(int, asked.size.split("x"))
    rows, pictures = study(clarity.load(*asked.files).on(asked.device), width, height, asked.spp, asked.reference)
    print("samples  error  filtered")
    for spp, plain, filtered in rows:
        print(f"{spp:7}  {plain:.3f}  {filtered:.3f}")
    plot(rows, pictures, asked.plot)


if __name__ == "__main__":
    main()
