"""Rays as arrays of numpy, and hits."""
import ctypes
import math

import numpy as np

from . import _arguments
from ._binding import constants, layout, library
from ._calls import check, free_with
from ._errors import UsageError

_RAYS, _HITS = layout("clarity_rays"), layout("clarity_hits")
_TYPES = {np.dtype(np.float32): constants["CLARITY_FLOAT32"], np.dtype(np.float64): constants["CLARITY_FLOAT64"]}


def array_of(values, name):
    """Of anything that numpy can read without a copy, and of lists. What has no protocol of numpy's is asked for DLPack."""
    if isinstance(values, np.ma.MaskedArray) and values.mask.any():
        raise UsageError(f"{name}: numpy would take the masked numbers for valid ones: leave these rows out")
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


# An array of so many bytes is copied in 5 us, within which at least 100 rays are traced.
_SMALL = 1 << 16


def held(array, given, name):
    """An array that is asked again later, when the caller, who gave `given`, may have written to it. A copy if it is small or has gaps;
    of a larger one a Lent, which takes no memory and tells."""
    if array.nbytes <= _SMALL:
        return array.copy()
    if array is not given and array.base is None:
        return array  # nobody else knows it
    if 0 in array.strides[:-1]:
        repeated = [slice(1 if step == 0 else None) for step in array.strides[:-1]]
        return held(array[tuple(repeated)], given, name)
    for one in (array, array.T):
        if one.flags.c_contiguous:
            return Lent(array, one, name)
    return array.copy()


class Lent:
    """A large array of the caller's, and a digest of what it held."""

    __slots__ = "_array", "_bytes", "_name", "_digest"

    def __init__(self, array, in_order, name):
        self._array, self._bytes, self._name, self._digest = array, in_order, name, digest_of(in_order)

    def get(self):
        if digest_of(self._bytes) != self._digest:
            raise UsageError(f"{self._name}: the array was changed after the call that it was given to; ask before, or give that call a copy")
        return self._array


def asked(array):
    """The array as it was: of one that is held."""
    return array.get() if type(array) is Lent else array


def digest_of(array):
    """Of an array without gaps."""
    text = ctypes.create_string_buffer(33)
    check(library.clarity_digest(address_of(array), array.nbytes, text))
    return text.value


class Lines:
    """Where rays are: what a Hit knows of those that it is of."""

    def __init__(self, origins, directions, shape):
        self.origins, self.directions, self.shape, self.count = origins, directions, shape, math.prod(shape)

    def points(self, t, ray=Ellipsis):
        """Where rays are at t, in float64. ray: numbers of rays; otherwise t is in their shape with one axis more."""
        def doubles(array):
            array = asked(array)
            return (array if ray is Ellipsis else np.broadcast_to(array, self.shape + (3,)).reshape(-1, 3)[ray]).astype(np.float64)

        return doubles(self.origins) + t * doubles(self.directions)

    def __reduce__(self):
        return Lines, (asked(self.origins), asked(self.directions), self.shape)


class Rays(Lines):
    """Arrays of rays in one shape. Nothing is copied unless types are mixed, or an array of several axes has to be repeated. is_held:
    points() are those of these rays, whatever the caller does to the arrays."""

    def __init__(self, origins, directions, t_min=None, t_max=None, mask=None, is_held=False):
        given_origins, given_directions = origins, directions
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
        bits = 0 if mask is None else _arguments.mask(mask)
        self.struct = _RAYS.pack(_RAYS.size, _TYPES[dtype], self.count, origin, direction, begin, end, *steps, bits, 0, 0)
        if is_held and self.count <= _SMALL // 24:  # the same as held(), in half of the time
            self.origins, self.directions = origins.copy(), directions.copy()
        elif is_held:
            self.origins = held(origins, given_origins, "origins")
            self.directions = held(directions, given_directions, "directions")

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

    def __init__(self, *_, **__):
        raise TypeError("clarity.Packed: made by Tracer.pack(origins, directions)")

    @classmethod
    def _of(cls, rays, handle):
        packed = cls.__new__(cls)
        packed._lines, packed._handle, packed._first = Lines(rays.origins, rays.directions, rays.shape), handle, None
        free_with(packed, library.clarity_packed_free, handle)
        packed._tell(None)
        return packed

    def _tell(self, mask):
        """What the library is told of them."""
        bits = 0 if mask is None else _arguments.mask(mask)
        self.struct = _RAYS.pack(_RAYS.size, 0, self._lines.count, *(0,) * 10, bits, 0, self._handle)

    def masked(self, mask):
        if mask is None:
            return self
        other = type(self).__new__(type(self))
        other._lines, other._handle, other._first = self._lines, self._handle, self  # the first one frees the rays
        other._tell(mask)
        return other

    @property
    def shape(self):
        return self._lines.shape

    @property
    def count(self):
        return self._lines.count

    def __reduce_ex__(self, _protocol):
        raise TypeError("a clarity.Packed cannot be pickled or copied: it lies on a device; send its arrays, and pack() them there")

    def __len__(self):
        return length_of(self)

    def __repr__(self):
        return f"<clarity.Packed: {self.count} rays>"


def length_of(of_rays):
    if not of_rays.shape:
        raise TypeError(f"len() of a clarity.{type(of_rays).__name__} of one ray: it has no axis")
    return of_rays.shape[0]


def rays_of(origins, directions, t_min, t_max, mask, is_held=False):
    if not isinstance(origins, Packed):
        return Rays(origins, directions, t_min, t_max, mask, is_held)
    if directions is not None or t_min is not None or t_max is not None:
        raise UsageError("packed rays have their directions and limits: give nothing beside them but a mask")
    return origins.masked(mask)


def arrays_of_rays(call, origins, directions, t_min, t_max, mask, is_held=False):
    """Of a call that packed rays do not serve."""
    if isinstance(origins, Packed):
        raise UsageError(f"{call}: packed rays serve closest() and any(): give the arrays")
    return Rays(origins, directions, t_min, t_max, mask, is_held)


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

    def __init__(self, shape, brief=False):
        shape, brief = _arguments.size(shape, "shape"), _arguments.flag(brief, "brief")
        self._begin(shape, brief, _Memory(math.prod(shape), brief))

    def _begin(self, shape, brief, memory):
        self._shape, self._brief = shape, brief
        self._arrays = [None] * len(_ARRAYS)
        # Where the hits are. Arrays are None that nobody has read. Without a memory they are the caller's.
        self._memory = memory
        self._rays = None
        self._made = None

    @classmethod
    def _on(cls, shape, brief, tracer):
        """Hits that stay on the tracer's device. None: in memory of numpy's."""
        hit = cls.__new__(cls)
        hit._begin(shape, brief, _Memory(math.prod(shape), brief) if tracer is None else Kept(brief, tracer))
        return hit

    @property
    def shape(self):
        """Of the rays."""
        return self._shape

    @property
    def brief(self):
        """Whether only t and prim are known."""
        return self._brief

    def __reduce__(self):
        """As arrays; what is on a device is read."""
        arrays = [self._array(number) for number in range(len(_ARRAYS))]
        return _hit_again, (type(self), self._shape, self._brief, arrays, self._rays), of_users(self, _OURS)

    def _array(self, number):
        array = self._arrays[number]
        if array is None and self._memory is not None and (number < _BRIEF or not self._brief):
            _, dtype, more = _ARRAYS[number]
            array = self._arrays[number] = self._memory.array(number, self._shape + more, dtype)
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
        """Where rays hit, in float64; nan where they hit nothing. Of the rays as they were: an array of more than 64 KiB that has been
        changed since is a UsageError."""
        if self._rays is None:
            raise UsageError("points() of a Hit that no rays were traced into, or whose call failed: trace into it by out=")
        return self._rays.points(np.where(self.mask, self.t, np.nan).astype(np.float64)[..., None])

    def __len__(self):
        return length_of(self)

    def __repr__(self):
        return f"<clarity.Hit: {np.count_nonzero(self.mask)} of {self.mask.size} rays>"

    def _check(self, shape, tracer):
        """Whether hits of rays of this shape can be written here."""
        if self._memory is not None:
            if self._memory.tracer in (None, tracer) and self._shape == shape:
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


_OURS = {"_shape", "_brief", "_arrays", "_memory", "_rays", "_made"}
_OURS_OF_ALL = {"_rays", "first", "ray", "t", "prim", "instance", "uv"}


def of_users(thing, ours):
    """What a copy gets besides its own: attributes that users have set. None: there are none."""
    return {name: value for name, value in vars(thing).items() if name not in ours} or None


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


def _hit_again(cls, shape, brief, arrays, rays):
    """From what is pickled."""
    hit = cls.__new__(cls)
    hit._begin(shape, brief, None)
    hit._arrays, hit._rays = list(arrays), rays
    return hit


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
        self.tracer = tracer.key
        handle = ctypes.c_void_p()
        check(library.clarity_kept_new(tracer._handle, int(brief), ctypes.byref(handle)))
        self.handle = handle.value
        free_with(self, library.clarity_kept_free, self.handle)

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

    def __init__(self, *_, **__):
        raise TypeError("clarity.AllHits: made by Tracer.all(origins, directions)")

    @classmethod
    def _of(cls, rays, found):
        owner = _Owner(found)

        def array(name, dtype, count):
            return owner.array(getattr(found, name), dtype, count)

        count = found.count
        return _all_hits_again(
            cls,
            Lines(rays.origins, rays.directions, rays.shape),
            first=array("first", np.int64, rays.count + 1),
            ray=array("ray", np.int64, count),
            t=array("t", np.float32, count),
            prim=array("prim", np.int32, count),
            instance=array("instance", np.int32, count),
            uv=array("uv", np.float32, 2 * count).reshape(-1, 2),
        )

    def __reduce__(self):
        arrays = self.first, self.ray, self.t, self.prim, self.instance, self.uv
        return _all_hits_again, (type(self), self._rays, *arrays), of_users(self, _OURS_OF_ALL)

    def points(self):
        """Where the hits are, in float64; of the rays as they were, as Hit.points()."""
        return self._rays.points(self.t.astype(np.float64)[:, None], self.ray)

    def __iter__(self):
        return iter((self.ray, self.t, self.prim))

    def __len__(self):
        return len(self.t)

    def __repr__(self):
        return f"<clarity.AllHits: {len(self)} of {self._rays.count} rays>"


def _all_hits_again(cls, rays, first, ray, t, prim, instance, uv):
    """From what is pickled."""
    hits = cls.__new__(cls)
    hits._rays, hits.first, hits.ray, hits.t, hits.prim, hits.instance, hits.uv = rays, first, ray, t, prim, instance, uv
    for array in (first, ray, t, prim, instance, uv):
        array.flags.writeable = False
    return hits


class _Owner:
    """Memory of the library that arrays lie in: freed when the last of them goes."""

    def __init__(self, found):
        free_with(self, library.clarity_all_hits_free, ctypes.byref(found))

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


def check_hit(out, brief):
    if not isinstance(out, Hit):
        _arguments.refuse("out", "a Hit of the same shape, as of an earlier call or clarity.Hit(shape)", out)
    if brief and not out._brief:
        raise UsageError("brief: the Hit of out= says itself whether it is brief: give clarity.Hit(shape, brief=True)")


def check_out(array, shape, dtype, name):
    good = isinstance(array, np.ndarray) and array.shape == shape and array.dtype == dtype
    if not good or not array.flags.c_contiguous or not array.flags.writeable:
        _arguments.refuse(name, f"a writeable array of {np.dtype(dtype)} in the shape {shape} without gaps", array)
    return array
