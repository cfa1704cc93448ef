"""Rays as arrays of numpy, and hits."""
import ctypes
import operator
import weakref

import numpy as np

from ._binding import constants, library, struct
from ._errors import UsageError

_TYPES = {np.dtype(np.float32): constants["CLARITY_FLOAT32"], np.dtype(np.float64): constants["CLARITY_FLOAT64"]}


def as_array(values, name):
    """float32 stays, everything else becomes float64."""
    array = np.asarray(values)
    if array.dtype == np.float32 and array.dtype.isnative:
        return array
    if array.dtype.kind not in "fiub":
        raise UsageError(f"{name}: expected numbers, found an array of {array.dtype}")
    return np.asarray(array, dtype=np.float64)


class Rays:
    """Arrays of rays in one shape. Nothing is copied unless types are mixed, or an array of several axes has to be repeated."""

    def __init__(self, origins, directions, t_min, t_max, mask=None):
        if mask is not None and not 1 <= operator.index(mask) <= 255:
            raise UsageError(f"mask: expected a whole number from 1 to 255, found {mask}")
        arrays = {"origins": as_array(origins, "origins"), "directions": as_array(directions, "directions")}
        for name, array in arrays.items():
            if array.ndim < 1 or array.shape[-1] != 3:
                raise UsageError(f"{name}: expected an array of shape (..., 3), found {array.shape}")
        limits = {name: np.asarray(value) for name, value in (("t_min", t_min), ("t_max", t_max)) if value is not None}
        for name, limit in limits.items():
            arrays[name] = as_array(limit, name)
        # A number has no type of its own.
        doubles = any(array.dtype == np.float64 for array in arrays.values() if array.ndim)
        self.dtype = np.dtype(np.float64 if doubles else np.float32)
        arrays = {name: np.asarray(array, dtype=self.dtype) for name, array in arrays.items()}
        shapes = [array.shape if name in limits else array.shape[:-1] for name, array in arrays.items()]
        try:
            self.shape = np.broadcast_shapes(*shapes)
        except ValueError:
            raise UsageError(f"rays of the shapes {', '.join(map(str, shapes))} do not fit each other") from None
        self.count = int(np.prod(self.shape, dtype=np.int64))
        self.origins, self.directions = arrays["origins"], arrays["directions"]
        self._flat = {name: self._flattened(array, 0 if name in limits else 1) for name, array in arrays.items()}
        values = {name: flat.ctypes.data for name, (flat, _) in self._flat.items()}
        for name, (flat, steps) in self._flat.items():
            if name in limits:
                values[name + "_step"] = steps[0]
            else:
                values[name[:-1] + "_steps"] = steps
        self.struct = struct("clarity_rays", type=_TYPES[self.dtype], count=self.count, mask=mask or 0, **values)

    def points(self, t, ray=Ellipsis):
        """Where rays are at t, in float64. ray: numbers of rays; otherwise t is in their shape with one axis more."""
        def doubles(array):
            return (array if ray is Ellipsis else np.broadcast_to(array, self.shape + (3,)).reshape(-1, 3)[ray]).astype(np.float64)

        return doubles(self.origins) + t * doubles(self.directions)

    def _flattened(self, array, axes):
        """The array with one axis of rays, and its steps in bytes; `axes` axes behind it belong to a ray."""
        of_ray = array.shape[array.ndim - axes :]
        if array.ndim == axes:
            return array, (0,) + array.strides
        flat = np.broadcast_to(array, self.shape + of_ray).reshape((-1,) + of_ray)
        return flat, flat.strides


class Hit:
    """What rays hit: arrays in the shape of the rays.

    t         float32, in lengths of the direction; infinity where nothing is hit
    prim      int32, the primitive, counted through all instances: of a mesh of arrays the face; -1 where nothing is hit
    instance  int32, -1: none
    uv        float32, two a ray: weights of a triangle's second and third corner
    """

    def __init__(self, shape):
        self.t = np.empty(shape, np.float32)
        self.prim = np.empty(shape, np.int32)
        self.instance = np.empty(shape, np.int32)
        self.uv = np.empty(tuple(shape) + (2,), np.float32)
        self._rays = None

    @property
    def mask(self):
        """True where something is hit."""
        return self.prim >= 0

    def points(self):
        """Where rays hit, in float64; nan where they hit nothing."""
        return self._rays.points(np.where(self.mask, self.t, np.nan).astype(np.float64)[..., None])

    def __len__(self):
        return len(self.t)

    def __repr__(self):
        return f"<clarity.Hit: {np.count_nonzero(self.mask)} of {self.t.size} rays>"

    def _struct_for(self, rays):
        wanted = {"t": np.float32, "prim": np.int32, "instance": np.int32, "uv": np.float32}
        for name, dtype in wanted.items():
            check_out(getattr(self, name), rays.shape + ((2,) if name == "uv" else ()), dtype, f"out.{name}")
        self._rays = rays
        return struct("clarity_hits", **{name: getattr(self, name).ctypes.data for name in wanted})


class AllHits:
    """All hits of rays, ordered by ray, then by t, then by primitive: `ray, t, prim = hits`. Arrays that cannot be written.

    ray       int64, number of the ray, counted through all axes of the rays
    t, prim, instance, uv    as in Hit
    first     int64, the hits of ray i are first[i] to first[i + 1] - 1
    """

    def __init__(self, rays, found):
        self._rays = rays
        owner = _Owner(found)

        def array(name, dtype, count):
            return owner.array(getattr(found, name), dtype, count)

        count = found.count
        self.first = array("first", np.int64, rays.count + 1)
        self.ray = array("ray", np.int64, count)
        self.t = array("t", np.float32, count)
        self.prim = array("prim", np.int32, count)
        self.instance = array("instance", np.int32, count)
        self.uv = array("uv", np.float32, 2 * count).reshape(-1, 2)

    def points(self):
        """Where the hits are, in float64."""
        return self._rays.points(self.t.astype(np.float64)[:, None], self.ray)

    def __iter__(self):
        return iter((self.ray, self.t, self.prim))

    def __len__(self):
        return len(self.t)

    def __repr__(self):
        return f"<clarity.AllHits: {len(self)} of {self._rays.count} rays>"


class _Owner:
    """Memory of the library that arrays lie in: freed when the last of them goes."""

    def __init__(self, found):
        weakref.finalize(self, library.clarity_all_hits_free, ctypes.byref(found))

    def array(self, address, dtype, count):
        if not count:
            return np.empty(0, dtype)
        # numpy keeps an object with this attribute as the array's base.
        view = _View()
        view.owner = self
        view.__array_interface__ = {"version": 3, "shape": (count,), "typestr": np.dtype(dtype).str, "data": (address, True)}
        return np.asarray(view)


class _View:
    pass


def check_out(array, shape, dtype, name):
    good = isinstance(array, np.ndarray) and array.shape == shape and array.dtype == dtype
    if not good or not array.flags.c_contiguous or not array.flags.writeable:
        raise UsageError(f"{name}: expected a writeable array of {np.dtype(dtype)} in the shape {shape} without gaps")
