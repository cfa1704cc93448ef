"""What trimesh asks of a ray tracer, by Clarity: mesh.ray = clarity.trimesh.RayMeshIntersector(mesh). trimesh itself is not needed:
a mesh is anything with `vertices` and `faces`."""
import numpy as np

from . import _arguments
from ._errors import UsageError
from ._rays import as_array, digest_of
from ._scene import Scene

# Of contains_points: no plane or edge of a usual mesh lies along them.
_DIRECTIONS = np.array([[0.4395064455, 0.617598629942, 0.652231566745], [-0.7310581, 0.2411931, 0.6382957], [0.1274571, -0.8917243, 0.4342361]])


class RayMeshIntersector:
    """The methods of trimesh's class of this name. device, accel, settings: as of Scene.on().

    Rays have arrays of the shape (n, 3). The mesh is read when it is first asked, and again after its arrays have changed. trimesh's
    arrays tell so themselves; others are read for it in each call, which takes 1 ms of a million vertices."""

    def __init__(self, mesh, device="", accel="", **settings):
        for name in ("vertices", "faces"):
            if not hasattr(mesh, name):
                _arguments.refuse("mesh", f"an object with vertices and faces; it has no {name}", mesh)
        self.mesh = mesh
        self._on = device, accel, settings
        self._read = None

    def __getstate__(self):
        return {**vars(self), "_read": None}  # a copy reads the mesh for itself

    @property
    def tracer(self):
        vertices, faces = self.mesh.vertices, self.mesh.faces
        state = tuple(map(_state, (vertices, faces)))
        if self._read is None or self._read[0] != state:
            device, accel, settings = self._on
            tracer = Scene(np.array(as_array(vertices, "vertices"), np.float64), np.array(faces)).on(device, accel, **settings)
            self._read = state, tracer
        return self._read[1]

    def intersects_any(self, ray_origins, ray_directions):
        """Whether each ray hits anything, (n,) bool."""
        return self.tracer.any(*_rays(ray_origins, ray_directions))

    def intersects_first(self, ray_origins, ray_directions):
        """The first triangle that each ray hits, (n,) int64; -1: none."""
        return self.tracer.closest(*_rays(ray_origins, ray_directions)).prim.astype(np.int64)

    def intersects_id(self, ray_origins, ray_directions, multiple_hits=True, max_hits=None, return_locations=False):
        """Which triangles rays hit: numbers of triangles and of rays, (m,) each, and locations (m, 3) if they are asked for. They are
        ordered by ray, and along a ray by distance. multiple_hits: all of them, or else the first of each ray. max_hits: of a ray."""
        locations, rays, triangles = self._hits(ray_origins, ray_directions, multiple_hits, max_hits)
        return (triangles, rays, locations) if return_locations else (triangles, rays)

    def intersects_location(self, ray_origins, ray_directions, multiple_hits=True, max_hits=None):
        """Where rays hit: locations (m, 3) in float64, numbers of rays and of triangles, (m,) each, in the same order."""
        return self._hits(ray_origins, ray_directions, multiple_hits, max_hits)

    def contains_points(self, points):
        """Whether each point is inside the mesh, (n,) bool: a ray from there leaves a closed surface an odd number of times. Points
        whose rays along two opposite directions disagree, as at edges, are asked along others."""
        points = _three(points, "points")
        inside = np.zeros(len(points), bool)
        asked = np.arange(len(points))
        for direction in _DIRECTIONS:
            odd, behind = (self.tracer.count(points[asked], sign * direction) % 2 == 1 for sign in (1, -1))
            inside[asked] = odd & behind
            asked = asked[odd != behind]
        return inside

    def _hits(self, origins, directions, multiple_hits, max_hits):
        origins, directions = _rays(origins, directions)
        if not multiple_hits:
            hit = self.tracer.closest(origins, directions)
            rays = np.nonzero(hit.mask)[0]
            return hit.points()[rays], rays, hit.prim[rays].astype(np.int64)
        hits = self.tracer.all(origins, directions)
        locations, rays, triangles = hits.points(), hits.ray, hits.prim.astype(np.int64)
        most = None if max_hits is None else _arguments.whole(max_hits, "max_hits", 0)
        if most is None:
            return locations, rays.copy(), triangles
        kept = np.arange(len(hits)) - hits.first[rays] < most
        return locations[kept], rays[kept], triangles[kept]


def _state(array):
    """Another one when the array has other numbers. trimesh keeps the hash of its arrays until they are written to."""
    if isinstance(array, np.ndarray) and type(array).__hash__:
        return hash(array)
    array = np.ascontiguousarray(array)
    return array.shape, array.dtype.str, digest_of(array)


def _three(values, name):
    array = np.asarray(as_array(values, name), np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise UsageError(f"{name}: expected an array of shape (n, 3), found {array.shape}")
    return array


def _rays(origins, directions):
    origins, directions = _three(origins, "ray_origins"), _three(directions, "ray_directions")
    if len(origins) != len(directions):
        raise UsageError(f"ray_origins and ray_directions: there are {len(origins)} and {len(directions)}")
    return origins, directions
