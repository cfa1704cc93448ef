"""Scenes, and tracers: scenes in a structure on a device."""
import ctypes
import json
import os
import time

import numpy as np

from . import _arguments
from ._binding import constants, library, struct, texts
from ._calls import call, check, free_with
from ._errors import UsageError
from ._rays import AllHits, Hit, Kept, Packed, Rays, address_of, array_of, arrays_of_rays, as_array, asked, check_hit, check_out, held, of_users, rays_of

_MOST_PIXELS = 16384  # of a side, as the setting `size`

# Rays that are traced before a person waits: no thread is started for them. A start takes up to 0.1 ms, in which a GPU traces a
# million rays; so a tracer learns how fast it is.
_FEW, _SHORT_S = 4096, 0.005


class Scene:
    """What files or arrays describe. Scene(vertices, faces): triangles of arrays of the shapes (n, 3). float32 vertices and uint32
    faces without gaps are lent, not copied: they must not change while the scene or a tracer of it lives."""

    _handle = None

    def __init__(self, vertices, faces, *, progress=None):
        given = vertices, faces
        vertices = np.ascontiguousarray(as_array(vertices, "vertices"))
        faces = array_of(faces, "faces")
        for name, array in (("vertices", vertices), ("faces", faces)):
            if array.ndim != 2 or array.shape[1] != 3:
                raise UsageError(f"{name}: expected an array of shape (n, 3), found {array.shape}")
        if faces.dtype.kind not in "iu":
            raise UsageError(f"faces: expected whole numbers, found an array of {faces.dtype}")
        if faces.size and (int(faces.min()) < 0 or int(faces.max()) >= len(vertices)):
            raise UsageError(f"faces: the numbers {faces.min()} to {faces.max()} do not fit {len(vertices)} vertices")
        faces = np.ascontiguousarray(faces, np.uint32)
        self._lent = vertices, faces
        arrays = tuple(held(array, one, name) for array, one, name in zip(self._lent, given, ("vertices", "faces")))
        self._again = lambda: (_scene_of_arrays, *map(asked, arrays))
        double = vertices.dtype == np.float64
        mesh = struct(
            "clarity_mesh",
            type=constants["CLARITY_FLOAT64" if double else "CLARITY_FLOAT32"],
            vertex_count=len(vertices),
            triangle_count=len(faces),
            positions=vertices.ctypes.data,
            triangles=faces.ctypes.data,
        )
        self._take(library.clarity_scene_from_mesh, ctypes.byref(mesh), progress=progress)

    def _take(self, function, *arguments, progress):
        handle = ctypes.c_void_p()

        def made(*words):
            return function(*words, ctypes.byref(handle))

        try:
            call(made, *arguments, progress=progress)
        finally:
            if handle:
                free_with(self, library.clarity_scene_free, handle.value)
        self._handle = handle.value
        text = ctypes.c_char_p()
        check(library.clarity_scene_info(self._handle, ctypes.byref(text)))
        self.info = json.loads(text.value.decode(errors="replace"))
        self.warnings = self.info["warnings"]

    @property
    def bounds(self):
        """The box of everything finite as an array of two points in float64; None if there is nothing."""
        box = np.empty((2, 3))
        check(library.clarity_scene_bounds(self._handle, box[0].ctypes.data, box[1].ctypes.data))
        return box if box[0, 0] <= box[1, 0] else None

    def on(self, device="", accel="", *, progress=None, **settings):
        """A tracer of this scene. device and accel: texts as of --device and --accel; "": the best. progress: True for a line on
        stderr, or a function of the stage and the fraction that is done (None: not known), which returns False to cancel."""
        return Tracer._of(self, device, accel, settings, progress)

    def __repr__(self):
        if self._handle is None:
            return "<clarity.Scene that was not made>"
        kinds = {kind: self.info[kind] for kind in ("triangles", "polygons", "spheres", "planes")}
        kinds.update((f"{kind} shapes", count) for kind, count in self.info["shapes"].items())
        parts = [f"{count} {kind[:-1] if count == 1 else kind}" for kind, count in kinds.items() if count]
        return f"<clarity.Scene: {', '.join(parts) or 'nothing to hit'}>"

    def __copy__(self):
        return self  # what it describes does not change

    def __reduce__(self):
        """For another process: arrays by value, files by their absolute paths, from which they are imported again."""
        if self._handle is None:
            raise UsageError("a clarity.Scene that was not made cannot be pickled or copied")
        make, *arguments = self._again()
        return make, (type(self), *arguments), of_users(self, _OURS)


_OURS = {"_handle", "_lent", "_again", "info", "warnings"}


def _scene_of_arrays(cls, vertices, faces):
    """From what is pickled."""
    scene = cls.__new__(cls)
    Scene.__init__(scene, vertices, faces)
    return scene


def _scene_of_files(cls, *files, progress=None):
    scene = cls.__new__(cls)
    names = [_arguments.file(file, "load(*files)") for file in files]
    paths = tuple(map(os.path.abspath, names))
    scene._lent = None
    scene._again = lambda: (_scene_of_files, *paths)
    scene._take(library.clarity_scene_load, texts(names), len(names), progress=progress)
    return scene


def load(*files, progress=None):
    """A scene from files."""
    return _scene_of_files(Scene, *files, progress=progress)


class Tracer:
    """A scene in a structure on a device; made by Scene.on()."""

    def __init__(self, *_, **__):
        raise TypeError("clarity.Tracer: made by Scene.on(device, accel, **settings)")

    @classmethod
    def _of(cls, scene, device, accel, settings, progress):
        self = cls.__new__(cls)
        self.scene = scene
        self.key = object()  # of this tracer, unlike its handle, for ever
        self._lent = scene._lent
        self._few = {}  # of each function whose kernels are compiled: how many rays take less than _SHORT_S
        words = texts(_arguments.settings(settings))
        names = {"device": _arguments.choice(device, "device"), "accel": _arguments.choice(accel, "accel")}
        given = {**{name: value for name, value in (("device", device), ("accel", accel)) if value}, **settings}
        self._call = f"scene.on({', '.join(f'{name}={value!r}' for name, value in given.items())})"
        options = struct("clarity_options", settings=words, **names)
        handle = ctypes.c_void_p()

        def made(watch):
            return library.clarity_tracer_new(scene._handle, ctypes.byref(options), watch, ctypes.byref(handle))

        try:
            call(made, progress=progress)
        finally:
            if handle:
                free_with(self, library.clarity_tracer_free, handle.value)
        self._handle = handle.value
        info = self.info
        self._label = f"{info['accel']} on {info['device']}"
        return self

    def __reduce_ex__(self, _protocol):
        raise TypeError(f"a clarity.Tracer cannot be pickled or copied: it lies on a device; send its scene, and call {self._call} there")

    def __repr__(self):
        return f"<clarity.Tracer: {self._label}, of {self.scene!r}>"

    def _trace(self, function, rays, to, progress):
        name = function.__name__
        few = self._few.get(name, 0)
        if rays.count <= few and progress is None:
            if rays.count < _FEW:
                return check(function(self._handle, rays.struct, to, None))
            begin = time.perf_counter()
            check(function(self._handle, rays.struct, to, None))
        else:
            begin = time.perf_counter()
            call(function, self._handle, rays.struct, to, progress=progress)
        if not few:
            self._few[name] = _FEW if rays.count else 0
        elif rays.count >= _FEW:
            short = rays.count * _SHORT_S / (time.perf_counter() - begin)
            self._few[name] = max(_FEW, min(int(short), 2 * few))

    @property
    def info(self):
        """A dictionary: device, accel, accel_stats, ... as of `clarity render --stats`, and of the ray queries so far rays, device_ms,
        bytes_to_device and bytes_from_device."""
        text = ctypes.c_char_p()
        check(library.clarity_tracer_info(self._handle, ctypes.byref(text)))
        return json.loads(text.value.decode(errors="replace"))

    def closest(self, origins, directions=None, t_min=None, t_max=None, *, mask=None, brief=False, out=None, progress=None):
        """The nearest hits of rays as a Hit. Rays of pack(), or arrays of float32 or float64 in any strides, broadcast against each other. mask: the
        rays hit only instances that share a bit of it with their mask. brief: only t and prim, faster. out: a Hit of the same
        shape, which is filled and returned. Hits of many rays stay on the device until they are read."""
        if brief is not False:
            brief = _arguments.flag(brief, "brief")
        rays = rays_of(origins, directions, t_min, t_max, mask, True)
        if out is None:
            hit = Hit._on(rays.shape, brief, None if rays.count < _FEW else self)
        else:
            hit = out
            if brief or type(hit) is not Hit:
                check_hit(hit, brief)
            hit._check(rays.shape, self.key)
            hit._rays = None  # of a call that fails
        memory = hit._memory  # stays, whatever another thread does to the hit
        if type(memory) is Kept:
            self._trace(library.clarity_keep, rays, memory.handle, progress)
        else:
            self._trace(library.clarity_closest, rays, hit._struct(), progress)
        hit._rays = rays if type(rays) is Rays else rays._lines
        return hit

    def move(self, vertices=None, *, instances=None, progress=None):
        """Moves what this tracer traces: its structure is refitted, or built anew where that pays. vertices: of a scene of arrays, in
        the shape they had. instances: world from object of each instance, in the shape (n, 3, 4) or (n, 4, 4). scene.bounds and
        cameras stay."""
        values = {}
        arrays = {}
        if vertices is not None:
            arrays["positions"] = as_array(vertices, "vertices")
            if arrays["positions"].ndim != 2 or arrays["positions"].shape[1] != 3:
                raise UsageError(f"vertices: expected an array of shape (n, 3), found {arrays['positions'].shape}")
            values["vertex_count"] = len(arrays["positions"])
        if instances is not None:
            array = as_array(instances, "instances")
            if array.ndim != 3 or array.shape[1:] not in ((3, 4), (4, 4)):
                raise UsageError(f"instances: expected an array of shape (n, 3, 4) or (n, 4, 4), found {array.shape}")
            arrays["transforms"] = array[:, :3]
            values["instance_count"] = len(array)
        if not arrays:
            raise UsageError("move: expected vertices or instances")
        dtype = max(array.dtype for array in arrays.values())
        arrays = {name: np.ascontiguousarray(array, dtype) for name, array in arrays.items()}
        values.update((name, address_of(array)) for name, array in arrays.items())
        places = struct("clarity_places", type=constants["CLARITY_FLOAT64" if dtype == np.float64 else "CLARITY_FLOAT32"], **values)
        call(library.clarity_move, self._handle, ctypes.byref(places), progress=progress)

    def pack(self, origins, directions=None, t_min=None, t_max=None, *, progress=None):
        """Rays that are traced often: they are read from the arrays once, and stay on the device, 32 bytes each. closest() and
        any() of this tracer take them instead of origins and directions."""
        if isinstance(origins, Packed):
            raise UsageError("pack: the rays are packed already")
        rays = Rays(origins, directions, t_min, t_max, None, True)
        handle = ctypes.c_void_p()

        def made(watch):
            return library.clarity_pack(self._handle, rays.struct, watch, ctypes.byref(handle))

        try:
            call(made, progress=progress)
        except BaseException:
            library.clarity_packed_free(handle)
            raise
        return Packed._of(rays, handle.value)

    def any(self, origins, directions=None, t_min=None, t_max=None, *, mask=None, out=None, progress=None):
        """An array of bool: whether rays hit anything between t_min and t_max."""
        rays = rays_of(origins, directions, t_min, t_max, mask)
        occluded = np.empty(rays.shape, bool) if out is None else check_out(out, rays.shape, bool, "out")
        self._trace(library.clarity_any, rays, address_of(occluded), progress)
        return occluded

    def count(self, origins, directions=None, t_min=None, t_max=None, *, mask=None, out=None, progress=None):
        """An array of int64: how many hits each ray has with t_min <= t < t_max."""
        rays = arrays_of_rays("count", origins, directions, t_min, t_max, mask)
        counts = np.empty(rays.shape, np.int64) if out is None else check_out(out, rays.shape, np.int64, "out")
        call(library.clarity_count, self._handle, rays.struct, address_of(counts), progress=progress)
        return counts

    def all(self, origins, directions=None, t_min=None, t_max=None, *, mask=None, progress=None):
        """All hits of each ray, not only the nearest, as an AllHits: ray, t, prim = rt.all(origins, directions)."""
        rays = arrays_of_rays("all", origins, directions, t_min, t_max, mask, True)
        found = struct("clarity_all_hits")
        call(library.clarity_all, self._handle, rays.struct, ctypes.byref(found), progress=progress)
        return AllHits._of(rays, found)

    def render(self, width, height, *, camera=None, light=None, out=None, progress=None, **settings):
        """A picture as an array of float32, the top row first: (height, width, 3) for colours and vectors, else (height, width).
        settings: spp=16, tracer="path", depth=8, aov="t", and all others of --set. camera, light: texts as of --camera and
        --light, or their numbers."""
        size = f"{_arguments.whole(width, 'width of the size', 1, _MOST_PIXELS)}x{_arguments.whole(height, 'height of the size', 1, _MOST_PIXELS)}"
        if "size" in settings:
            raise UsageError("setting `size`: the picture has its size from width and height: leave it out")
        words = texts(_arguments.settings({"size": size, **settings}))
        picture = struct("clarity_picture", settings=words, camera=_arguments.numbers(camera, "camera"), light=_arguments.numbers(light, "light"))
        check(library.clarity_render(self._handle, ctypes.byref(picture), None))
        shape = (picture.height, picture.width) + ((picture.channels,) if picture.channels > 1 else ())
        pixels = np.empty(shape, np.float32) if out is None else check_out(out, shape, np.float32, "out")
        picture.room, picture.pixels = pixels.size, address_of(pixels)
        call(library.clarity_render, self._handle, ctypes.byref(picture), progress=progress)
        return pixels
