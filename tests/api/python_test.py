"""The Python package, against the command line: hits and pictures have to be the same bits."""
import contextlib
import gc
import io
import os
import sys
import tracemalloc
import types
import unittest

import numpy as np

import clarity
from python_case import Case, QUICK, STRUCTURES, some_rays, soup, text_of


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
                if QUICK and (path == self.mesh_file) != (structure == "grid"):
                    continue
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

    def test_of_arrays_of_other_libraries(self):
        origins, directions = some_rays(90, 18)
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        expected = rt.closest(origins, directions)

        class Dlpack:  # as of other libraries: this protocol alone
            def __init__(self, array):
                self.array = array

            def __dlpack_device__(self):
                return self.array.__dlpack_device__()

            def __dlpack__(self, **options):
                return self.array.__dlpack__(**options)

        class OnGpu:
            def __dlpack_device__(self):
                return 2, 0

            def __dlpack__(self, **_):
                raise BufferError("it lies on a GPU")

        def interface(array):
            return types.SimpleNamespace(__array_interface__=array.__array_interface__, owner=array)

        wide = np.zeros((180, 7), np.float32)
        wide[::-2, 1:7:2] = origins
        for lent in (interface, Dlpack):
            self.equal(rt.closest(lent(origins), lent(directions)), expected)
            self.equal(rt.closest(lent(wide[::-2, 1:7:2]), lent(directions.astype(float))), expected)
            self.equal(rt.closest(lent(np.asfortranarray(origins)), directions), expected)
            self.assertEqual(rt.closest(lent(origins[:0]), lent(directions[:0])).t.shape, (0,))
            scene = clarity.Scene(lent(self.vertices), lent(self.faces.astype(np.uint32)))
            self.equal(scene.on(accel="bvh2").closest(origins, directions), expected)
        frozen = origins.copy()
        frozen.flags.writeable = False
        self.equal(rt.closest(frozen, np.broadcast_to(directions, (90, 3))), expected)
        for kind in (np.float16, np.longdouble, ">f8", np.int8):
            some = (8 * origins).astype(kind)
            self.equal(rt.closest(some, directions), rt.closest(some.astype(float), directions))
        for order in "<>":
            scene = clarity.Scene(self.vertices.astype(order + "f4"), self.faces.astype(order + "i8"))
            self.equal(scene.on(accel="bvh2").closest(origins, directions), expected)
        for words, wrong in (
            ("origins: numpy cannot read it: .*(GPU|device)", lambda: rt.any(OnGpu(), directions)),
            ("origins: numpy cannot read it: .*inhomogeneous", lambda: rt.any([[0, 0, 0], [1]], directions)),
            ("directions: expected numbers", lambda: rt.any(origins, [[None] * 3] * 90)),
            ("t_max: expected numbers", lambda: rt.any(origins, directions, t_max="far")),
            ("out: expected a writeable", lambda: rt.any(origins, directions, out=np.broadcast_to(np.zeros(1, bool), 90))),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(clarity.UsageError, words):
                wrong()

    def test_fill_arrays_that_are_there(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        origins, directions = some_rays(100, 5)
        hit = rt.closest(origins, directions)
        arrays = hit.t, hit.prim, hit.instance, hit.uv
        again = rt.closest(origins[::-1], directions[::-1], out=hit)
        self.assertTrue(again is hit and all(a is b for a, b in zip(arrays, (hit.t, hit.prim, hit.instance, hit.uv))))
        np.testing.assert_array_equal(hit.t, rt.closest(origins, directions).t[::-1])
        brief = rt.closest(origins[::-1], directions[::-1], brief=True)
        self.assertTrue(brief.uv is None and brief.instance is None)
        for _ in range(2):
            np.testing.assert_array_equal(brief.t, hit.t)
            np.testing.assert_array_equal(brief.prim, hit.prim)
            np.testing.assert_array_equal(brief.points(), hit.points())
            brief.t[:] = 7
            self.assertIs(rt.closest(origins[::-1], directions[::-1], out=brief), brief)
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
        for settings in ({"lanes": 16},) if QUICK else ({"lanes": 1}, {"lanes": 16}):
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
        with self.assertRaises(clarity.Cancelled):
            rt.pack(origins, directions, progress=lambda stage, fraction: False)
        for words, wrong in (
            ("another tracer", lambda: scene.on(accel="bvh2").any(rays)),
            ("nothing beside them", lambda: rt.any(rays, directions)),
            ("mask: expected", lambda: rt.any(rays, mask=0)),
            ("out.t: expected", lambda: rt.closest(rays, out=clarity.Hit((7,)))),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(clarity.UsageError, words):
                wrong()

    def test_of_many_rays_stay_on_the_device_until_they_are_read(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        origins, directions = some_rays(30000, 11)
        arrays = {"t": 4, "prim": 4, "instance": 4, "uv": 8}
        expected = clarity.Hit((30000,))
        rt.closest(origins, directions, out=expected)
        for name, bytes_of_ray in arrays.items():
            before = rt.info["bytes_from_device"]
            hit = rt.closest(origins.reshape(100, 300, 3), directions.reshape(100, 300, 3))
            self.assertEqual(rt.info["bytes_from_device"], before)
            array = getattr(hit, name)
            self.assertIs(getattr(hit, name), array)
            copied = rt.info["bytes_from_device"] - before
            # A CPU wrote the array itself; of a scene without instances nobody wrote any.
            self.assertIn(copied, (0, bytes_of_ray * 30000))
            np.testing.assert_array_equal(array.reshape(getattr(expected, name).shape), getattr(expected, name))
            self.assertIs(rt.closest(origins[::-1].reshape(100, 300, 3), directions[::-1].reshape(100, 300, 3), out=hit), hit)
            np.testing.assert_array_equal(array.reshape(getattr(expected, name).shape)[::-1], getattr(expected, name), name)
            self.assertEqual(rt.info["bytes_from_device"] - before, 2 * copied)
        before = rt.info
        rt.closest(origins, directions, out=expected)  # into arrays of the caller's own
        after = rt.info
        self.assertEqual(after["bytes_from_device"] - before["bytes_from_device"], 16 * 30000)
        self.assertEqual(after["bytes_to_device"] - before["bytes_to_device"], 32 * 30000)
        self.assertEqual((after["rays"] - before["rays"], after["accel"]), (30000, "bvh2"))

    def test_on_a_device_outlive_their_tracer_and_leave_it_for_other_arrays(self):
        scene = clarity.Scene(self.vertices, self.faces)
        rt, other = scene.on(accel="bvh2"), scene.on(accel="bvh2")
        origins, directions = some_rays(20000, 12)
        hit = rt.closest(origins, directions)
        expected = other.closest(origins, directions)
        own = np.empty(20000, np.float32)
        mixed = rt.closest(origins, directions)
        prim = mixed.prim
        mixed.t = own
        rt.closest(origins, directions, out=mixed)
        self.assertTrue(mixed.t is own and mixed.prim is prim)
        self.equal(mixed, expected)
        moved = rt.closest(origins[::-1], directions[::-1])
        t = moved.t
        self.assertIs(other.closest(origins, directions, out=moved).t, t)
        self.equal(moved, expected)
        with self.assertRaisesRegex(clarity.UsageError, r"out.t: expected .* \(7,\)"):
            rt.closest(origins[:7], directions[:7], out=hit)
        failed = rt.closest(origins, directions)
        with self.assertRaises(clarity.Cancelled):
            rt.closest(origins, directions, out=failed, progress=lambda stage, fraction: False)
        with self.assertRaisesRegex(clarity.UsageError, "failed or was cancelled"):
            failed.t
        array = rt.closest(origins, directions).t  # of hits that nobody else holds
        del rt, scene, moved
        gc.collect()
        self.equal(hit, expected)
        np.testing.assert_array_equal(array, expected.t)

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

    @unittest.skipIf(QUICK, "40 million rays")
    def test_of_pieces_take_the_memory_of_one(self):
        # 110 MiB above the first call; 168 to 196 where each larger batch has new buffers and the smaller ones stay.
        lines = """
import clarity, numpy, resource
def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
rt = clarity.Scene(numpy.eye(3), [[0, 1, 2]]).on("cpu", accel="bvh2", lanes=16)
directions = numpy.ones((1000000, 3), numpy.float32)
hit = clarity.Hit((1000000,))
for array in (hit.t, hit.prim, hit.instance, hit.uv):
    array[:] = 0
rt.closest([0, 0, 0], directions[:30000])  # the kernel is compiled
before = peak()
for i in range(40):
    rt.closest([0, 0, 0], directions, out=hit)
    if i == 9:
        ten = peak()
print(ten - before, peak() - before)
"""
        result = self.run_python(lines)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        ten, forty = map(float, result.stdout.split())
        self.assertTrue(1 < ten <= forty < 140, result.stdout)

    def test_of_one_ray_cost_few_steps_of_python(self):
        # About 0.3 us each, of which a call may take 15 us over that of C.
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        ray = np.array([0.5, 0.5, 3], np.float32), np.array([0, 0, -1], np.float32)
        hit, packed = rt.closest(*ray), rt.pack(*ray)
        for name, trace, limit in (
            ("new arrays", lambda: rt.closest(*ray), 43),
            ("into arrays", lambda: rt.closest(*ray, out=hit), 34),
            ("packed", lambda: rt.closest(packed, out=hit), 17),
        ):
            steps = []
            sys.setprofile(lambda frame, event, what: steps.append(what) if event in ("call", "c_call") else None)
            try:
                trace()
            finally:
                sys.setprofile(None)
            with self.subTest(name=name):
                self.assertTrue(8 < len(steps) < limit, steps)

    def test_of_directions_that_are_none_are_none(self):
        vertices, faces = soup(300, 3)
        origins, directions = some_rays(400, 4)
        nan, infinity = np.nan, np.inf
        none = np.array([[0, 0, 0], [-0., 0, -0.], [nan, 0, -1], [1, nan, nan], [0, 0, -infinity], [infinity, 1, 0], [1e-40, 0, 0],
                         [-8e-19, 8e-19, 0], [0, 1e300, 0]])
        mixed, none = np.array(directions, np.float64), none[np.arange(200) % len(none)]
        mixed[1::2] = none
        rt = clarity.Scene(vertices, faces).on(accel="bvh2")
        right, counts = rt.closest(origins, directions), rt.count(origins, directions)
        self.assertGreater(right.mask[1::2].sum(), 50)
        with np.errstate(over="ignore"):
            narrow = mixed.astype(np.float32)
        for given in (narrow, mixed):
            with self.subTest(type=given.dtype):
                hit = rt.closest(origins, given)
                np.testing.assert_array_equal(hit.t[::2], right.t[::2])
                self.assertTrue(np.all(np.isinf(hit.t[1::2])) and np.all(hit.prim[1::2] == -1))
                self.assertFalse(rt.any(origins, given)[1::2].any() or rt.any(rt.pack(origins, given))[1::2].any())
                np.testing.assert_array_equal(rt.count(origins, given), np.where(np.arange(400) % 2, 0, counts))
                self.assertFalse(np.any(rt.all(origins, given).ray % 2))
        for direction in none[:9]:
            self.assertEqual(rt.closest(origins[0], direction).t, infinity)
        for power in (-50, -20, 20, 60, 110):  # any other length is right
            with self.subTest(power=power):
                hit = rt.closest(origins, np.ldexp(directions, power))
                np.testing.assert_array_equal(hit.prim, right.prim)
                np.testing.assert_array_equal(np.ldexp(hit.t, power), right.t)
                np.testing.assert_array_equal(rt.count(origins, np.ldexp(directions, power)), counts)
                np.testing.assert_array_equal(rt.all(origins, np.ldexp(directions, power)).t,
                                              np.ldexp(rt.all(origins, directions).t, -power))

    def test_points_are_of_the_rays_that_were_traced(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        wide = np.zeros((20000, 7), np.float32)
        changed = "{}: the array was changed after the call"
        for count in (1, 100, 20000):  # 20000 in float32 are 240 kB
            for kind in (np.float32, np.float64):
                rays = [array.astype(kind) for array in some_rays(count, 31)]
                fields = wide[:count, :3] if kind is np.float32 else np.asfortranarray(rays[0])
                fields[:] = rays[0]
                spread = np.broadcast_to(rays[0][:1].copy(), (count, 3))
                for origins, refused in ((rays[0], count == 20000), (fields, count == 20000 and kind is np.float64), (spread, False)):
                    for name, ask in (
                        ("closest", lambda: rt.closest(origins, rays[1])),
                        ("brief", lambda: rt.closest(origins, rays[1], brief=True)),
                        ("out", lambda: rt.closest(origins, rays[1], out=clarity.Hit((count,)))),
                        ("packed", lambda: rt.closest(rt.pack(origins, rays[1]))),
                        ("all", lambda: rt.all(origins, rays[1])),
                    ):
                        with self.subTest(count=count, kind=kind, name=name):
                            expected, later = ask().points(), ask()
                            of = origins if origins.base is None or origins is fields else spread.base
                            before = of.copy()
                            of[-1, 0] += 1  # one number of all
                            if refused:
                                with self.assertRaisesRegex(clarity.UsageError, changed.format("origins")):
                                    later.points()
                            else:
                                np.testing.assert_array_equal(later.points(), expected)
                            of[:] = before
                            np.testing.assert_array_equal(later.points(), expected)
                            rays[1][:] = rays[1][::-1].copy()
                            if count == 20000:
                                with self.assertRaisesRegex(clarity.UsageError, changed.format("directions")):
                                    later.points()
                            else:
                                np.testing.assert_array_equal(later.points(), expected)
                            rays[1][:] = rays[1][::-1].copy()
        # A position that moves on in place.
        position, scans = np.array([0.5, 0.5, 3]), []
        for _ in range(3):
            scans.append(rt.closest(position, [0, 0, -1]))
            position += [0.1, 0, 0]
        np.testing.assert_allclose([scan._rays.points(1)[0] for scan in scans], [0.5, 0.6, 0.7])
        failed = rt.closest(*rays)
        with self.assertRaises(clarity.Cancelled):
            rt.closest(*rays, out=failed, progress=lambda stage, fraction: False)
        for hit in (failed, clarity.Hit((3,))):
            with self.assertRaisesRegex(clarity.UsageError, "no rays were traced into"):
                hit.points()

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
            (usage, "a number is beyond 1e15: 1e.30 of vertex 0", lambda: clarity.Scene(np.eye(3) * 1e30, [[0, 1, 2]])),
            (usage, "a number is beyond 1e15: 1e.30 of vertex 0", lambda: clarity.Scene(np.eye(3, dtype="f") * np.float32(1e30), [[0, 1, 2]])),
            (usage, "within 1e-30, less than 1e-17", lambda: clarity.Scene(np.eye(3) * 1e-30, [[0, 1, 2]])),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(kind, words):
                wrong()
        self.assertTrue(issubclass(usage, ValueError) and issubclass(clarity.ImportFailed, clarity.Error))

    def test_refuse_wrong_arguments_with_a_word_each(self):
        # Each names the argument and what was found; none ends in another exception, a signal, or a kernel that is compiled.
        scene = clarity.Scene(self.vertices, self.faces)
        rt = scene.on(accel="bvh2")
        ray = [0.5, 0.5, 9], [0, 0, -1]
        rays = some_rays(5000, 32)
        packed, one, many = rt.pack(*rays), rt.closest(*ray), rt.closest(*rays)
        broken, ragged = "a\0b", [[0, 0, 0], [1]]

        class Wrong:
            """It raises what numpy does not expect."""

            def __array__(self, *_, **__):
                raise RuntimeError("no array")

        masked = np.ma.array(self.vertices, mask=self.vertices > 1)
        table = {
            clarity.Scene: [
                ("vertices", lambda x: clarity.Scene(x, self.faces), [None, 3, "abc", ragged, {}, set(), masked, Wrong(), b"abc", [[1j] * 3]]),
                ("faces", lambda x: clarity.Scene(self.vertices, x), [None, 3, "abc", ragged, {}, [[0, 1, 2**40]], [[0, 1, 10**30]], [[-1, 0, 1]], Wrong()]),
                ("progress", lambda x: clarity.Scene(self.vertices, self.faces, progress=x), [3, "yes", [print]]),
                ("load", lambda x: clarity.load(x), [None, 3, [self.mesh_file], broken, {}]),
            ],
            scene.on: [
                ("device", lambda x: scene.on(x), [3, ["gpu"], b"gpu", broken, "\ud800", 1.5]),
                ("accel", lambda x: scene.on(accel=x), [3, ["bvh2"], {}, broken]),
                ("setting `lanes`", lambda x: scene.on(accel="bvh2", lanes=x), [None, {}, object(), broken, [object()], []]),
                ("lanes", lambda x: scene.on(accel="bvh2", lanes=x), ["many", 1.5, -1, float("nan"), 10**30, True]),
                ("setting", lambda x: scene.on(accel="bvh2", **{x: 1}), ["", "a=b", broken, "no_setting"]),
                ("progress", lambda x: scene.on(accel="bvh2", progress=x), [3, "yes"]),
            ],
            rt.closest: [
                ("origins", lambda x: rt.closest(x, ray[1]), [None, 3, "abc", ragged, {}, [], [1, 2], Wrong(), one, rt]),
                ("directions", lambda x: rt.closest(ray[0], x), [None, 3, "abc", ragged, {}, [1, 2], Wrong()]),
                ("t_min", lambda x: rt.closest(*ray, t_min=x), ["near", ragged, {}, 1j]),
                ("rays of the shapes", lambda x: rt.closest(*rays, t_max=x), [[1, 2], np.ones((3, 3))]),
                ("mask", lambda x: rt.any(*ray, mask=x), [0, 256, -1, 1.5, "8", np.array([1, 2]), 10**30, [1], {}]),
                ("brief", lambda x: rt.closest(*ray, brief=x), ["yes", None, 1, [True]]),
                ("brief", lambda x: rt.closest(*ray, brief=True, out=x), [one]),
                ("out", lambda x: rt.closest(*ray, out=x), [np.zeros(3), 3, "hit", rt, [one], many]),
                ("out", lambda x: rt.any(*ray, out=x), [one, 3, [False], np.zeros(3, bool), np.zeros((), int)]),
                ("out", lambda x: rt.count(*ray, out=x), [one, 3, np.zeros((), np.int32)]),
                ("progress", lambda x: rt.closest(*ray, progress=x), [3, "yes"]),
                ("packed rays", lambda x: rt.count(x), [packed]),
                ("packed rays", lambda x: rt.all(x), [packed]),
                ("packed", lambda x: rt.pack(x), [packed]),
                ("nothing beside them", lambda x: rt.closest(packed, t_max=x), [1]),
            ],
            rt.move: [
                ("vertices", lambda x: rt.move(x), [3, "abc", ragged, {}, self.vertices * 1e30, self.vertices * 1e-30, self.vertices[:7], Wrong()]),
                ("instance", lambda x: rt.move(instances=x), [3, "abc", np.eye(4), np.zeros((1, 3, 4)), np.eye(4)[None] * np.nan, np.eye(4)[None] * 1e30]),
                ("progress", lambda x: rt.move(self.vertices, progress=x), [3]),
            ],
            rt.render: [
                ("width", lambda x: rt.render(x, 4), [None, 0, -1, 4.5, "4", 10**30, [4]]),
                ("height", lambda x: rt.render(4, x), [None, 20000]),
                ("size", lambda x: rt.render(4, 4, size=x), ["8x8"]),
                ("camera", lambda x: rt.render(4, 4, camera=x), [3j, [], ["a"], {}, b"abc", [None], broken, [1, 2], [float("nan")] * 7]),
                ("light", lambda x: rt.render(4, 4, light=x), [3j, [], {}, broken]),
                ("out", lambda x: rt.render(4, 4, out=x), [3, one, np.zeros((4, 4, 3))]),
                ("spp", lambda x: rt.render(4, 4, spp=x), [0, -1, "many", True, 10**30, float("inf")]),
                ("setting `aov`", lambda x: rt.render(4, 4, aov=x), [None]),
                ("denoise", lambda x: rt.render(4, 4, denoise=x), [True, "on", "no_such"]),
                ("denoise", lambda x: rt.render(4, 4, tracer="path", denoise=x, aov="t"), [True]),
                ("denoise", lambda x: scene.on(accel="bvh2", denoise=x).render(4, 4), [True]),
                ("strategy", lambda x: rt.render(4, 4, strategy=x), ["nee"]),
            ],
            clarity.Hit: [
                ("shape", lambda x: clarity.Hit(x), [None, "abc", (-1,), (1.5,), [None]]),
                ("brief", lambda x: clarity.Hit(3, x), ["yes"]),
            ],
            clarity.check: [
                ("check", lambda x: clarity.check(x), [3, None, broken, [1]]),
                ("only", lambda x: clarity.check("bvh2", only=x), [{}, object(), broken]),
                ("bench", lambda x: clarity.bench(x), [3, None]),
            ],
            clarity.trimesh: [
                ("mesh", lambda x: clarity.trimesh.RayMeshIntersector(x), [None, 3, self.mesh_file]),
                ("max_hits", lambda x: clarity.trimesh.RayMeshIntersector(scene_mesh).intersects_id([ray[0]], [ray[1]], max_hits=x), [-1, 1.5, "all"]),
                ("ray_origins", lambda x: clarity.trimesh.RayMeshIntersector(scene_mesh).intersects_any(x, [ray[1]]), [None, "abc", ragged, 3]),
            ],
        }
        scene_mesh = types.SimpleNamespace(vertices=self.vertices, faces=self.faces)
        for rows in table.values():
            for words, wrong, values in rows:
                for value in values:
                    with self.subTest(words=words, value=repr(value)[:60]), self.assertRaisesRegex(clarity.UsageError, words):
                        wrong(value)
        for words, wrong in (
            ("one ray", lambda: len(one)),
            ("one ray", lambda: len(rt.pack(*ray))),
            ("made by Scene.on", lambda: clarity.Tracer(scene, "", "", {}, None)),
            (r"made by Tracer.pack\(", lambda: clarity.Packed(one, 7)),
            (r"made by Tracer.all\(", lambda: clarity.AllHits(one, 7)),
        ):
            with self.subTest(words=words), self.assertRaisesRegex(TypeError, words):
                wrong()
        for name in ("shape", "brief"):
            with self.assertRaises(AttributeError):  # the memory of hits does not grow with it
                setattr(many, name, (10**6,))
        with self.assertRaises(AttributeError):
            packed.shape = (10**6,)
        self.assertEqual(repr(clarity.Scene.__new__(clarity.Scene)), "<clarity.Scene that was not made>")
        with self.assertRaisesRegex(clarity.UsageError, "`scene` is null"):
            clarity.Scene.__new__(clarity.Scene).bounds
        self.equal(rt.closest(*rays), many)  # after all of them

    def test_take_what_is_meant(self):
        scene = clarity.Scene(self.vertices, self.faces)
        rt = scene.on(None, "bvh2")
        ray = [0.5, 0.5, 9], [0, 0, -1]
        self.equal(rt.closest(*ray, mask=np.uint8(255), brief=np.False_), rt.closest(*ray))
        self.assertEqual(clarity.Hit(3).shape, (3,))
        picture = rt.render(np.int32(8), 8, camera=np.array([0.5, -1, 1, 0.5, 0.5, 0, 32]), denoise=False)
        np.testing.assert_array_equal(rt.render(8, 8, camera="0.5,-1,1,0.5,0.5,0,32", denoise="off"), picture)
        self.assertEqual(repr(rt), f"<clarity.Tracer: bvh2 on {rt.info['device']}, of <clarity.Scene: 300 triangles>>")
        self.assertEqual(repr(clarity.load(self.scene_file)), "<clarity.Scene: 300 triangles, 1 sphere, 1 plane>")
        self.assertEqual(repr(clarity.Scene(np.empty((0, 3)), np.empty((0, 3), int))), "<clarity.Scene: nothing to hit>")

    def test_are_not_asked_by_the_functions_that_they_call(self):
        scene = clarity.Scene(self.vertices, self.faces)
        rt = scene.on(accel="bvh2")
        for asked in (lambda: rt.any([0, 0, 0], [0, 0, 1]), lambda: rt.info, lambda: scene.bounds):
            with self.assertRaisesRegex(clarity.UsageError, "called by a function that it calls itself"):
                rt.closest(*some_rays(5000, 33), progress=lambda stage, fraction: asked())
        with self.assertRaises(clarity.Cancelled):
            rt.any(*some_rays(5000, 33), progress=lambda stage, fraction: np.False_)

    def test_whose_arrays_were_changed_are_no_mesh(self):
        faces = self.faces.astype(np.uint32)
        scene = clarity.Scene(self.vertices, faces)
        rt = scene.on(accel="bvh2")
        faces += 10**6  # not allowed; builders would read anywhere
        for wrong in (lambda: scene.on(accel="bvh2"), lambda: rt.move(self.vertices)):
            with self.assertRaisesRegex(clarity.UsageError, "changed after it was made"):
                wrong()

    def test_of_tracers_keep_their_arrays(self):
        vertices, faces = self.vertices.copy(), self.faces.astype(np.uint32)
        rt = clarity.Scene(vertices, faces).on(accel="bvh2")
        held = sys.getrefcount(vertices), sys.getrefcount(faces)
        rt.scene = None  # anybody may write this
        gc.collect()
        self.assertGreaterEqual(sys.getrefcount(vertices), held[0] - 1)
        self.assertIs(rt._lent[0], vertices)

    def test_tell_their_progress_and_may_be_cancelled(self):
        stages = []
        scene = clarity.load(self.mesh_file, progress=lambda stage, fraction: stages.append(stage))
        scene.on(accel="bvh2", progress=lambda stage, fraction: stages.append(stage))
        self.assertTrue({"building bvh2", "uploading the scene"} <= set(stages), stages)
        with self.assertRaises(clarity.Cancelled):
            scene.on(accel="bvh2", progress=lambda stage, fraction: False)
        with self.assertRaises(ZeroDivisionError):
            scene.on(accel="bvh2", progress=lambda stage, fraction: 1 / 0)

    def test_show_their_progress_in_terminals_and_notebooks_alone(self):
        class Terminal(io.StringIO):
            def isatty(self):
                return True

        class Notebook(io.StringIO):
            pass

        Notebook.__module__ = "ipykernel.iostream"  # as of notebooks' own
        scene = clarity.Scene(self.vertices, self.faces)
        for stream, shown in ((Terminal(), True), (Notebook(), True), (io.StringIO(), False)):
            with self.subTest(stream=stream), contextlib.redirect_stderr(stream):
                scene.on(accel="bvh2", progress=True)
                written = stream.getvalue()
                self.assertEqual("\rbuilding bvh2" in written, shown)
                self.assertTrue(not shown or written.endswith(" \r"), written)
                self.assertEqual(written.strip("\r ").count("\n"), 0)

    def test_lend_arrays_and_free_them(self):
        rt = clarity.Scene(self.vertices.copy(), self.faces.astype(np.uint32)).on(accel="bvh2")
        origins, directions = some_rays(100, 7)
        expected = clarity.load(self.mesh_file).on(accel="bvh2").closest(origins, directions)
        self.equal(rt.closest(origins, directions), expected)  # nobody but the tracer holds the arrays
        vertices, faces = self.vertices.copy(), self.faces.astype(np.uint32)
        scene = clarity.Scene(vertices, faces)
        vertices += np.float32([0, 0, 1])  # not allowed, but it shows that the scene reads this memory
        lifted = scene.on(accel="bvh2").closest(origins, directions)
        self.equal(lifted, clarity.Scene(vertices, faces).on(accel="bvh2").closest(origins, directions))
        self.assertTrue((lifted.t != expected.t).any())
        for _ in range(20):
            clarity.Scene(self.vertices, self.faces)
        self.assertGreater(np.float32(1e-40) * np.float32(0.5), 0)  # no driver has changed how this thread rounds to zero


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


if __name__ == "__main__":
    unittest.main(verbosity=2)
