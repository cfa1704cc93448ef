"""Rays as arrays of numpy, and hits."""
import numpy as np

from ._binding import constants, struct
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

    def __init__(self, origins, directions, t_min, t_max):
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
        self.struct = struct("clarity_rays", type=_TYPES[self.dtype], count=self.count, **values)

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
        t = np.where(self.mask, self.t, np.nan).astype(np.float64)[..., None]
        return self._rays.origins.astype(np.float64) + t * self._rays.directions.astype(np.float64)

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


def check_out(array, shape, dtype, name):
    good = isinstance(array, np.ndarray) and array.shape == shape and array.dtype == dtype
    if not good or not array.flags.c_contiguous or not array.flags.writeable:
        raise UsageError(f"{name}: expected a writeable array of {np.dtype(dtype)} in the shape {shape} without gaps")
