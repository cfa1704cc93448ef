#!/usr/bin/env python3
"""Writes the models of the thesis scenes into models/: `make_models.py`, and `make_models.py --skull skull.obj` for that one.

The teapot is Martin Newell's of 1975, from its Bezier patches: six profiles turned about the axis (24 patches) and a handle
and a spout (8), each patch cut into N x N squares, each square into two triangles. Where a patch's edge is a single point (top
of the knob, middle of the bottom) one of the two has no area and is left out: 64 N^2 - 8 N triangles, 2256 for N = 6.
"""
import argparse
import math
import os
import struct

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "models")

# ---- the teapot: (radius, height) of the control points of each turned curve, from the outside in
PROFILES = [
    [(1.4, 2.4), (1.3375, 2.53125), (1.4375, 2.53125), (1.5, 2.4)],  # rim
    [(1.5, 2.4), (1.75, 1.875), (2.0, 1.35), (2.0, 0.9)],  # body
    [(2.0, 0.9), (2.0, 0.45), (1.5, 0.225), (1.5, 0.15)],
    [(0.0, 3.15), (0.8, 3.15), (0.0, 2.85), (0.2, 2.7)],  # knob
    [(0.2, 2.7), (0.4, 2.55), (1.3, 2.55), (1.3, 2.4)],  # lid
    [(1.5, 0.15), (1.5, 0.075), (1.425, 0.0), (0.0, 0.0)],  # bottom
]
ARC = 0.56  # control points of a quarter of a circle, as Newell has them

# Tubes lie symmetrically about y = 0. Four rows along each; a row: (x, z) and (x, z) of its two ends, half width.
TUBES = [
    [((-1.6, 2.025), (-1.5, 2.25), 0.3), ((-2.3, 2.025), (-2.5, 2.25), 0.3),  # handle
     ((-2.7, 2.025), (-3.0, 2.25), 0.3), ((-2.7, 1.8), (-3.0, 1.8), 0.3)],
    [((-2.7, 1.8), (-3.0, 1.8), 0.3), ((-2.7, 1.575), (-3.0, 1.35), 0.3),
     ((-2.5, 1.125), (-2.65, 0.9375), 0.3), ((-2.0, 0.9), (-1.9, 0.6), 0.3)],
    [((1.7, 1.425), (1.7, 0.6), 0.66), ((2.6, 1.425), (3.1, 0.825), 0.66),  # spout
     ((2.3, 2.1), (2.4, 2.025), 0.25), ((2.7, 2.4), (3.3, 2.4), 0.25)],
    [((2.7, 2.4), (3.3, 2.4), 0.25), ((2.8, 2.475), (3.525, 2.49375), 0.25),
     ((2.9, 2.475), (3.45, 2.5125), 0.15), ((2.8, 2.4), (3.2, 2.4), 0.15)],
]


def teapot_patches():
    """4 x 4 control points each; z is up."""
    patches = []
    for profile in PROFILES:
        for quarter in range(4):
            patch = []
            for radius, height in profile:
                row = [(radius, 0.0), (radius, -ARC * radius), (ARC * radius, -radius), (0.0, -radius)]
                for _ in range(quarter):
                    row = [(y, -x) for x, y in row]
                patch.append([(x, y, height) for x, y in row])
            patches.append(patch)
    for tube in TUBES:
        for side in (-1.0, 1.0):
            patch = []
            for a, b, half in tube:
                row = [(a[0], 0.0, a[1]), (a[0], side * half, a[1]), (b[0], side * half, b[1]), (b[0], 0.0, b[1])]
                patch.append(row if side < 0 else row[::-1])
            patches.append(patch)
    return patches


def bezier(p, t):
    """Point and derivative of a cubic."""
    s = 1.0 - t
    at = [s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t]
    along = [-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t]
    return ([sum(w * q[k] for w, q in zip(at, p)) for k in range(3)], [sum(w * q[k] for w, q in zip(along, p)) for k in range(3)])


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v] if length > 1e-9 else None


def patch_point(patch, u, v):
    """Point and normal; the normal is None where the patch has none."""
    rows = [bezier(row, v) for row in patch]
    point, du = bezier([r[0] for r in rows], u)
    dv, _ = bezier([r[1] for r in rows], u)
    return point, unit(cross(du, dv))


class Model:
    """Corners at one place with one normal are one vertex."""

    def __init__(self):
        self.vertices, self.normals, self.triangles, self.known = [], [], [], {}

    def vertex(self, point, normal):
        key = tuple(round(x, 5) + 0.0 for x in list(point) + list(normal))
        if key not in self.known:
            self.known[key] = len(self.vertices)
            self.vertices.append(key[:3])
            self.normals.append(key[3:])
        return self.known[key]

    def triangle(self, points, normals):
        area = cross(minus(points[1], points[0]), minus(points[2], points[0]))
        if math.sqrt(sum(x * x for x in area)) > 1e-6:
            self.triangles.append([self.vertex(p, n) for p, n in zip(points, normals)])

    def write_obj(self, name, said):
        with open(os.path.join(FOLDER, name), "w", newline="\n") as out:
            out.write("# %s\n# Written by make_models.py: %d triangles.\n" % (said, len(self.triangles)))
            for v in self.vertices:
                out.write("v %g %g %g\n" % v)
            for n in self.normals:
                out.write("vn %g %g %g\n" % n)
            for t in self.triangles:
                out.write("f %s\n" % " ".join("%d//%d" % (i + 1, i + 1) for i in t))
        print(name, len(self.triangles), "triangles")


def teapot(n):
    model = Model()
    for patch in teapot_patches():
        grid = [[patch_point(patch, i / n, j / n) for j in range(n + 1)] for i in range(n + 1)]
        for i, row in enumerate(grid):  # at a pole the normal is that of the axis
            for j, (point, normal) in enumerate(row):
                if normal is None:
                    grid[i][j] = (point, [0.0, 0.0, 1.0 if point[2] > 1 else -1.0])
        for i in range(n):
            for j in range(n):
                a, b, c, d = grid[i][j], grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1]
                for corners in ((a, b, c), (a, c, d)):
                    turned = [((p[0], p[2], -p[1]), (m[0], m[2], -m[1])) for p, m in corners]  # y up
                    model.triangle([p for p, _ in turned], [m for _, m in turned])
    return model


def solid(points, faces, cuts=0, smooth=False):
    """A polyhedron around the origin; cuts: how often each triangle becomes four, whose corners go onto the unit sphere."""
    triangles = [[points[i] for i in face] for face in faces]
    for _ in range(cuts):
        finer = []
        for a, b, c in triangles:
            ab, bc, ca = (unit([x + y for x, y in zip(p, q)]) for p, q in ((a, b), (b, c), (c, a)))
            finer += [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        triangles = finer
    model = Model()
    for a, b, c in triangles:
        normal = unit(cross(minus(b, a), minus(c, a)))
        if sum(x * y for x, y in zip(normal, a)) < 0:
            b, c, normal = c, b, [-x for x in normal]
        model.triangle([a, b, c], [unit(p) for p in (a, b, c)] if smooth else [normal] * 3)
    return model


def tetrahedron():
    p = [unit(v) for v in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))]
    return p, [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]


def octahedron():
    p = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    return p, [(x, y, z) for x in (0, 1) for y in (2, 3) for z in (4, 5)]


def icosahedron():
    g = (1 + math.sqrt(5)) / 2
    p = [unit(v) for s in (1, -1) for t in (g, -g) for v in ((0, s, t), (s, t, 0), (t, 0, s))]
    edge = min(math.dist(p[0], q) for q in p[1:]) * 1.01
    near = lambda i, j: math.dist(p[i], p[j]) < edge
    return p, [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if near(i, j) and near(j, k) and near(i, k)]


def skull(path):
    """The OBJ as binary PLY with normals, area-weighted means of the faces around: 2.5 MB instead of 3.4 of text without."""
    points, faces = [], []
    with open(path) as lines:
        for line in lines:
            word = line.split()
            if word[:1] == ["v"]:
                points.append([float(x) for x in word[1:4]])
            elif word[:1] == ["f"]:
                faces.append([int(x.split("/")[0]) - 1 for x in word[1:4]])
    sums = [[0.0] * 3 for _ in points]
    for face in faces:
        a, b, c = (points[i] for i in face)
        area = cross(minus(b, a), minus(c, a))
        for i in face:
            sums[i] = [x + y for x, y in zip(sums[i], area)]
    with open(os.path.join(FOLDER, "skull.ply"), "wb") as out:
        out.write(("ply\nformat binary_little_endian 1.0\n"
                   "comment Skull by YahooJAPAN, thingiverse.com/thing:182365, CC BY 3.0; normals added by make_models.py\n"
                   "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
                   "property float nx\nproperty float ny\nproperty float nz\n"
                   "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % (len(points), len(faces))).encode())
        for point, total in zip(points, sums):
            out.write(struct.pack("<6f", *point, *(unit(total) or [0.0, 1.0, 0.0])))
        for face in faces:
            out.write(struct.pack("<B3i", 3, *face))
    print("skull.ply", len(faces), "triangles")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--skull", metavar="OBJ", help="convert this file instead")
    args = parser.parse_args()
    os.makedirs(FOLDER, exist_ok=True)
    if args.skull:
        skull(args.skull)
        return
    teapot(6).write_obj("teapot.obj", "Utah teapot by Martin Newell, 1975: 32 Bezier patches, 6 x 6 squares each, without areas of nothing")
    solid(*tetrahedron()).write_obj("tetrahedron.obj", "Tetrahedron in the unit sphere")
    solid(*octahedron()).write_obj("octahedron.obj", "Octahedron in the unit sphere")
    solid(*icosahedron()).write_obj("icosahedron.obj", "Icosahedron in the unit sphere")
    solid(*octahedron(), cuts=2, smooth=True).write_obj("ball.obj", "Octahedron, each face cut into 16, on the unit sphere")


if __name__ == "__main__":
    main()
