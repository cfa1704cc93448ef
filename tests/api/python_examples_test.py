"""The scripts of python/examples: each runs as a program, and what its functions compute is known."""
import importlib.util
import os
import re
import subprocess
import sys
import unittest

import numpy as np

import clarity
from python_case import QUICK, Case

SOURCES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
EXAMPLES = os.path.join(SOURCES, "python/examples")
sys.path.insert(0, EXAMPLES)


class Examples(Case):
    def run_example(self, name, *words):
        line = [sys.executable, os.path.join(EXAMPLES, name), *words]
        result = subprocess.run(line, capture_output=True, text=True, timeout=300, cwd=self.folder)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        plot = re.search(r"^(\w+\.png) shows|^no plot: matplotlib is not installed", result.stdout, re.M)
        if plot[1]:
            with open(os.path.join(self.folder, plot[1]), "rb") as file:
                self.assertEqual(file.read(4), b"\x89PNG")
        self.assertEqual(plot[1] is None, importlib.util.find_spec("matplotlib") is None)
        return result.stdout

    def test_a_wall_hides_what_is_behind_it(self):
        terrain = importlib.import_module("terrain_visibility")
        heights = np.zeros((40, 81))
        heights[:, 40] = 0.3
        points = terrain.points_of(heights)
        rt = terrain.mesh_of(points).on(accel="bvh2")
        seen = terrain.seen_from(rt, np.array([0.1, 0.5, 0.1]), points)
        self.assertTrue(seen[:, :39].all() and not seen[:, 42:].any())
        sky = terrain.sky_share(rt, points, 64)
        self.assertTrue((sky[:, 40] > 0.99).all() and (abs(sky[10:30, 38] - 0.5) < 0.1).all() and (sky[10:30, 0] > 0.9).all())
        flat = terrain.points_of(np.zeros((9, 9)))
        self.assertTrue((terrain.sky_share(terrain.mesh_of(flat).on(accel="bvh2"), flat, 8) == 1).all())
        printed = self.run_example("terrain_visibility.py", "--size", "30", "--directions", "4")
        self.assertRegex(printed, r"seen from the middle: \d+\.\d % (.|\n)*share of the sky: 0\.\d+ to 1\.00")

    def test_structures_are_compared_by_the_same_hits(self):
        compare = importlib.import_module("compare_structures")
        scene = clarity.Scene(self.vertices, self.faces)
        rows = compare.compare(scene, ["bvh2", "grid"], 3000, 1)
        hits = np.count_nonzero(scene.on(accel="bvh4").closest(*compare.rays_through(scene.bounds, 3000)).mask)
        self.assertEqual([(row["accel"], row["hits"]) for row in rows], [("bvh2", hits), ("grid", hits)])
        self.assertTrue(300 < hits < 3000 and all(row["mrays_per_s"] > 0 for row in rows))
        # The tube of the knot is closed: a ray from outside crosses it an even number of times.
        vertices, faces = compare.knot(200, 12)
        tube = clarity.Scene(vertices, faces)
        odd = np.count_nonzero(tube.on(accel="bvh2").count(*compare.rays_through(tube.bounds, 500)) % 2)
        self.assertLessEqual(odd, 2)
        printed = self.run_example("compare_structures.py", "--triangles", "2000", "--rays", "2000", "--repeat", "1", self.mesh_file)
        self.assertRegex(printed, r"300 triangles, 2000 rays, \d+ hits\nbvh2 .* Mrays/s\nbvh8 .* Mrays/s")

    def test_the_filter_takes_noise_and_keeps_edges(self):
        denoising = importlib.import_module("denoising_study")
        random = np.random.default_rng(30)
        # Two surfaces beside each other, which differ in their normals, or in their distance.
        clean = np.zeros((24, 32, 3))
        clean[:, 16:] = 1
        same_normals, same_distance = np.zeros((24, 32, 3)) + [0, 0, 1], np.full((24, 32), 5.0)
        normals, distance = same_normals.copy(), same_distance.copy()
        normals[:, 16:] = [1, 0, 0]
        distance[:, 16:] = 9
        noisy = clean + 0.2 * random.standard_normal(clean.shape)
        for guides in ((normals, same_distance), (same_normals, distance)):
            np.testing.assert_allclose(denoising.bilateral(clean, *guides), clean, atol=1e-3)
            self.assertLess(np.std(denoising.bilateral(noisy, *guides) - clean), 0.35 * np.std(noisy - clean))
        self.assertGreater(np.abs(denoising.bilateral(clean, same_normals, same_distance) - clean).max(), 0.2)
        # A brighter border must not come in from the other side of the picture.
        border = np.zeros((24, 32, 3))
        border[0], border[:, 0] = 1, 1
        self.assertEqual(denoising.bilateral(border, same_normals, same_distance)[5:, 5:].max(), 0)
        if QUICK:  # the study compiles two programs of paths
            return
        scene = os.path.join(SOURCES, "scenes/cornell.scene")
        printed = self.run_example("denoising_study.py", scene, "--size", "32x32", "--spp", "1", "4", "--reference", "32")
        rows = [[float(word) for word in line.split()] for line in printed.splitlines()[1:3]]
        self.assertEqual([row[0] for row in rows], [1, 4])
        self.assertTrue(rows[1][1] < rows[0][1] and rows[0][2] < rows[0][1], printed)


if __name__ == "__main__":
    unittest.main(verbosity=2)
