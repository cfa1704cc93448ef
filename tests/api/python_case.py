"""What the tests of the Python package share. Run by ctest, with CLARITY_PROGRAM: the program of the build."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import clarity

PROGRAM = os.environ["CLARITY_PROGRAM"]
QUICK = bool(os.environ.get("CLARITY_QUICK_TESTS"))
STRUCTURES = ["bvh2,max_leaf=4", "grid"]


def soup(count, seed):
    """Small triangles in the cube from 0 to 1."""
    random = np.random.default_rng(seed)
    corners = random.random((count, 1, 3)) + 0.1 * random.standard_normal((count, 3, 3))
    return corners.reshape(-1, 3).astype(np.float32), np.arange(3 * count).reshape(-1, 3)


def some_rays(count, seed):
    """Half of them to the cube, half of them past it."""
    random = np.random.default_rng(seed)
    origins = (4 * random.random((count, 3)) - 1.5).astype(np.float32)
    directions = (random.random((count, 3)) - origins).astype(np.float32)
    directions[::2] = random.standard_normal((len(directions[::2]), 3))
    return origins, directions


def text_of(number):
    return repr(float(number))


def brute_force(vertices, faces, origins, directions, t_min, t_max):
    """All (ray, prim) in order of ray, t and prim, each triangle for itself in double precision (Moeller, Trumbore 1997, Fast,
    Minimum Storage Ray/Triangle Intersection), and which rays pass an edge or an end of their interval so narrowly that rounding
    decides."""
    a, b, c = (vertices.astype(float)[faces[:, k]] for k in range(3))
    d, o = (array.astype(float)[:, None] for array in (directions, origins))
    across = np.cross(d, c - a)
    det = np.sum((b - a) * across, -1)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.sum((o - a) * across, -1) / det
        q = np.cross(o - a, b - a)
        v = np.sum(d * q, -1) / det
        t = np.sum((c - a) * q, -1) / det
    inside = np.minimum(np.minimum(u, v), 1 - u - v)
    behind = np.minimum(t - t_min, t_max - t)
    found = (det != 0) & (inside >= 0) & (behind >= 0)
    narrow = ((np.abs(inside) < 1e-4) | (np.abs(behind) < 1e-4)) & (inside > -1e-4) & (behind > -1e-4)
    ray, prim = np.nonzero(found)
    order = np.lexsort((prim, t[ray, prim], ray))
    return ray[order], prim[order], t[ray, prim][order], narrow.any(1)


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="clarity_python_")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.vertices, cls.faces = soup(300, 1)
        cls.mesh_file = os.path.join(cls.folder, "soup.obj")
        with open(cls.mesh_file, "w") as file:
            for vertex in cls.vertices:
                file.write("v " + " ".join(map(text_of, vertex)) + "\n")
            for face in cls.faces + 1:
                file.write("f {} {} {}\n".format(*face))
        cls.scene_file = os.path.join(cls.folder, "mixed.scene")
        with open(cls.scene_file, "w") as file:
            file.write("sphere center 0.5 0.5 0.5 radius 0.4\nplane normal 0 1 0 offset -0.2\nload soup.obj translate 0.2 0 0\n")
        try:
            clarity.Scene(cls.vertices, cls.faces).on()
        except clarity.DeviceError as error:
            raise unittest.SkipTest(str(error)) from None

    def run_program(self, *words):
        return subprocess.run([PROGRAM, *words], check=True, capture_output=True, text=True).stdout

    def run_python(self, lines, **options):
        return subprocess.run([sys.executable, "-c", lines], capture_output=True, text=True, timeout=300, **options)

    def equal(self, hit, other):
        for name in ("t", "prim", "instance", "uv"):
            np.testing.assert_array_equal(getattr(hit, name), getattr(other, name), name)
