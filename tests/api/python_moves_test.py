"""Moved vertices and instances, against scenes that have them there."""
import logging
import os
import unittest

import numpy as np

import clarity
from python_case import Case, some_rays


class Moves(Case):
    def builds_of(self, move):
        """How often move() builds."""
        with self.assertLogs("clarity", logging.DEBUG) as lines:
            logging.getLogger("clarity").debug("at least one line")
            move()
        return sum("built anew" in line for line in lines.output)

    def test_of_vertices_are_those_of_a_new_scene(self):
        random = np.random.default_rng(15)
        origins, directions = some_rays(3000, 16)
        for structure, settings, refits in (("bvh2", {"poses": "refit"}, True), ("grid", {}, False), ("bvh2", {"poses": "build"}, False)):
            with self.subTest(structure=structure, settings=settings):
                scene = clarity.Scene(self.vertices, self.faces)
                rt = scene.on(accel=structure, **settings)
                rays = rt.pack(origins, directions)
                before = rt.closest(rays)
                for round in range(4):
                    vertices = self.vertices + 0.1 * random.standard_normal(self.vertices.shape)
                    vertices = vertices.astype(np.float32 if round % 2 else np.float64)
                    builds = self.builds_of(lambda: rt.move(vertices))
                    self.assertEqual(builds, 0 if refits and round else 1)
                    expected = clarity.Scene(vertices.astype(np.float32), self.faces).on(accel=structure).closest(origins, directions)
                    self.equal(rt.closest(rays), expected)
                    self.equal(rt.closest(origins, directions), expected)
                    self.assertTrue((expected.t != before.t).any())
                self.equal(scene.on(accel=structure).closest(origins, directions), before)  # others see it where it was
                rt.move(self.vertices)
                self.equal(rt.closest(rays), before)

    def test_of_instances_keep_vertices_that_have_moved(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2", poses="refit")
        origins, directions = some_rays(1000, 20)
        lifted = np.eye(4)[None].copy()
        lifted[0, 2, 3] = 0.5
        rt.move(instances=lifted)
        rt.move(self.vertices * 0.5)
        self.assertEqual(self.builds_of(lambda: rt.move(instances=lifted)), 0)
        expected = clarity.Scene(self.vertices * 0.5 + np.float32([0, 0, 0.5]), self.faces).on(accel="bvh2").closest(origins, directions)
        hit = rt.closest(origins, directions)
        np.testing.assert_array_equal(hit.mask, expected.mask)
        np.testing.assert_allclose(hit.t, expected.t, rtol=1e-4)

    def test_of_instances_and_pictures(self):
        origins, directions = some_rays(1000, 17)
        file = os.path.join(self.folder, "two.scene")

        def scene_with(x, y):
            with open(file, "w") as stream:
                stream.write(f"load soup.obj translate {x} 0 0\nload soup.obj translate 0 {y} 0\nsphere center 3 0 0 radius 1\n")
            return clarity.load(file)

        rt = scene_with(0, 1).on(accel="bvh2", poses="refit")
        camera = [0.5, 0.5, 5, 0.5, 0.5, 0, 40]
        for round, (x, y) in enumerate(((0.25, 1.5), (0.5, -1), (2, 0.125))):
            places = np.tile(np.eye(4), (2, 1, 1))
            places[0, 0, 3], places[1, 1, 3] = x, y
            self.assertEqual(self.builds_of(lambda: rt.move(instances=places if round % 2 else places[:, :3])), 0 if round else 1)
            expected = scene_with(x, y).on(accel="bvh2")
            hit, other = rt.closest(origins, directions), expected.closest(origins, directions)
            np.testing.assert_allclose(hit.t, other.t, rtol=1e-4)
            np.testing.assert_array_equal(hit.prim, other.prim)
            pictures = [tracer.render(32, 24, camera=camera, aov="t") for tracer in (rt, expected)]
            np.testing.assert_allclose(*pictures, rtol=1e-4)
            self.assertTrue(np.isfinite(pictures[0]).any())

    def test_far_from_the_origin_are_rebased(self):
        far = np.array([5e6, -3e6, 7e6])
        rt = clarity.Scene(self.vertices.astype(float) + far, self.faces).on(accel="bvh2")
        origins, directions = some_rays(500, 18)
        moved = self.vertices + np.array([0.5, 0.25, 0])
        rt.move(moved + far)
        near = clarity.Scene(moved.astype(np.float32), self.faces).on(accel="bvh2").closest(origins, directions)
        hit = rt.closest(origins + far, directions)
        self.assertLessEqual(np.count_nonzero(near.mask != hit.mask), 2)
        both = near.mask & hit.mask
        np.testing.assert_allclose(hit.t[both], near.t[both], rtol=1e-3)

    def test_that_are_wrong_move_nothing(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        origins, directions = some_rays(200, 19)
        before = rt.closest(origins, directions)
        infinite = self.vertices.copy()
        infinite[7, 1] = np.inf
        flat = np.eye(4)[None] * [1, 0, 1, 1]
        nearly_flat = np.eye(4)[None]
        nearly_flat[0, :2, 1] = 1, 1e-9
        for words, wrong in (
            ("vertices: there are 7, and the scene has 900", lambda: rt.move(self.vertices[:7])),
            ("vertices: a number is not finite", lambda: rt.move(infinite)),
            (r"vertices: expected an array of shape \(n, 3\)", lambda: rt.move(self.vertices.ravel())),
            ("instances: there are 2, and the scene has 1", lambda: rt.move(instances=np.tile(np.eye(4), (2, 1, 1)))),
            ("transform of instance 0: it has no inverse", lambda: rt.move(instances=flat)),
            ("transform of instance 0: it has no inverse", lambda: rt.move(instances=nearly_flat)),
            ("expected vertices or instances", lambda: rt.move()),
            ("move the instances", lambda: clarity.load(self.mesh_file).on(accel="bvh2").move(self.vertices)),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(clarity.UsageError, words):
                wrong()
        with self.assertRaises(clarity.Cancelled):
            rt.move(self.vertices + 1, progress=lambda stage, fraction: False)
        self.equal(rt.closest(origins, directions), before)


if __name__ == "__main__":
    unittest.main(verbosity=2)
