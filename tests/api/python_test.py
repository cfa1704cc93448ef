"""The Python package, against the command line: hits and pictures have to be the same bits.
Run by ctest, with CLARITY_PROGRAM: the program of the build."""
import logging
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tracemalloc
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


class Hits(Case):
    def test_are_those_of_the_program_bit_for_bit(self):
        origins, directions = some_rays(700, 2)
        t_min = np.linspace(0, 0.3, 700, dtype=np.float32)
        t_max = np.where(np.arange(700) % 3 == 0, 1.5, np.inf).astype(np.float32)
        rays = os.path.join(self.folder, "rays.txt")
        with open(rays, "w") as file:
            for row in zip(origins, t_min, directions, t_max):
                file.write(" ".join(text_of(number) for part in row for number in np.ravel(part)) + "\n")
        for path in (self.mesh_file, self.scene_file):
            scene = clarity.load(path)
            for structure in STRUCTURES:
                with self.subTest(path=path, structure=structure):
                    rt = scene.on(accel=structure)
                    hit = rt.closest(origins, directions, t_min, t_max)
                    self.assertTrue(100 < np.count_nonzero(hit.mask) < 700, hit)
                    words = ["trace", path, "--rays", rays, "-o", "-", "--accel", structure]
                    rows = [line.split() for line in self.run_program(*words).splitlines()[1:]]
                    columns = [np.array(column) for column in zip(*rows)]
                    np.testing.assert_array_equal(hit.t, columns[0].astype(np.float32))
                    np.testing.assert_array_equal(hit.prim, columns[1].astype(np.int32))
                    np.testing.assert_array_equal(hit.instance, columns[2].astype(np.int32))
                    np.testing.assert_array_equal(hit.uv, np.stack(columns[3:], -1).astype(np.float32))
                    occluded = self.run_program(*words, "--any").split()[2:]
                    any_hit = rt.any(origins, directions, t_min, t_max)
                    np.testing.assert_array_equal(any_hit, np.array(occluded) == "1")
                    np.testing.assert_array_equal(any_hit, hit.mask)

    def test_of_arrays_are_those_of_the_file(self):
        origins, directions = some_rays(20000, 3)
        from_file = clarity.load(self.mesh_file).on(accel="bvh4").closest(origins, directions)
        faces = self.faces.astype(np.uint32)
        self.equal(clarity.Scene(self.vertices, faces).on(accel="bvh4").closest(origins, directions), from_file)
        wide = np.zeros((len(self.vertices), 7))
        wide[:, 2:5] = self.vertices
        scene = clarity.Scene(wide[:, 2:5], [list(face) for face in self.faces])
        self.equal(scene.on(accel="bvh4").closest(origins, directions), from_file)

    def test_do_not_depend_on_strides_and_types(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        origins, directions = some_rays(24 * 36, 4)
        plain = rt.closest(origins, directions, t_max=1.25)
        self.equal(rt.closest(origins.astype(float), directions, t_max=[1.25]), plain)
        self.equal(rt.closest(np.asfortranarray(origins), directions.astype(">f4"), t_max=1.25), plain)
        backwards = np.zeros((2 * len(origins), 5), np.float64)
        backwards[::-2, ::2] = origins
        self.equal(rt.closest(backwards[::-2, ::2], directions, t_max=1.25), plain)
        packed = np.zeros(len(origins) * 25 + 1, np.uint8)  # not aligned
        records = packed[1:].view(np.dtype([("o", "<f4", 3), ("label", "u1"), ("d", "<f4", 3)]))
        records["o"], records["d"] = origins, directions
        self.equal(rt.closest(records["o"], records["d"], t_max=1.25), plain)
        grid = rt.closest(origins.reshape(24, 36, 3).swapaxes(0, 1), directions.reshape(24, 36, 3).swapaxes(0, 1), t_max=1.25)
        self.assertEqual((grid.t.shape, grid.uv.shape), ((36, 24), (36, 24, 2)))
        np.testing.assert_array_equal(grid.t.T.ravel(), plain.t)
        np.testing.assert_array_equal(grid.prim.T.ravel(), plain.prim)

        fan = rt.closest([0.5, 0.5, 3], directions)
        self.equal(fan, rt.closest(np.tile([0.5, 0.5, 3], (len(directions), 1)), directions))
        table = rt.closest(origins[:8, None], directions[None, :9], t_max=np.full((8, 1), 1.25))
        self.assertEqual(table.t.shape, (8, 9))
        np.testing.assert_array_equal(table.t[3], rt.closest(origins[3], directions[:9], t_max=1.25).t)
        one = rt.closest(origins[5], directions[5], t_max=1.25)
        self.assertEqual((one.t.shape, one.t), ((), plain.t[5]))
        self.assertEqual(rt.closest(np.empty((0, 3)), [0, 0, 1]).t.shape, (0,))

    def test_fill_arrays_that_are_there(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        origins, directions = some_rays(100, 5)
        hit = rt.closest(origins, directions)
        arrays = hit.t, hit.prim, hit.instance, hit.uv
        again = rt.closest(origins[::-1], directions[::-1], out=hit)
        self.assertTrue(again is hit and all(a is b for a, b in zip(arrays, (hit.t, hit.prim, hit.instance, hit.uv))))
        np.testing.assert_array_equal(hit.t, rt.closest(origins, directions).t[::-1])
        occluded = np.zeros(100, bool)
        self.assertIs(rt.any(origins, directions, out=occluded), occluded)
        np.testing.assert_array_equal(occluded, rt.closest(origins, directions).mask)
        for bad in (np.zeros(99, bool), np.zeros(200, bool)[::2], np.zeros(100, np.int8)):
            with self.assertRaisesRegex(clarity.UsageError, "out: expected a writeable array"):
                rt.any(origins, directions, out=bad)
        with self.assertRaisesRegex(clarity.UsageError, "out.t: expected"):
            rt.closest(origins[:7], directions[:7], out=hit)

    def test_of_packed_rays_are_those_of_the_arrays(self):
        scene = clarity.Scene(self.vertices, self.faces)
        for settings in ({"lanes": 1}, {"lanes": 16}):
            rt = scene.on(accel="bvh2", **settings)
            for count in (1, 17, 20000):
                origins, directions = some_rays(count, 9)
                expected = rt.closest(origins, directions, 0.1, 2)
                rays = rt.pack(origins, directions, 0.1, 2)
                origins, directions = origins.copy(), directions.copy()
                hit = clarity.Hit(rays.shape)
                for _ in range(3):
                    self.assertIs(rt.closest(rays, out=hit), hit)
                    self.equal(hit, expected)
                np.testing.assert_array_equal(hit.points(), expected.points())
                np.testing.assert_array_equal(rt.any(rays), expected.mask)
                np.testing.assert_array_equal(rt.closest(rays, mask=255).t, expected.t)
        self.assertEqual(rt.closest(rt.pack(np.empty((0, 3)), [0, 0, 1])).t.shape, (0,))
        for words, wrong in (
            ("another tracer", lambda: scene.on(accel="bvh2").any(rays)),
            ("nothing beside them", lambda: rt.any(rays, directions)),
            ("mask: expected", lambda: rt.any(rays, mask=0)),
            ("out.t: expected", lambda: rt.closest(rays, out=clarity.Hit((7,)))),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(clarity.UsageError, words):
                wrong()

    def test_into_arrays_that_are_there_take_no_memory(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        origins, directions = some_rays(100000, 10)
        rays = rt.pack(origins, directions)
        hit, occluded = rt.closest(rays), rt.any(rays)
        tracemalloc.start()
        try:
            rt.closest(rays, out=hit)
            rt.closest(origins.astype(float)[::2], directions[::2], out=clarity.Hit((50000,)))  # doubles the directions
            most = tracemalloc.get_traced_memory()[1]
            self.assertGreater(most, 50000 * 12)  # numpy tells of its arrays
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            rt.closest(rays, out=hit)
            rt.closest(origins, directions, out=hit)
            rt.any(origins[:, ::-1], directions[:, ::-1], out=occluded)
            self.assertLess(tracemalloc.get_traced_memory()[1] - before, 50000)
        finally:
            tracemalloc.stop()

    def test_of_one_ray_cost_few_steps_of_python(self):
        # About 0.3 us each, of which a call may take 15 us over that of C.
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        ray = np.array([0.5, 0.5, 3], np.float32), np.array([0, 0, -1], np.float32)
        hit, packed = rt.closest(*ray), rt.pack(*ray)
        for name, trace, limit in (
            ("new arrays", lambda: rt.closest(*ray), 55),
            ("into arrays", lambda: rt.closest(*ray, out=hit), 55),
            ("packed", lambda: rt.closest(packed, out=hit), 35),
        ):
            steps = []
            sys.setprofile(lambda frame, event, what: steps.append(what) if event in ("call", "c_call") else None)
            try:
                trace()
            finally:
                sys.setprofile(None)
            with self.subTest(name=name):
                self.assertTrue(8 < len(steps) < limit, steps)

    def test_far_from_the_origin_keep_their_digits(self):
        far = np.array([5e6, -3e6, 7e6])
        scene = clarity.Scene(self.vertices.astype(float) + far, self.faces)
        np.testing.assert_allclose(scene.bounds, clarity.Scene(self.vertices, self.faces).bounds + far, rtol=0, atol=1e-6)
        origins, directions = some_rays(500, 6)
        near = clarity.Scene(self.vertices, self.faces).on(accel="bvh2").closest(origins, directions)
        hit = scene.on(accel="bvh2").closest(origins + far, directions)
        both = near.mask & hit.mask
        self.assertTrue(np.count_nonzero(near.mask != hit.mask) <= 2 and np.count_nonzero(both) > 100)
        self.assertEqual(hit.points().dtype, np.float64)
        np.testing.assert_allclose((hit.points() - far)[both], near.points()[both], rtol=0, atol=2e-6)
        self.assertTrue(np.isnan(hit.points()[~hit.mask]).all())


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
        # Without the narrow rays, whose places in the arrays close up.
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
        for structure in structures:
            with self.subTest(structure=structure):
                rt = clarity.Scene(vertices, faces).on(accel=structure)
                hits = self.expect(rt, soup_rays, *soup_expected)
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
            self.assertEqual(rt.closest(*ray, mask=mask).instance, max(expected, default=-1))
        for mask in (0, 256):
            with self.assertRaisesRegex(clarity.UsageError, "mask: expected"):
                rt.any(*ray, mask=mask)


class Scenes(Case):
    def test_tell_what_is_in_them(self):
        scene = clarity.Scene(self.vertices, self.faces)
        self.assertEqual(scene.info["triangles"], 300)
        np.testing.assert_array_equal(scene.bounds, [self.vertices.min(0), self.vertices.max(0)])
        self.assertIsNone(clarity.Scene(np.empty((0, 3)), np.empty((0, 3), int)).bounds)
        mixed = clarity.load(self.scene_file)
        self.assertEqual((mixed.info["spheres"], mixed.info["planes"], mixed.warnings), (1, 1, mixed.info["warnings"]))

    def test_errors_have_kinds(self):
        scene = clarity.Scene(self.vertices, self.faces)
        rt = scene.on(accel="bvh2")
        usage = clarity.UsageError
        for kind, words, wrong in (
            (clarity.ImportFailed, "no/such.obj", lambda: clarity.load("no/such.obj")),
            (usage, "no scene file", lambda: clarity.load()),
            (usage, r"vertices: expected .* \(n, 3\)", lambda: clarity.Scene(np.zeros((4, 2)), self.faces)),
            (usage, "numbers 0 to 899 do not fit 3", lambda: clarity.Scene(self.vertices[:3], self.faces)),
            (usage, "numbers -1 to", lambda: clarity.Scene(self.vertices, [[0, 1, -1]])),
            (usage, "whole numbers", lambda: clarity.Scene(self.vertices, [[0, 1, 2.5]])),
            (usage, "mesh of arrays", lambda: clarity.Scene([[np.nan, 0, 0]] * 3, [[0, 1, 2]])),
            (usage, "no_tree", lambda: scene.on(accel="no_tree")),
            (usage, "no_setting", lambda: scene.on(no_setting=1)),
            (clarity.DeviceError, "no such device", lambda: scene.on("no such device")),
            (usage, r"directions: expected .* \(\.\.\., 3\)", lambda: rt.closest([0, 0, 0], [1, 2])),
            (usage, "do not fit each other", lambda: rt.any(np.zeros((4, 3)), np.zeros((5, 3)))),
            (usage, "expected numbers", lambda: rt.any([0, 0, 1j], [0, 0, 1])),
            (usage, "no such camera", lambda: rt.render(4, 4, camera="no such camera")),
            (usage, "size", lambda: rt.render(0, 4)),
            (usage, "out: expected", lambda: rt.render(4, 4, out=np.zeros((4, 4), np.float32))),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(kind, words):
                wrong()
        self.assertTrue(issubclass(usage, ValueError) and issubclass(clarity.ImportFailed, clarity.Error))

    def test_tell_their_progress_and_may_be_cancelled(self):
        stages = []
        scene = clarity.load(self.mesh_file, progress=lambda stage, fraction: stages.append(stage))
        scene.on(accel="bvh2", progress=lambda stage, fraction: stages.append(stage))
        self.assertTrue({"building bvh2", "uploading the scene"} <= set(stages), stages)
        with self.assertRaises(clarity.Cancelled):
            scene.on(accel="bvh2", progress=lambda stage, fraction: False)
        with self.assertRaises(ZeroDivisionError):
            scene.on(accel="bvh2", progress=lambda stage, fraction: 1 / 0)

    def test_lend_arrays_and_free_them(self):
        rt = clarity.Scene(self.vertices.copy(), self.faces.astype(np.uint32)).on(accel="bvh2")
        origins, directions = some_rays(100, 7)
        expected = clarity.load(self.mesh_file).on(accel="bvh2").closest(origins, directions)
        self.equal(rt.closest(origins, directions), expected)  # nobody but the tracer holds the arrays
        for _ in range(20):
            clarity.Scene(self.vertices, self.faces)


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

        rt = scene_with(0, 1).on(accel="bvh2")
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
        for words, wrong in (
            ("vertices: there are 7, and the scene has 900", lambda: rt.move(self.vertices[:7])),
            ("vertices: a number is not finite", lambda: rt.move(infinite)),
            (r"vertices: expected an array of shape \(n, 3\)", lambda: rt.move(self.vertices.ravel())),
            ("instances: there are 2, and the scene has 1", lambda: rt.move(instances=np.tile(np.eye(4), (2, 1, 1)))),
            ("transform of instance 0: it has no inverse", lambda: rt.move(instances=flat)),
            ("expected vertices or instances", lambda: rt.move()),
            ("move the instances", lambda: clarity.load(self.mesh_file).on(accel="bvh2").move(self.vertices)),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(clarity.UsageError, words):
                wrong()
        with self.assertRaises(clarity.Cancelled):
            rt.move(self.vertices + 1, progress=lambda stage, fraction: False)
        self.equal(rt.closest(origins, directions), before)


class Pictures(Case):
    def test_are_those_of_the_program(self):
        rt = clarity.load(self.scene_file).on(accel="bvh2")
        for words, settings in ((["--spp", "3", "--tracer", "path"], {"spp": 3, "tracer": "path"}), (["--aov", "t"], {"aov": "t"})):
            with self.subTest(words=words):
                file = os.path.join(self.folder, "picture.pfm")
                camera = "0.5,1,4,0.5,0.5,0.5,40"
                self.run_program("render", self.scene_file, "-q", "--accel", "bvh2", "--size", "40x24", "--camera", camera, "-o", file, *words)
                with open(file, "rb") as stream:
                    kind, size, scale = (stream.readline().decode().split() for _ in range(3))
                    shape = (24, 40, 3) if kind == ["PF"] else (24, 40)
                    expected = np.frombuffer(stream.read(), "<f4" if float(scale[0]) < 0 else ">f4").reshape(shape)[::-1]
                self.assertEqual(size, ["40", "24"])
                picture = rt.render(40, 24, camera=[float(number) for number in camera.split(",")], **settings)
                self.assertEqual((picture.dtype, picture.shape), (np.float32, shape))
                np.testing.assert_array_equal(picture, expected)
                out = np.empty(shape, np.float32)
                self.assertIs(rt.render(40, 24, camera=camera, out=out, **settings), out)
                np.testing.assert_array_equal(out, expected)


class Processes(Case):
    def test_import_and_end_cleanly(self):
        lines = "import clarity"
        used = """
import clarity, numpy
scene = clarity.Scene(numpy.eye(3), [[0, 1, 2]])
rt = scene.on(accel="bvh2")
assert rt.any([0, 0, 0], [1, 1, 1])
"""
        for i in range(10 if QUICK else 50):
            result = self.run_python(used if i % 5 == 0 else lines)
            self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_from_two_threads(self):
        origins, directions = some_rays(30000, 8)
        expected = clarity.Scene(self.vertices, self.faces).on(accel="bvh2").closest(origins, directions)
        found = {}

        def trace(name):
            rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
            found[name] = [rt.closest(origins, directions) for _ in range(4)]
            try:
                rt.any(origins, directions, t_max="far")
            except ValueError as error:
                found[name, "error"] = error

        threads = [threading.Thread(target=trace, args=(name,)) for name in ("a", "b")]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for name in ("a", "b"):
            self.assertIn((name, "error"), found)
            for hit in found[name]:
                self.equal(hit, expected)

    def test_that_were_forked_are_refused(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        child = os.fork()
        if child == 0:
            code = 1
            try:
                rt.any([0, 0, 0], [1, 1, 1])
            except clarity.ForkError:
                code = 0
            finally:
                os._exit(code)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assertFalse(rt.any([0, 0, 9], [0, 0, 1]))

    def test_hear_ctrl_c_in_a_long_call(self):
        lines = """
import clarity, numpy, time
random = numpy.random.default_rng(1)
scene = clarity.Scene(random.random((30000, 3)), numpy.arange(30000).reshape(-1, 3))
rt = scene.on(accel="linear")
rt.any([0, 0, 0], [1, 1, 1])
rays = random.random((2000000, 3))
try:
    rt.closest([0, 0, 0], rays, progress=lambda stage, fraction: print("going", flush=True))
except KeyboardInterrupt:
    print("interrupted", time.monotonic(), flush=True)
print(bool(rt.any([0, 0, 0], [0, 0, -1])))
"""
        with subprocess.Popen([sys.executable, "-c", lines], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "going\n")
            time.sleep(0.3)
            sent = time.monotonic()
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=120)
            took = time.monotonic() - sent
        words = out.replace("going\n", "").split()
        self.assertEqual((process.returncode, words[:1], words[2:], err), (0, ["interrupted"], ["False"], ""), out)
        heard = float(words[1]) - sent
        logging.getLogger(__name__).warning("Ctrl-C was heard after %.2f s, the end came after %.2f s", heard, took)
        self.assertLess(heard, 2)  # 0.5 s on a machine that does nothing else

    def test_of_another_version_are_refused(self):
        package = os.path.join(self.folder, "other", "clarity")
        shutil.copytree(os.path.dirname(clarity.__file__), package)
        with open(os.path.join(package, "clarity.h"), "a") as file:
            file.write("/* another version */\n")
        library = clarity._binding.library._name
        environment = {**os.environ, "PYTHONPATH": os.path.dirname(package), "CLARITY_LIBRARY": library}
        result = self.run_python("import clarity", env=environment)
        self.assertIn("ImportError", result.stderr)
        self.assertIn("was built with another header", result.stderr)

    def test_follow_the_page(self):
        page = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/python.md")
        with open(page) as file:
            blocks = re.findall(r"```python\n(.*?)```", file.read(), re.S)
        self.assertEqual(len(blocks), 1)
        result = self.run_python(blocks[0].replace("640, 480", "64, 48"), cwd=self.folder)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"79202 triangles(.|\n)*\(200, 200\) 1\.90(.|\n)*in shadow: 0\.4")
        depth = np.load(os.path.join(self.folder, "depth.npy"))
        self.assertTrue(depth.shape == (48, 64) and 0.2 < np.isfinite(depth).mean() < 0.3 and depth.min() > 1)

    def test_log_to_logging(self):
        lines = """
import logging, os
logging.basicConfig(level=logging.WARNING, format="%(name)s %(levelname)s %(message)s")
os.environ["CLARITY_PLUGIN_PATH"] = "/no_such_folder"
import clarity
clarity.Scene([[0, 0, 0]] * 3, [[0, 1, 2]])
"""
        self.assertRegex(self.run_python(lines).stderr, "clarity WARNING .*/no_such_folder")


if __name__ == "__main__":
    unittest.main(verbosity=2)
