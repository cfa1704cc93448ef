"""The methods of trimesh, against each triangle for itself. Debian has no trimesh: a mesh is an object with arrays."""
import types
import unittest

import numpy as np

import clarity
from python_case import Case, brute_force, some_rays


def ball(rings=10, columns=16):
    """A closed surface around the origin with the radius 1."""
    angle = np.linspace(0, np.pi, rings + 1)[1:-1, None]
    around = np.linspace(0, 2 * np.pi, columns, endpoint=False)
    ring = np.stack(np.broadcast_arrays(np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), np.cos(angle)), -1)
    vertices = np.concatenate([ring.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    first, last = len(vertices) - 2, len(vertices) - 1
    faces = []
    for k in range(columns):
        n = (k + 1) % columns
        faces += [[first, k, n], [last, (rings - 2) * columns + n, (rings - 2) * columns + k]]
        for r in range(rings - 2):
            a, b = r * columns, (r + 1) * columns
            faces += [[a + k, b + k, b + n], [a + k, b + n, a + n]]
    return types.SimpleNamespace(vertices=vertices, faces=np.array(faces))


class Intersector(Case):
    def test_hits_are_those_of_brute_force(self):
        mesh = types.SimpleNamespace(vertices=self.vertices.astype(np.float64), faces=self.faces)
        mesh.ray = clarity.trimesh.RayMeshIntersector(mesh, accel="bvh2")
        origins, directions = some_rays(800, 21)
        narrow = brute_force(mesh.vertices, mesh.faces, origins, directions, 0, 1e9)[3]
        origins, directions = origins[~narrow], directions[~narrow]
        ray, prim, t, _ = brute_force(mesh.vertices, mesh.faces, origins, directions, 0, 1e9)
        where = origins[ray] + t[:, None] * directions[ray]
        first = np.unique(ray, return_index=True)[1]
        self.assertGreater(np.bincount(ray).max(), 2)
        firsts = np.full(len(origins), -1)
        firsts[ray[first]] = prim[first]

        np.testing.assert_array_equal(mesh.ray.intersects_any(origins, directions), firsts >= 0)
        found = mesh.ray.intersects_first(origins, directions)
        self.assertEqual(found.dtype, np.int64)
        np.testing.assert_array_equal(found, firsts)
        for multiple, most, chosen in (
            (True, None, slice(None)),
            (False, None, first),
            (True, 2, np.arange(len(ray)) - first[np.searchsorted(ray[first], ray)] < 2),
        ):
            with self.subTest(multiple=multiple, most=most):
                triangles, rays = mesh.ray.intersects_id(origins, directions, multiple_hits=multiple, max_hits=most)
                np.testing.assert_array_equal(triangles, prim[chosen])
                np.testing.assert_array_equal(rays, ray[chosen])
                same = mesh.ray.intersects_id(origins, directions, multiple, most, return_locations=True)
                locations, rays, triangles = mesh.ray.intersects_location(origins, directions, multiple, most)
                np.testing.assert_allclose(locations, where[chosen], rtol=0, atol=1e-4)
                np.testing.assert_array_equal(rays, ray[chosen])
                np.testing.assert_array_equal(triangles, prim[chosen])
                np.testing.assert_array_equal(same[2], locations)
        self.assertEqual([len(part) for part in mesh.ray.intersects_location(origins[:0], directions[:0])], [0, 0, 0])

    def test_points_are_inside_or_outside(self):
        mesh = ball()
        query = clarity.trimesh.RayMeshIntersector(mesh, accel="bvh2")
        points = np.random.default_rng(22).uniform(-1.2, 1.2, (3000, 3))
        corners = mesh.vertices[mesh.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        outward = np.sign(np.sum(normals * corners.mean(1), -1))

        def outside_by(points):
            """The ball is convex: a point is inside if it is behind all faces."""
            sides = np.sum(normals * (points[:, None] - corners[:, 0]), -1) / np.linalg.norm(normals, axis=1)
            return (sides * outward).max(1)

        highest = outside_by(points)
        sure = np.abs(highest) > 1e-4
        self.assertTrue(500 < np.count_nonzero(highest < 0) < 2500)
        np.testing.assert_array_equal(query.contains_points(points)[sure], highest[sure] < 0)
        self.assertFalse(query.contains_points(1.2 * mesh.vertices).any())
        # From these points a ray along the first direction passes a vertex or an edge, where it hits several triangles or none.
        direction = clarity.trimesh._DIRECTIONS[0]
        targets = np.concatenate([mesh.vertices, (corners[:, 0] + corners[:, 1]) / 2])
        behind = targets - 0.3 * direction * np.sign(targets @ direction)[:, None]
        behind = behind[outside_by(behind) < -1e-3]
        self.assertTrue((query.tracer.count(behind, direction) != 1).any())
        self.assertTrue(query.contains_points(behind).all())

    def test_follow_a_mesh_whose_arrays_change(self):
        mesh = ball()
        mesh.ray = clarity.trimesh.RayMeshIntersector(mesh, accel="bvh2")
        ray = [[3.1, 0.1, 5]], [[0, 0, -1]]
        self.assertFalse(mesh.ray.intersects_any(*ray)[0])
        tracer = mesh.ray.tracer
        self.assertIs(mesh.ray.tracer, tracer)
        mesh.vertices = mesh.vertices + [3, 0, 0]
        self.assertTrue(mesh.ray.intersects_any(*ray)[0])
        mesh.vertices[:, 0] += 3  # in place
        self.assertFalse(mesh.ray.intersects_any(*ray)[0])
        self.assertTrue(mesh.ray.intersects_any([[6.1, 0.1, 5]], [[0, 0, -1]])[0])
        mesh.faces[:] = mesh.faces[0]
        self.assertFalse(mesh.ray.intersects_any([[6.1, 0.9, 0]], [[0, -1, 0]])[0])
        mesh = ball()
        mesh.ray = clarity.trimesh.RayMeshIntersector(mesh, accel="bvh2")
        for words, wrong in (
            (r"ray_origins: expected an array of shape \(n, 3\)", lambda: mesh.ray.intersects_any([0, 0, 0], [0, 0, 1])),
            ("there are 1 and 2", lambda: mesh.ray.intersects_any(ray[0], ray[1] * 2)),
        ):
            with self.assertRaisesRegex(clarity.UsageError, words):
                wrong()


if __name__ == "__main__":
    unittest.main(verbosity=2)
