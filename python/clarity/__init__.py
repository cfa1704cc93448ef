"""Clarity: scenes, ray queries and pictures by ray tracing on OpenCL devices, with numpy.

>>> import clarity
>>> scene = clarity.Scene(vertices, faces)            # or clarity.load("car.fbx", "room.scene")
>>> rt = scene.on("gpu", accel="bvh4,max_leaf=4")     # or scene.on(): the best device and structure
>>> hit = rt.closest(origins, directions, t_max=9)    # hit.t, .prim, .instance, .uv, .mask, .points()
>>> ray, t, prim = rt.all(origins, directions)        # each hit of each ray, in order; rt.count(), rt.any()
>>> depth = rt.render(1024, 768, aov="t")
"""
from . import trimesh
from ._binding import library as _library
from ._errors import Cancelled, DeviceError, Error, ForkError, ImportFailed, KernelError, UsageError
from ._rays import AllHits, Hit, Packed
from ._rows import bench, check
from ._scene import Scene, Tracer, load

__version__ = _library.clarity_version().decode()
__all__ = [
    "AllHits",
    "Cancelled",
    "DeviceError",
    "Error",
    "ForkError",
    "Hit",
    "ImportFailed",
    "KernelError",
    "Packed",
    "Scene",
    "Tracer",
    "UsageError",
    "bench",
    "check",
    "load",
    "trimesh",
]
