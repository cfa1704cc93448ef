"""Rays as arrays of numpy, and hits."""
import copy
import ctypes
import math
import operator
import weakref

import numpy as np

from ._binding import constants, header, library, struct
from ._calls import check
from ._errors import UsageError

_TYPES = {np.dtype(np.float32): constants["CLARITY_FLOAT32"], np.dtype(np.float64): constants["CLARITY_FLOAT64"]}


def array_of(values, name):
    """Of anything that numpy can read without a copy, and of lists. What has no protocol of numpy's is asked for DLPack."""
    try:
        if hasattr(values, "__dlpack__") and not hasattr(values, "__array__") and not hasattr(values, "__array_interface__"):
            return np.from_dlpack(values)
        return np.asarray(values)
    except (BufferError, RuntimeError, TypeError, ValueError) as error:
        raise UsageError(f"{name}: numpy cannot read it: {error}; an array on a GPU has to be copied to the CPU first") from None


def as_array(values, name):
    """float32 stays, everything else becomes float64."""
    array = values if type(values) is np.ndarray else array_of(values, name)
    if array.dtype in _TYPES:
        return array
    if array.dtype.kind not in "fiub":
        raise UsageError(f"{name}: expected numbers, found an array of {array.dtype}")
    return np.asarray(array, dtype=np.float64)


class Rays:
    """Arrays of rays in one shape. Nothing is copied unless types are mixed, or an array of several axes has to be repeated."""

    def __init__(self, origins, directions, t_min=None, t_max=None, mask=None):
        self.origins, self.directions = as_array(origins, "origins"), as_array(directions, "directions")
        for name in ("origins", "directions"):
            shape = getattr(self, name).shape
            if not shape or shape[-1] != 3:
                raise UsageError(f"{name}: expected an array of shape (..., 3), found {shape}")
        values = {}
        if t_min is not None:
            values["t_min"] = as_array(t_min, "t_min")
        if t_max is not None:
            values["t_max"] = as_array(t_max, "t_max")
        self.dtype = self.origins.dtype
        if values or self.directions.dtype != self.dtype:
            # A number has no type of its own.
            arrays = [self.origins, self.directions] + [limit for limit in values.values() if limit.ndim]
            self.dtype = max(array.dtype for array in arrays)
            self.origins, self.directions = np.asarray(self.origins, self.dtype), np.asarray(self.directions, self.dtype)
            values = {name: np.asarray(limit, self.dtype) for name, limit in values.items()}
        self.shape = self._common_shape([self.origins.shape[:-1], self.directions.shape[:-1]] + [limit.shape for limit in values.values()])
        self.count = math.prod(self.shape)
        self._lent = []
        for name in tuple(values):
            values[name], steps = self._flattened(values[name], 0)
            values[name + "_step"] = steps[0]
        values["origins"], values["origin_steps"] = self._flattened(self.origins, 1)
        values["directions"], values["direction_steps"] = self._flattened(self.directions, 1)
        self.struct = struct("clarity_rays", type=_TYPES[self.dtype], count=self.count, mask=mask_of(mask), **values)

    @staticmethod
    def _common_shape(shapes):
        shape = max(shapes, key=len)
        if all(other == shape or not other for other in shapes):
            return shape
        try:
            return np.broadcast_shapes(*shapes)
        except ValueError:
            raise UsageError(f"rays of the shapes {', '.join(map(str, shapes))} do not fit each other") from None

    def points(self, t, ray=Ellipsis):
        """Where rays are at t, in float64. ray: numbers of rays; otherwise t is in their shape with one axis more."""
        def doubles(array):
            return (array if ray is Ellipsis else np.broadcast_to(array, self.shape + (3,)).reshape(-1, 3)[ray]).astype(np.float64)

        return doubles(self.origins) + t * doubles(self.directions)

    def _flattened(self, array, axes):
        """Where the array with one axis of rays lies, and its steps in bytes; `axes` axes behind it belong to a ray."""
        if array.ndim == axes:
            steps = (0,) + array.strides
        else:
            if array.ndim != axes + 1 or len(self.shape) != 1 or len(array) != self.count:
                of_ray = array.shape[array.ndim - axes :]
                array = np.broadcast_to(array, self.shape + of_ray).reshape((-1,) + of_ray)
            steps = array.strides
        self._lent.append(array)
        return address_of(array), steps


class Packed:
    """Rays that lie on the device of a tracer: made by Tracer.pack(). Their arrays are needed no more, but for Hit.points()."""

    def __init__(self, rays, handle):
        self.shape, self.count, self.origins, self.directions = rays.shape, rays.count, rays.origins, rays.directions
        self.points = rays.points
        self._handle = handle
        weakref.finalize(self, library.clarity_packed_free, handle)
        self.struct = struct("clarity_rays", count=self.count, packed=handle)

    def masked(self, mask):
        if mask is None:
            return self
        other = copy.copy(self)  # the first one frees the rays
        other._first = self
        other.struct = struct("clarity_rays", count=self.count, packed=self._handle, mask=mask_of(mask))
        return other

    def __len__(self):
        return self.shape[0]

    def __repr__(self):
        return f"<clarity.Packed: {self.count} rays>"


def rays_of(origins, directions, t_min, t_max, mask):
    if not isinstance(origins, Packed):
        return Rays(origins, directions, t_min, t_max, mask)
    if directions is not None or t_min is not None or t_max is not None:
        raise UsageError("packed rays have their directions and limits: give nothing beside them but a mask")
    return origins.masked(mask)


def mask_of(mask):
    if mask is None:
        return 0
    if not 1 <= operator.index(mask) <= 255:
        raise UsageError(f"mask: expected a whole number from 1 to 255, found {mask}")
    return mask


def address_of(array):
    return array.__array_interface__["data"][0]


class Hit:
    """What rays hit: arrays in the shape of the rays.

    t         float32, in lengths of the direction; infinity where nothing is hit
    prim      int32, the primitive, counted through all instances: of a mesh of arrays the face; -1 where nothing is hit
    instance  int32, -1: none
    uv        float32, two a ray: weights of a triangle's second and third corner

    brief: only t and prim, which are found faster; the others are None.

    Hits of many rays stay on the device that found them. An array is copied when it is first read; on a CPU it is the memory that
    the device wrote to. `out=` fills the arrays again that were read."""

    def __init__(self, shape, brief=False):
        self._begin(shape, brief)
        for number, (_, dtype, more) in enumerate(_ARRAYS[: _BRIEF if brief else None]):
            self._arrays[number] = np.empty(self.shape + more, dtype)

    @classmethod
    def _on_device(cls, shape, brief, tracer):
        hit = cls.__new__(cls)
        hit._begin(shape, brief)
        hit._kept = _Kept(brief, tracer)
        return hit

    def _begin(self, shape, brief):
        self.shape, self.brief = tuple(shape), brief
        self._arrays = [None] * len(_ARRAYS)
        self._kept = None  # the hits on a device: arrays are None that nobody has read
        self._rays = None
        self._made = None

    def _array(self, number):
        array = self._arrays[number]
        if array is None and self._kept is not None and (number < _BRIEF or not self.brief):
            _, dtype, more = _ARRAYS[number]
            array = self._arrays[number] = self._kept.array(number, self.shape + more, dtype)
        return array

    def _leave_device(self):
        """From now on the arrays are arrays as any others."""
        for number in range(len(_ARRAYS)):
            self._array(number)
        self._kept = None

    def _set(self, number, array):
        self._leave_device()
        self._arrays[number] = array

    @property
    def mask(self):
        """True where something is hit."""
        return self.prim >= 0

    def points(self):
        """Where rays hit, in float64; nan where they hit nothing."""
        return self._rays.points(np.where(self.mask, self.t, np.nan).astype(np.float64)[..., None])

    def __len__(self):
        return self.shape[0]

    def __repr__(self):
        return f"<clarity.Hit: {np.count_nonzero(self.mask)} of {self.mask.size} rays>"

    def _check(self, shape, tracer):
        """Whether hits of rays of this shape can be written here."""
        if self._kept is not None:
            if self._kept.tracer == tracer and self.shape == shape:
                return
            self._leave_device()
        for number, (name, dtype, more) in enumerate(_ARRAYS):
            if self._arrays[number] is not None or number < _BRIEF:
                check_out(self._arrays[number], shape + more, dtype, f"out.{name}")

    def _struct_for(self, rays):
        """What the library is told. It is kept for these arrays: to make it is a third of a call with one ray."""
        self._rays = rays
        t, prim, uv, instance = arrays = self._arrays
        made = self._made
        if not made or made[0] is not t or made[1] is not prim or made[2] is not uv or made[3] is not instance:
            t, prim, uv, instance = places = [None if array is None else address_of(array) for array in arrays]
            self._made = made = *arrays, header.structs["clarity_hits"](_HITS_BYTES, 0, t, prim, instance, uv)
        return made[4]


# In the order of the library's numbers; the first _BRIEF are those of brief hits.
_ARRAYS = (("t", np.float32, ()), ("prim", np.int32, ()), ("uv", np.float32, (2,)), ("instance", np.int32, ()))
_BRIEF = 2
_HITS_BYTES = ctypes.sizeof(header.structs["clarity_hits"])

for _number, (_name, _, _) in enumerate(_ARRAYS):
    setattr(
        Hit,
        _name,
        property(
            lambda self, number=_number: self._arrays[number] if self._kept is None else self._array(number),
            lambda self, array, number=_number: self._set(number, array),
        ),
    )


class _Kept:
    """Hits on the device of a tracer. Their arrays lie in memory of the library."""

    def __init__(self, brief, tracer):
        self.tracer = tracer
        handle = ctypes.c_void_p()
        check(library.clarity_kept_new(tracer, int(brief), ctypes.byref(handle)))
        self.handle = handle.value
        weakref.finalize(self, library.clarity_kept_free, self.handle)

    def array(self, number, shape, dtype):
        address = ctypes.c_void_p()
        check(library.clarity_kept_array(self.handle, number, ctypes.byref(address)))
        return array_at(address.value, dtype, shape, self)


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
        return array_at(address, dtype, (count,), self, frozen=True)


def array_at(address, dtype, shape, owner, frozen=False):
    if 0 in shape:
        return np.empty(shape, dtype)
    # numpy keeps an object with this attribute as the array's base.
    view = _View()
    view.owner = owner
    view.__array_interface__ = {"version": 3, "shape": shape, "typestr": np.dtype(dtype).str, "data": (address, frozen)}
    return np.asarray(view)


class _View:
    pass


def check_out(array, shape, dtype, name):
    good = isinstance(array, np.ndarray) and array.shape == shape and array.dtype == dtype
    if not good or not array.flags.c_contiguous or not array.flags.writeable:
        raise UsageError(f"{name}: expected a writeable array of {np.dtype(dtype)} in the shape {shape} without gaps")
    return array
