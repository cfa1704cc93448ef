"""Rays as arrays of numpy, and hits."""
import copy
import ctypes
import math
import operator
import weakref

import numpy as np

from ._binding import constants, layout, library
from ._calls import check
from ._errors import UsageError

_RAYS, _HITS = layout("clarity_rays"), layout("clarity_hits")
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
        origins, directions = as_array(origins, "origins"), as_array(directions, "directions")
        limits = [None, None]
        shape, dtype = origins.shape[:-1], origins.dtype
        alike = directions.dtype is dtype and directions.shape == origins.shape and origins.shape[-1:] == (3,)
        if not alike or t_min is not None or t_max is not None:
            limits = [limit if limit is None else as_array(limit, name) for name, limit in (("t_min", t_min), ("t_max", t_max))]
            given = [origins, directions] + [limit for limit in limits if limit is not None]
            shape = self._common_shape(given)
            dtype = max(array.dtype for array in given if array.ndim)  # a number has no type of its own
            origins, directions = np.asarray(origins, dtype), np.asarray(directions, dtype)
            limits = [limit if limit is None else np.asarray(limit, dtype) for limit in limits]
        self.origins, self.directions, self.shape, self.count = origins, directions, shape, math.prod(shape)
        self._lent = []
        origin, origin_steps = self._flattened(origins, 1)
        direction, direction_steps = self._flattened(directions, 1)
        (begin, begin_step), (end, end_step) = [(0, (0,)) if limit is None else self._flattened(limit, 0) for limit in limits]
        steps = origin_steps + direction_steps + begin_step + end_step
        self.struct = _RAYS.pack(_RAYS.size, _TYPES[dtype], self.count, origin, direction, begin, end, *steps, mask_of(mask), 0, 0)

    @staticmethod
    def _common_shape(arrays):
        for name, array in zip(("origins", "directions"), arrays):
            if array.shape[-1:] != (3,):
                raise UsageError(f"{name}: expected an array of shape (..., 3), found {array.shape}")
        shapes = [array.shape[:-1] for array in arrays[:2]] + [array.shape for array in arrays[2:]]
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
        self.struct = self._struct(None)

    def _struct(self, mask):
        return _RAYS.pack(_RAYS.size, 0, self.count, *(0,) * 10, mask_of(mask), 0, self._handle)

    def masked(self, mask):
        if mask is None:
            return self
        other = copy.copy(self)  # the first one frees the rays
        other._first = self
        other.struct = self._struct(mask)
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
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))  # in a quarter of the time
    except (TypeError, ValueError):  # an array with gaps, that cannot be written, or empty
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

    def __init__(self, shape, brief=False, *, _tracer=None):
        self.shape, self.brief = tuple(shape), brief
        self._arrays = [None] * len(_ARRAYS)
        # Where the hits are. Arrays are None that nobody has read. Without a memory they are the caller's.
        self._memory = _Memory(math.prod(shape), brief) if _tracer is None else Kept(brief, _tracer)
        self._rays = None
        self._made = None

    def _array(self, number):
        array = self._arrays[number]
        if array is None and self._memory is not None and (number < _BRIEF or not self.brief):
            _, dtype, more = _ARRAYS[number]
            array = self._arrays[number] = self._memory.array(number, self.shape + more, dtype)
        return array

    def _leave_memory(self):
        """From now on the arrays are arrays as any others."""
        for number in range(len(_ARRAYS)):
            self._array(number)
        self._memory = None

    def _set(self, number, array):
        self._leave_memory()
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
        if self._memory is not None:
            if self._memory.tracer in (None, tracer) and self.shape == shape:
                return
            self._leave_memory()
        for number, (name, dtype, more) in enumerate(_ARRAYS):
            if self._arrays[number] is not None or number < _BRIEF:
                check_out(self._arrays[number], shape + more, dtype, f"out.{name}")

    def _struct(self):
        """What the library is told of hits that are not on a device. It is kept for these arrays."""
        if self._memory is not None:
            return self._memory.struct
        t, prim, uv, instance = arrays = self._arrays
        made = self._made
        if not made or made[0] is not t or made[1] is not prim or made[2] is not uv or made[3] is not instance:
            self._made = made = *arrays, _struct_of_hits(*(0 if array is None else address_of(array) for array in arrays))
        return made[4]


# In the order of the library's numbers; the first _BRIEF are those of brief hits.
_ARRAYS = (("t", np.float32, ()), ("prim", np.int32, ()), ("uv", np.float32, (2,)), ("instance", np.int32, ()))
_BRIEF = 2
_PLACES = (0, 1, 2, 4)  # where they begin in one memory, in numbers a hit

for _number, (_name, _, _) in enumerate(_ARRAYS):
    setattr(
        Hit,
        _name,
        property(
            lambda self, number=_number: self._arrays[number] if self._memory is None else self._array(number),
            lambda self, array, number=_number: self._set(number, array),
        ),
    )


def _struct_of_hits(t, prim, uv, instance):
    return _HITS.pack(_HITS.size, 0, t, prim, instance, uv)


class _Memory:
    """Hits of any tracer in memory of numpy's, array by array: to make one array is a tenth of a call with one ray."""

    tracer = None

    def __init__(self, count, brief):
        self._bytes = 4 * count
        self._numbers = np.empty((2 if brief else 5) * count or 1, np.float32)
        begin = address_of(self._numbers)
        t, prim, uv, instance = begin, begin + self._bytes, begin + 2 * self._bytes, begin + 4 * self._bytes
        self.struct = _struct_of_hits(t, prim, 0, 0) if brief else _struct_of_hits(t, prim, uv, instance)

    def array(self, number, shape, dtype):
        return np.ndarray(shape, dtype, self._numbers, _PLACES[number] * self._bytes)


class Kept:
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
