"""All hits of rays, their counts, and masks of rays, against each triangle for itself."""
import itertools
import os
import re
import unittest

import numpy as np

import clarity
from python_case import QUICK, STRUCTURES, Case, brute_force, some_rays, soup


class Lists(Case):
    def expect(self, rt, query, ray, prim, t):
        hits = rt.all(*query)
        found = list(hits)
        np.testing.assert_array_equal(found[0], ray)
        np.testing.assert_allclose(found[1], t, rtol=1e-4, atol=1e-5)
        np.testing.assert_array_equal(found[2], prim)
        rays = len(query[0])
        counts = np.bincount(ray, minlength=rays)
        np.testing.assert_array_equal(rt.count(*query), counts)
        np.testing.assert_array_equal(hits.first, np.concatenate([[0], np.cumsum(counts)]))
        # The first of each ray is the nearest, bit for bit.
        hit = rt.closest(*query)
        first = hits.first[:-1][counts > 0]
        np.testing.assert_array_equal(hit.mask, counts > 0)
        np.testing.assert_array_equal(hit.t[hit.mask], hits.t[first])
        return hits

    def test_are_those_of_brute_force_in_every_structure(self):
        random = np.random.default_rng(11)
        vertices, faces = soup(250, 12)
        vertices[::2] += random.standard_normal((len(vertices[::2]), 3)).astype(np.float32)  # some are large
        # Beside the soup: squares of two triangles at z = 0, -1, -2, each of them there three times.
        copies, floors = 3, 3
        square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) + [16, 0, 0]
        plates = np.concatenate([square - [0, 0, i // copies] for i in range(copies * floors)]).astype(np.float32)
        of_plates = np.concatenate([np.array([[0, 1, 2], [0, 2, 3]]) + 4 * i for i in range(copies * floors)])
        vertices, faces = np.concatenate([vertices, plates]), np.concatenate([faces, of_plates + len(vertices)])
        origins, directions = some_rays(500, 13)
        t_min = np.linspace(0, 0.3, 500, dtype=np.float32)
        t_max = np.where(np.arange(500) % 3 == 0, 1.5, 1e9).astype(np.float32)
        ray, prim, t, narrow = brute_force(vertices, faces, origins, directions, t_min[:, None], t_max[:, None])
        self.assertLess(np.count_nonzero(narrow), 50)
        # Narrow rays are left out: the rays behind them move up in the arrays.
        keep = ~narrow
        sure = keep[ray]
        soup_expected = (np.cumsum(keep) - 1)[ray[sure]], prim[sure], t[sure]
        self.assertGreater(np.bincount(soup_expected[0]).max(), 8)  # more than a launch lists
        soup_rays = origins[keep], directions[keep], t_min[keep], t_max[keep]
        # Through a diagonal, one triangle, nothing; of the last ray t_max is at the second floor, and not in the interval.
        down = np.array([[16.5, 0.5, 1], [16.75, 0.25, 1], [17.5, 0.5, 1], [16.25, 0.75, 1]], np.float32)
        plate_rays = down, [[0, 0, -1]] * 4, [0] * 4, np.array([9, 9, 9, 2], np.float32)
        number = np.concatenate([np.arange(18), np.arange(0, 18, 2), np.arange(1, 6, 2)])
        plates_expected = np.repeat([0, 1, 3], [18, 9, 3]), 250 + number, 1 + number // (2 * copies)
        structures = STRUCTURES if QUICK else re.findall(r"^accel +(\w+)", self.run_program("plugins"), re.M)
        for turn, structure in itertools.product(range(1 if QUICK else 3), structures):  # those before stay in the process
            with self.subTest(turn=turn, structure=structure):
                rt = clarity.Scene(vertices, faces).on(accel=structure)
                hits = self.expect(rt, soup_rays, *soup_expected)
                np.testing.assert_array_equal(rt.any(*soup_rays), rt.count(*soup_rays) > 0)
                points = soup_rays[0][soup_expected[0]] + soup_expected[2][:, None] * soup_rays[1][soup_expected[0]]
                np.testing.assert_allclose(hits.points(), points, rtol=0, atol=1e-4)
                hits = self.expect(rt, plate_rays, *plates_expected)
                np.testing.assert_array_equal(hits.t, plates_expected[2])

    def test_outlive_the_hits_and_keep_the_shape_of_rays(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        origins, directions = some_rays(70000, 14)  # more than a piece
        hits = rt.all(origins, directions)
        counts = rt.count(origins.reshape(100, 700, 3), directions.reshape(100, 700, 3))
        self.assertEqual(counts.shape, (100, 700))
        np.testing.assert_array_equal(np.bincount(hits.ray, minlength=70000), counts.ravel())
        np.testing.assert_array_equal(np.diff(hits.first), counts.ravel())
        copies = hits.ray.copy(), hits.t.copy(), hits.prim.copy()
        ray, t, prim = hits
        self.assertFalse(t.flags.writeable)
        del hits
        junk = [rt.all(origins[:100], directions[:100]) for _ in range(20)]
        for array, copy in zip((ray, t, prim), copies):
            np.testing.assert_array_equal(array, copy)
        self.assertEqual(len(rt.all(np.empty((0, 3)), [0, 0, 1])), 0)
        self.assertGreater(len(junk[0]), 0)
        out = np.empty(100, np.int64)
        self.assertIs(rt.count(origins[:100], directions[:100], out=out), out)
        np.testing.assert_array_equal(out, counts.ravel()[:100])
        with self.assertRaises(clarity.Cancelled):
            rt.all(origins, directions, progress=lambda stage, fraction: False)

    def test_of_masked_rays_pass_instances(self):
        file = os.path.join(self.folder, "masked.scene")
        with open(file, "w") as stream:
            stream.write("load soup.obj\nload soup.obj translate 0 0 5\nedit instance 0  mask 8\nedit instance 1  mask 16\n")
        rt = clarity.load(file).on(accel="bvh2")
        ray = [0.5, 0.5, 9], [0, 0, -1]
        per_instance = [np.count_nonzero(rt.all(*ray, mask=24).instance == i) for i in (0, 1)]
        self.assertEqual(per_instance[0], per_instance[1])
        self.assertGreater(per_instance[0], 0)
        for mask, expected in ((8, {0}), (16, {1}), (24, {0, 1}), (4, set()), (None, {0, 1})):
            hits = rt.all(*ray, mask=mask)
            self.assertEqual(set(hits.instance), expected)
            self.assertEqual(rt.count(*ray, mask=mask), len(hits))
            self.assertEqual(rt.any(*ray, mask=mask), bool(expected))
            for _ in range(2):  # the other query has its own mask
                self.assertEqual(rt.closest(*ray, mask=mask).instance, max(expected, default=-1))
                rt.count(*ray, mask=4)
        for mask in (0, 256):
            with self.assertRaisesRegex(clarity.UsageError, "mask: expected"):
                rt.any(*ray, mask=mask)


if __name__ == "__main__":
    unittest.main(verbosity=2)
