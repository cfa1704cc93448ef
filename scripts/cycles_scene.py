"""Renders a text scene of Clarity with Cycles; scripts/cycles_compare starts it within Blender:

blender -b --factory-startup -t 2 -P cycles_scene.py -- SCENE OUT W H BOUNCES SEED SPP...

Reads what both programs can show by the same numbers: cameras, polygons, triangles, spheres, lamps with a size, skies, the models
lambert, conductor (Fresnel 1) and dielectric, and files that are loaded. Anything else is an error. A .glb keeps its materials as
Blender reads them: its means differ a little, so each program is compared with its own. For each SPP it writes OUT.SPP.pfm
and a line "CPU spp seconds" (processor time of rendering). Everything of Cycles that makes pictures biased is off.

Blender 3.4 (Debian 12) and 4.3 (Debian 13) name some things otherwise: see first_of().

Lamps become meshes that emit: Cycles 3.4 draws its own round lamps as discs that face what they light.
"""
import gzip
import math
import os
import sys
import time

import bpy
import numpy as np
from mathutils import Matrix, Vector

COUNTS = {"eye": 3, "target": 3, "up": 3, "fov": 1, "center": 3, "radius": 1, "color": 3, "emission": 3, "radiance": 3, "roughness": 1,
          "ior": 1, "reflect": 1, "specular": 3, "normal": 3, "u": 3, "v": 3, "zenith": 3, "horizon": 3, "ground": 3, "rotate": 1,
          "strength": 1, "translate": 3, "scale": 3, "absorption": 3, "shininess": 1, "refract": 1}
FLAGS = ("two_sided", "one_sided", "compensate", "visible", "off")
WORDS = ("material", "model", "name", "falloff")
IGNORED = ("ambient", "background", "animate")  # of the Whitted tracers, or without a meaning at rest
SEGMENTS = (192, 96)  # of spheres, around and from pole to pole
LAMP_SEGMENTS = (48, 24)  # of lamps: Cycles 3.4 sums the areas of all triangles as floats, in which many small ones get lost


def die(text):
    print("cycles_scene: " + text, flush=True)
    os._exit(1)


def first_of(owner, name, *values):
    """Sets a property to the first of these values that this version of Blender knows."""
    for value in values:
        try:
            return setattr(owner, name, value)
        except TypeError:
            pass
    die("this Blender knows none of %s for %s" % (", ".join(values), name))


LINEAR = ("Linear", "Linear Rec.709")  # colour spaces
SHARP = ("SHARP", "GGX")  # of mirrors and clear glass: by their roughness of 0 alone since Blender 4.0


def words_of(line):
    """The words of a line. Quotes hold words together, # starts a comment outside of them."""
    words, quoted = [], False
    for part in line.split('"'):
        if quoted:
            words.append(part)
        else:
            words += part.split("#")[0].split()
            if "#" in part:
                break
        quoted = not quoted
    return words


def is_number(word):
    try:
        float(word)
        return True
    except ValueError:
        return False


def keys_of(words, where):
    """The pairs of a statement as a dict; rotations of a load are a list in the order of the file."""
    keys, at = {}, 0
    while at < len(words):
        key = words[at]
        end = at + 1
        while end < len(words) and is_number(words[end]):
            end += 1
        numbers = [float(w) for w in words[at + 1:end]]
        if key == "vertices":
            keys[key] = np.array(numbers).reshape(-1, 3)
        elif key == "rotate" and len(numbers) == 4:
            keys.setdefault(key, []).append(numbers)
        elif key in WORDS:
            keys[key], end = words[at + 1], at + 2
        elif key in FLAGS:
            said = end < len(words) and words[end] in ("true", "false")
            keys[key] = not said or words[end] == "true"
            end += said
        elif key in COUNTS and len(numbers) in (1, COUNTS[key]):
            keys[key] = numbers * COUNTS[key] if len(numbers) < COUNTS[key] else numbers
            keys[key] = keys[key][0] if COUNTS[key] == 1 else keys[key]
        else:
            die("%s: `%s` is not compared" % (where, key))
        at = end
    return keys


def blender_axes(v):
    """Y up to Z up."""
    return Vector((v[0], -v[2], v[1]))


TO_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))


class Scene:
    def __init__(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        self.camera = None
        self.sky = None
        self.count = 0
        self.lamps = []

    # ---- statements
    def read(self, path, override=None):
        folder = os.path.dirname(os.path.abspath(path))
        with open(path) as file:
            lines = [(number + 1, words_of(line)) for number, line in enumerate(file)]
        lines = [("%s:%d" % (path, number), words) for number, words in lines if words]
        materials = {}
        for where, words in lines:
            if words[0] == "material" and not override:
                materials[words[1]] = (keys_of(words[2:], where), where)
        made = {}

        def material(keys):
            if override:
                return override
            name = keys.get("material")
            if name not in made:
                made[name] = self.material(*materials.get(name, ({}, "a surface without a material")))
            return made[name]

        switched = {}
        for where, words in lines:
            if words[0] == "edit":
                if words[1] != "light" or words[3:] != ["off"]:
                    die(where + ": only lamps that are switched off are compared")
                switched[int(words[2])] = True
        for where, words in lines:
            kind = words[0]
            if kind in ("material", "edit") or kind in IGNORED:
                continue
            if kind == "camera":
                if self.camera is None:
                    self.camera = keys_of(words[2:], where)
            elif kind == "sky":
                self.sky = self.sky or (words[1:], where, folder)
            elif kind == "light":
                self.lamps.append((words[1], words[2:], where))
            elif kind in ("polygon", "triangle"):
                keys = keys_of(words[1:], where)
                points = keys["vertices"]
                self.mesh(points, [tuple(range(len(points)))], material(keys))
            elif kind == "sphere":
                keys = keys_of(words[1:], where)
                self.sphere(keys.get("center", [0, 0, 0]), keys.get("radius", 1.0), material(keys))
            elif kind == "load":
                keys = keys_of(words[2:], where)
                self.load(os.path.join(folder, words[1]), keys, material(keys) if "material" in keys else override, where)
            else:
                die("%s: `%s` is not compared" % (where, kind))
        for number in switched:
            self.lamps[number] = None

    def load(self, path, keys, override, where):
        if path.endswith(".scene"):
            if set(keys) - {"material", "name"}:
                die(where + ": a scene that is moved is not compared")
            return self.read(path, override)
        if override is None and not path.endswith(".glb"):
            die(where + ": materials of files are not compared but those of .glb; give one")
        world = Matrix.Translation(Vector(keys.get("translate", (0, 0, 0))))
        for x, y, z, degrees in reversed(keys.get("rotate", [])):
            world = world @ Matrix.Rotation(math.radians(degrees), 4, Vector((x, y, z)))
        world = TO_BLENDER @ world @ Matrix.Diagonal((*keys.get("scale", (1, 1, 1)), 1)) @ TO_BLENDER.inverted()
        if path.endswith((".ply", ".ply.gz")):
            objects = [self.mesh(*read_ply(path), override)]
        elif path.endswith(".fbx"):
            before = set(bpy.data.objects)
            bpy.ops.import_scene.fbx(filepath=path)
            objects = [o for o in bpy.data.objects if o not in before]
        elif path.endswith(".glb"):
            before = set(bpy.data.objects)
            np.bool = bool  # which Blender 3.4's importer uses, and numpy 1.24 has no longer
            bpy.ops.import_scene.gltf(filepath=path)
            objects = [o for o in bpy.data.objects if o not in before]
            cut_out(bpy.data.materials)
        else:
            die(where + ": files of this kind are not compared")
        bpy.context.view_layer.update()
        places = [(o, world @ o.matrix_world) for o in objects]
        for o, place in places:
            o.parent = None
            o.matrix_world = place
            if o.type == "MESH" and override:
                o.data.materials.clear()
                o.data.materials.append(override)

    # ---- shapes
    def mesh(self, points, faces, material, smooth_normals=None):
        self.count += 1
        mesh = bpy.data.meshes.new("m%d" % self.count)
        points = np.asarray(points, np.float64)
        turned = np.stack([points[:, 0], -points[:, 2], points[:, 1]], 1)
        if isinstance(faces, np.ndarray):  # triangles
            mesh.vertices.add(len(turned))
            mesh.vertices.foreach_set("co", turned.astype(np.float32).ravel())
            mesh.loops.add(faces.size)
            mesh.loops.foreach_set("vertex_index", faces.astype(np.int32).ravel())
            mesh.polygons.add(len(faces))
            mesh.polygons.foreach_set("loop_start", np.arange(0, faces.size, 3, dtype=np.int32))
            if bpy.app.version < (3, 6):  # later ones know it by where the next one starts
                mesh.polygons.foreach_set("loop_total", np.full(len(faces), 3, np.int32))
            mesh.update(calc_edges=True)
        else:
            mesh.from_pydata([tuple(p) for p in turned], [], faces)
        if smooth_normals is not None:
            mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        mesh.materials.append(material)
        thing = bpy.data.objects.new(mesh.name, mesh)
        self.scene.collection.objects.link(thing)
        return thing

    def sphere(self, center, radius, material, segments=SEGMENTS):
        """A smooth ball of flat faces with the area of the sphere. In the mean over directions it looks as large as the sphere
        (Cauchy's formula), so as a lamp it gives as much light."""
        around, down = segments
        theta = np.linspace(0, math.pi, down + 1)[1:-1, None]
        phi = np.linspace(0, 2 * math.pi, around, endpoint=False)[None, :]
        ring = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
        points = np.concatenate([[[0, 1, 0]], ring, [[0, -1, 0]]])
        faces = []
        for i in range(around):
            j = (i + 1) % around
            faces.append((0, 1 + j, 1 + i))
            for k in range(down - 2):
                a = 1 + k * around
                faces.append((a + i, a + j, a + around + j, a + around + i))
            last = 1 + (down - 2) * around
            faces.append((last + i, last + j, len(points) - 1))
        poles = np.linspace(0, math.pi, down + 1)
        sides, heights = 2 * math.sin(math.pi / around) * np.sin(poles), np.cos(poles[:-1]) - np.cos(poles[1:])
        slopes = np.hypot(heights, np.diff(np.sin(poles)) * math.cos(math.pi / around))
        area = around * ((sides[:-1] + sides[1:]) / 2 * slopes).sum()
        self.mesh(np.array(center) + points * radius * math.sqrt(4 * math.pi / area), faces, material, True)

    # ---- materials and lamps
    def shader(self):
        self.count += 1
        material = bpy.data.materials.new("s%d" % self.count)
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        return material, tree, tree.nodes.new("ShaderNodeOutputMaterial")

    def material(self, keys, where):
        material, tree, out = self.shader()
        model = keys.get("model", "whitted")
        color = (*keys.get("color", (0.7, 0.7, 0.7)), 1)
        rough = keys.get("roughness", 0)
        if keys.get("reflect", 0) or keys.get("refract", 0) or any(keys.get("absorption", ())) or keys.get("compensate") is False:
            die(where + ": only lambert, conductor and dielectric are compared")
        if model in ("lambert", "whitted"):
            node = tree.nodes.new("ShaderNodeBsdfDiffuse")
            node.inputs["Roughness"].default_value = 0
        elif model == "conductor":
            if min(color) != 1:
                die(where + ": a conductor is compared with `color 1` alone, because Cycles has no Fresnel term here")
            node = tree.nodes.new("ShaderNodeBsdfGlossy")
            first_of(node, "distribution", *(("MULTI_GGX",) if rough else SHARP))
            node.inputs["Roughness"].default_value = rough
        else:
            node = tree.nodes.new("ShaderNodeBsdfGlass")
            if rough:
                die(where + ": rough glass is not compared")
            first_of(node, "distribution", *SHARP)
            node.inputs["Roughness"].default_value = 0
            node.inputs["IOR"].default_value = keys.get("ior", 1.5)
        node.inputs["Color"].default_value = color
        result = node.outputs[0]
        if any(keys.get("emission", ())):
            result = self.emits(tree, keys["emission"], keys.get("one_sided", False), None if max(color[:3]) == 0 else result)
        tree.links.new(result, out.inputs[0])
        return material

    def emits(self, tree, radiance, one_sided, besides=None):
        emission = tree.nodes.new("ShaderNodeEmission")
        emission.inputs[0].default_value = (*radiance, 1)
        emission.inputs[1].default_value = 1
        result = emission.outputs[0]
        if one_sided:
            mix = tree.nodes.new("ShaderNodeMixShader")
            tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], mix.inputs[0])
            tree.links.new(result, mix.inputs[1])
            result = mix.outputs[0]
        if besides:
            both = tree.nodes.new("ShaderNodeAddShader")
            tree.links.new(result, both.inputs[0])
            tree.links.new(besides, both.inputs[1])
            result = both.outputs[0]
        return result

    def lamp(self, kind, keys, where):
        center = np.array(keys.get("center", (0, 10, 0)))
        material, tree, out = self.shader()
        tree.links.new(self.emits(tree, keys.get("radiance", (1, 1, 1)), not keys.get("two_sided", False)), out.inputs[0])
        if kind == "sphere":
            self.sphere(center, keys.get("radius", 1.0), material, LAMP_SEGMENTS)
        elif kind == "rect":
            u, v = np.array(keys.get("u", (1, 0, 0))), np.array(keys.get("v", (0, 0, 1)))
            self.mesh([center - u - v, center + u - v, center + u + v, center - u + v], [(0, 1, 2, 3)], material)
        else:
            die("%s: a lamp of kind %s is not compared" % (where, kind))

    def world(self):
        world = bpy.data.worlds.new("w")
        self.scene.world = world
        world.use_nodes = True
        tree = world.node_tree
        tree.nodes.clear()
        ground, out = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
        tree.links.new(ground.outputs[0], out.inputs[0])
        ground.inputs[0].default_value = (0, 0, 0, 1)
        if not self.sky:
            return
        words, where, folder = self.sky
        kind = words[0]
        if kind == "constant":
            ground.inputs[0].default_value = (*(float(w) for w in (words[1:4] if len(words) > 2 else words[1:2] * 3)), 1)
            return
        world.cycles.sampling_method = "MANUAL"
        world.cycles.sample_map_resolution = 1024
        keys = keys_of(words[1:], where)
        ground.inputs[1].default_value = keys.get("strength", 1)
        if keys.get("rotate", 0) or keys.get("visible") is False:
            die(where + ": a sky that is turned or hidden is not compared")
        if kind == "gradient":
            return self.gradient(tree, keys, ground.inputs[0])
        node = tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = bpy.data.images.load(os.path.join(folder, kind))
        first_of(node.image.colorspace_settings, "name", *LINEAR)
        node.interpolation = "Linear"
        tree.links.new(node.outputs[0], ground.inputs[0])

    def gradient(self, tree, keys, target):
        """From horizon to zenith by the height of the direction, and the ground below 0."""
        place, parts = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeSeparateXYZ")
        tree.links.new(place.outputs["Generated"], parts.inputs[0])
        below = tree.nodes.new("ShaderNodeMath")
        below.operation = "LESS_THAN"
        below.inputs[1].default_value = 0
        above, whole = tree.nodes.new("ShaderNodeMixRGB"), tree.nodes.new("ShaderNodeMixRGB")
        for node, factor in ((above, parts.outputs[2]), (whole, below.outputs[0])):
            node.use_clamp = False
            tree.links.new(factor, node.inputs[0])
        tree.links.new(parts.outputs[2], below.inputs[0])
        above.inputs[1].default_value = (*keys.get("horizon", (0, 0, 0)), 1)
        above.inputs[2].default_value = (*keys.get("zenith", (1, 1, 1)), 1)
        tree.links.new(above.outputs[0], whole.inputs[1])
        whole.inputs[2].default_value = (*keys.get("ground", (0, 0, 0)), 1)
        tree.links.new(whole.outputs[0], target)

    def finish(self):
        for lamp in self.lamps:
            if lamp:
                self.lamp(lamp[0], keys_of(lamp[1], lamp[2]), lamp[2])
        self.world()
        keys = self.camera or die("the scene has no camera")
        data = bpy.data.cameras.new("camera")
        camera = bpy.data.objects.new("camera", data)
        self.scene.collection.objects.link(camera)
        self.scene.camera = camera
        eye, target = blender_axes(keys.get("eye", (0, 0, 5))), blender_axes(keys.get("target", (0, 0, 0)))
        back, up = (eye - target).normalized(), blender_axes(keys.get("up", (0, 1, 0)))
        right = up.cross(back).normalized()
        camera.matrix_world = Matrix.Translation(eye) @ Matrix((right, back.cross(right), back)).transposed().to_4x4()
        data.sensor_fit = "VERTICAL"
        data.angle_y = math.radians(keys.get("fov", 45))
        data.clip_start, data.clip_end = 1e-4, 1e6


def cut_out(materials):
    """Blender shows `alpha mask` by a setting of its own window; Cycles needs a node for it."""
    for material in materials:
        if material.blend_method != "CLIP" or not material.use_nodes:
            continue
        tree = material.node_tree
        for node in [n for n in tree.nodes if n.type == "BSDF_PRINCIPLED"]:
            alpha = node.inputs["Alpha"]
            step = tree.nodes.new("ShaderNodeMath")
            step.operation = "LESS_THAN"
            inside = tree.nodes.new("ShaderNodeMath")
            inside.operation = "SUBTRACT"
            inside.inputs[0].default_value = 1
            step.inputs[0].default_value, step.inputs[1].default_value = alpha.default_value, material.alpha_threshold
            for link in list(alpha.links):
                tree.links.new(link.from_socket, step.inputs[0])
            tree.links.new(step.outputs[0], inside.inputs[1])
            tree.links.new(inside.outputs[0], alpha)


def read_ply(path):
    """Points and triangles of a binary PLY without other properties."""
    data = (gzip.open if path.endswith(".gz") else open)(path, "rb").read()
    end = data.index(b"end_header\n") + 11
    head = data[:end].decode().split("\n")
    counts = {w[1]: int(w[2]) for w in (line.split() for line in head) if w[:1] == ["element"]}
    if [line.split()[-1] for line in head if line.startswith("property")] != ["x", "y", "z", "vertex_indices"]:
        die(path + ": only a PLY of positions and triangles is compared")
    points = np.frombuffer(data, "<f4", 3 * counts["vertex"], end).reshape(-1, 3)
    faces = np.frombuffer(data, np.dtype([("n", "u1"), ("i", "<i4", 3)]), counts["face"], end + points.nbytes)
    if not (faces["n"] == 3).all():
        die(path + ": only triangles are compared")
    return points, faces["i"]


def unbiased(scene, width, height, bounces):
    cycles, render = scene.cycles, scene.render
    render.engine = "CYCLES"
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.pixel_filter_type = "BOX"
    first_of(cycles, "sampling_pattern", "SOBOL", "TABULATED_SOBOL")
    cycles.min_light_bounces = cycles.min_transparent_bounces = 0
    cycles.transparent_max_bounces = 64
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.use_auto_tile = False
    for thing in bpy.data.objects:
        for owner in (thing, thing.cycles):
            for key in ("shadow_terminator_geometry_offset", "shadow_terminator_offset"):
                if hasattr(owner, key):
                    setattr(owner, key, 0.0)
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.use_persistent_data = True
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode, render.image_settings.color_depth = "RGB", "32"
    scene.view_settings.view_transform = "Raw"


def exr_as_pfm(picture, out):
    image = bpy.data.images.load(picture)
    first_of(image.colorspace_settings, "name", *LINEAR)
    values = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(values)
    with open(out, "wb") as file:
        file.write(b"PF\n%d %d\n-1.0\n" % tuple(image.size))
        file.write(values.reshape(-1, 4)[:, :3].astype("<f4").tobytes())
    bpy.data.images.remove(image)


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:]
    path, out = arguments[:2]
    width, height, bounces, seed, *samples = (int(a) for a in arguments[2:])
    built = Scene()
    built.read(path)
    built.finish()
    scene = built.scene
    unbiased(scene, width, height, bounces)

    def render(spp, name):
        scene.cycles.samples, scene.cycles.seed = spp, seed
        scene.render.filepath = name
        begin = time.process_time()
        bpy.ops.render.render(write_still=True)
        return time.process_time() - begin

    picture = out + ".exr"
    render(1, picture)  # builds the structure, which is kept
    for spp in samples:
        seconds = render(spp, picture)
        exr_as_pfm(picture, "%s.%d.pfm" % (out, spp))
        print("CPU %d %.3f" % (spp, seconds), flush=True)
    os.remove(picture)


try:
    main()
except Exception as error:  # Blender would go on, with exit code 0
    die("%s: %s" % (type(error).__name__, error))
