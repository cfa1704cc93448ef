#include "kernels/kernel_source.hpp"

#include <vector>

#include "device/source_writer.hpp"
#include "kernels/scene_buffers.hpp"
#include "kernels/scene_features.hpp"
#include "plugin/capabilities.hpp"
#include "rt_types.h"
#include "scene/bright_texture.hpp"
#include "scene/scene.hpp"
#include "scene/surface_models.hpp"

namespace clarity {
namespace {

// Writes a plugin's traversal into a kernel: the buffers that it reads, and one instance of its
// template for each of {scene, mesh} x {nearest hit, any hit}. cl/CONTRACT.md says what a traversal may use.

// A plugin's traversal as a template. The text is read once; the flags apply to all instances.
struct TraversalTemplate {
    std::string file, text;
    bool cpu = false;       // with leaf tests in two steps, and tests of a single ray against several primitives
    bool requeues = false;  // with RT_TRAVERSE_REQUEUED
    bool by_warps = false;  // with RT_TRAVERSE_WARP
    bool spreads = false;   // it traces one ray, and the host spreads packets over it (RT_TRAVERSES_SINGLE_RAYS)
};

// Macros by which a traversal calls leaf tests. The names of the functions are rt_leaf_mesh or rt_leaf_scene plus the suffix.
struct LeafStep {
    const char *macro, *suffix;
    bool cpu_only;
};
constexpr LeafStep kLeafSteps[] = {{"RT_LEAF", "", false},
                                   {"RT_LEAF_CANDIDATE", "_candidate", true},
                                   {"RT_LEAF_TEST", "_test", true},
                                   {"RT_SINGLE_RAY_CANDIDATES", "_candidates", true},
                                   {"RT_SINGLE_RAY_TEST", "_single_ray", true}};

// These prototypes make a plugin's functions inline, whether or not the author declared them so.
constexpr const char* kPrototypes =
    "RT_INLINE void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit);\n"
    "#if RT_STREAM > 1\n"
    "RT_INLINE void RT_TRAVERSE_STREAM(const rt_ctx *ctx, uint root, const rt_rays *rays, rt_hits *hits, uint count);\n"
    "#endif\n"
    "#ifdef RT_TRAVERSE_REQUEUED\n"
    "RT_INLINE void RT_TRAVERSE_REQUEUED(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit, "
    "local rt_requeue_scratch *shared);\n"
    "#endif\n"
    "#ifdef RT_TRAVERSE_WARP\n"
    "RT_INLINE void RT_TRAVERSE_WARP(const rt_ctx *ctx, uint root, uint octant, const rt_rays *rays, rt_hits *hits);\n"
    "#endif";
constexpr const char* kSingleRayPrototype =
    "RT_INLINE void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit);";

// One instance of the template. name: name of the traversal's function, leaf: of the leaf tests' functions, both without the
// query's suffix. mixed: whether leaves may hold other primitives than triangles. instances: whether they may hold instances.
struct TraversalInstance {
    std::string name, leaf;
    bool mixed, instances;
};

void define_function(SourceWriter& out, const std::string& macro, const std::string& function) {
    out.line("#define " + macro + " RT_FN(" + function + ")");
}

// A traversal of one ray: its leaf tests, the traversal, and the function that spreads a packet over it.
void write_spread_traversal(SourceWriter& out, const TraversalTemplate& traversal, const TraversalInstance& instance) {
    define_function(out, "RT_TRAVERSE", instance.name + "_ray");
    define_function(out, "RT_TRAVERSE_PACKET", instance.name);
    define_function(out, "RT_LEAF", instance.leaf + "_ray");
    define_function(out, "RT_PACKET_LEAF", instance.leaf);
    out.define_int("RT_TRIANGLES_ONLY", !instance.mixed);
    out.define_int("RT_SINGLE_RAY_MIXED", instance.mixed);
    out.include("primitives/leaf_spread.h");
    out.line(kSingleRayPrototype);
    out.part(traversal.file, traversal.text);
    out.include("primitives/spread_packet.h");
    for (const char* macro :
         {"RT_TRAVERSE", "RT_TRAVERSE_PACKET", "RT_LEAF", "RT_PACKET_LEAF", "RT_TRIANGLES_ONLY", "RT_SINGLE_RAY_MIXED"})
        out.undef(macro);
}

void write_traversal(SourceWriter& out, const TraversalTemplate& traversal, const TraversalInstance& instance) {
    if (traversal.spreads) return write_spread_traversal(out, traversal, instance);
    const auto each_step = [&](const auto& write) {
        for (const LeafStep& step : kLeafSteps)
            if (traversal.cpu || !step.cpu_only) write(std::string(step.macro), instance.leaf + step.suffix);
    };
    define_function(out, "RT_TRAVERSE", instance.name);
    define_function(out, "RT_LOADED_PRIM", "rt_loaded_prim");
    define_function(out, "RT_TRAVERSE_STREAM", instance.name + "_stream");
    if (traversal.requeues) define_function(out, "RT_TRAVERSE_REQUEUED", instance.name + "_long");
    if (traversal.by_warps) define_function(out, "RT_TRAVERSE_WARP", instance.name + "_warp");
    if (instance.instances) {
        define_function(out, "RT_ENTER_INSTANCE", "rt_enter_instance");
        define_function(out, "RT_LEAVE_INSTANCE", "rt_leave_instance");
        define_function(out, "RT_WORLD_LEAF", "rt_leaf_world");
    }
    out.define_int("RT_TRIANGLES_ONLY", !instance.mixed);
    each_step([&](const std::string& macro, const std::string& function) { define_function(out, macro, function); });
    if (traversal.cpu) {
        out.define_int("RT_SINGLE_RAY_MIXED", instance.mixed);
        out.include("primitives/leaf_single_ray.h");
    }
    out.line(kPrototypes);
    out.part(traversal.file, traversal.text);
    each_step([&](const std::string& macro, const std::string&) { out.undef(macro); });
    for (const char* macro :
         {"RT_TRAVERSE", "RT_TRAVERSE_STREAM", "RT_TRAVERSE_REQUEUED", "RT_TRAVERSE_WARP", "RT_LOADED_PRIM",
          "RT_ENTER_INSTANCE", "RT_LEAVE_INSTANCE", "RT_WORLD_LEAF", "RT_TRIANGLES_ONLY", "RT_SINGLE_RAY_MIXED"})
        out.undef(macro);
}

// Writes rt_ctx: the scene's buffers and the structure's slots, as a struct, as kernel arguments, and as initialisation.
// Returns the names of the arguments, separated by commas. picks_lights: with the buffers of kernels with kPicksLights.
std::string write_context(SourceWriter& out, const rt_accel& accel, const SceneFeatures& features, bool picks_lights) {
    out.line("#line 1 \"generated context\"\ntypedef struct rt_ctx {");
    std::string names, params, init;
    std::ostringstream checks;
    // If a size differs between host and device, compiling fails, and the message names what was checked.
    const auto check = [&](const std::string& type, const std::string& checked, size_t bytes) {
        checks << "typedef char " << checked << "_has_" << bytes << "_bytes_on_the_host[sizeof(" << type << ") == " << bytes
               << " ? 1 : -1];\n";
    };
    const auto add = [&](const std::string& type, const std::string& name) {
        const std::string separator = names.empty() ? "" : ", ";
        out.line("    const global " + type + " *" + name + ";");
        names += separator + "ctx_" + name;
        params += separator + ("const global " + type + " *restrict ctx_" + name);
        init += " ctx." + name + " = ctx_" + name + ";";
    };
    for (const SceneBuffer& buffer : kSceneBuffers) {
        if ((buffer.of && !(features.*buffer.of)) || (buffer.kernels == SceneBuffer::picking_lights && !picks_lights)) continue;
        const bool has_layers = picks_lights && (features.optics.lobes & (RT_LOBE_LAYERS | kSurfaceLobes));
        if (buffer.kernels == SceneBuffer::layered && !has_layers) continue;
        add(buffer.type, buffer.name);
        if (buffer.checked_bytes) check(buffer.type, buffer.type, buffer.checked_bytes);
    }
    check("rt_frame", "rt_frame", sizeof(rt_frame));
    for (rt_u32 s = 0; s < accel.slot_count; ++s) {
        const auto& slot = accel.slots[s];
        if (slot.flags & RT_SLOT_HOST_ONLY) continue;
        add(slot.cl_type, slot.name);
        check(slot.cl_type, std::string("slot_") + slot.name, slot.elem_bytes);
    }
    out.line("} rt_ctx;\n" + checks.str() + "#define RT_CTX_PARAMS " + params);
    out.line("#define RT_CTX_INIT(ctx) rt_ctx ctx;" + init);
    return names;
}

// Writes the primitive tests, the traversals, and the query that calls both, for nearest hits or for any hit.
void write_query(SourceWriter& out, const TraversalTemplate& traversal, const SceneFeatures& features, bool any_hit) {
    out.define_int("RT_ANY_HIT", any_hit);
    out.line(std::string("#define RT_FN(name) RT_CAT(name, ") + (any_hit ? "_any" : "_closest") + ")");
    out.include("primitives/record.h");
    out.include("primitives/triangle.h");
    if (traversal.cpu) out.include("primitives/triangle_single_ray.h");
    if (features.spheres) out.include("primitives/sphere.h");
    if (features.polygons) out.include("primitives/polygon.h");
    if (features.planes) out.include("primitives/plane.h");
    if (features.shapes) out.include("primitives/leaf_shape.h");
    if (features.instances) {
        out.include("primitives/leaf_mesh.h");
        write_traversal(out, traversal, {"rt_mesh", "rt_leaf_mesh", false, false});
    }
    out.include("primitives/leaf_scene.h");
    const bool mixed = features.spheres || features.polygons || features.shapes || features.instances;
    write_traversal(out, traversal, {"rt_scene", "rt_leaf_scene", mixed, features.instances});
    out.include("primitives/query.h");
    out.undef("RT_ANY_HIT");
    out.undef("RT_FN");
}

// Writes the kernels of the models of surfaces that plugins bring, and the functions that choose among
// them.

// A kind to choose, and the code for it, in which $ stands for the id of its plugin.
struct Chosen {
    size_t number;
    const char* id;
    std::string code;
};

// A function that chooses by a number. It is not inlined: what it calls is long, and it is called in several places. begin: its
// first lines. at_end: what follows the switch.
void write_choice(SourceWriter& out, const std::vector<Chosen>& kinds, const std::string& signature, const std::string& begin,
                  const std::string& number, const std::string& at_end) {
    out.line("RT_NOINLINE " + signature + "\n{\n" + begin + "    switch (" + number + ") {");
    for (const Chosen& kind : kinds) {
        std::string code = kind.code;
        for (size_t at; (at = code.find('$')) != std::string::npos;) code.replace(at, 1, kind.id);
        out.line("    case " + std::to_string(kind.number) + "u:\n        " + code);
    }
    out.line("    }\n" + at_end + "}");
}

// Writes rt_surface_eval_by() and rt_surface_sample_by() for the models in `lobes`, of Optics.
void write_surfaces(SourceWriter& out, rt_u32 lobes) {
    std::vector<SurfaceModel> models;
    for (SurfaceModel& model : surface_models())
        if (lobes & lobe_of_surface(model.number)) models.push_back(std::move(model));
    out.line("#define RT_SURFACE_PLUGINS");
    out.include("shading/surface_draw.h");
    for (const SurfaceModel& model : models) out.include(*model.plugin, model.surface.kernels);
    out.line("#line 1 \"generated choice of surfaces\"");
    const auto choice = [&](const char* signature, const char* call, const char* none) {
        std::vector<Chosen> kinds;
        for (const SurfaceModel& model : models) kinds.push_back({model.number, model.id.c_str(), call});
        write_choice(out, kinds, signature, "", "model", none);
    };
    choice("float3 rt_surface_eval_by(uint model, const global float *numbers, float3 color, float3 wo, float3 wi, float *pdf)",
           "*pdf = $_pdf(numbers, color, wo, wi);\n        return $_eval(numbers, color, wo, wi);",
           "    return (float3)(0.0f);\n");
    choice("rt_surface_draw rt_surface_sample_by(uint model, const global float *numbers, float3 color, float3 wo, float3 u)",
           "return $_sample(numbers, color, wo, u);",
           "    rt_surface_draw none;\n    none.wi = none.weight = (float3)(0.0f);\n    none.pdf = 0.0f;\n    return none;\n");
}

// Writes the kernels of the shapes that a scene has, and the functions that choose among them.

// The kinds of which the scene has shapes, as indices of Scene::shape_kinds.
std::vector<size_t> kinds_in(const Scene& scene) {
    std::vector<bool> used(scene.shape_kinds.size());
    for (const Shape& shape : scene.shapes) used[shape.kind] = true;
    std::vector<size_t> kinds;
    for (size_t i = 0; i < used.size(); ++i)
        if (used[i]) kinds.push_back(i);
    return kinds;
}

// Writes rt_shape_hit() and rt_shape_surface_at(), with the kernels of the kinds that occur. rt_ctx must be written already.
void write_shapes(SourceWriter& out, const Scene& scene) {
    const std::vector<size_t> kinds = kinds_in(scene);
    out.include("lanes/vec.h");
    out.include("primitives/shape.h");
    out.include("primitives/shape_single_ray.h");
    for (const size_t kind : kinds) {
        const rt_plugin& plugin = *scene.shape_kinds[kind].plugin;
        out.include(plugin, plugin.primitive->kernels);
    }
    out.line("#line 1 \"generated choice of shapes\"");
    // each, all: the code for a kind that takes one ray at a time, or all lanes.
    const auto choice = [&](const char* signature, const char* each, const char* all, const char* at_end) {
        std::vector<Chosen> chosen;
        for (const size_t kind : kinds) {
            const rt_plugin& plugin = *scene.shape_kinds[kind].plugin;
            chosen.push_back({kind, plugin.id, plugin.primitive->flags & RT_SHAPE_SINGLE_RAY ? each : all});
        }
        write_choice(out, chosen, signature,
                     "    const global float *numbers = shape->numbers, *more = ctx->shape_numbers + shape->first_more;\n",
                     "shape->kind", at_end);
    };
    choice(
        "vfloat rt_shape_hit(const rt_ctx *ctx, const global rt_shape *shape, const rt_shape_rays *ray, uint bits, "
        "vfloat *u, vfloat *v)",
        "RT_SHAPE_HIT_EACH($_hit)", "return $_hit(numbers, more, ray, u, v);", "    return RT_INFINITY;\n");
    choice(
        "void rt_shape_surface_at(const rt_ctx *ctx, const global rt_shape *shape, rt_vec at, vfloat u, vfloat v, "
        "uint bits, rt_shape_surface *s)",
        "RT_SHAPE_SURFACE_EACH($_surface)", "$_surface(numbers, more, at, u, v, s);\n        return;", "");
}

void write_layout(SourceWriter& out, const Layout& layout) {
    out.define_int("RT_LANES", layout.lanes);
    out.define_int("RT_MAX_PIXELS", layout.max_pixels);
    out.define_int("RT_CPU", layout.cpu);
    out.define_int("RT_GROUP_SIDE", layout.group_side);
}

// Settings that a kernel reads by their keys stand in rt_frame as bits.
void write_numbers(SourceWriter& out) {
    out.line("#define RT_SETTING(frame, key) RT_SETTING_##key((frame)->numbers)");
    size_t at = 0;
    for (const Setting* row : kernel_numbers()) {
        const char* const type = row->kind == Setting::Kind::integer ? "as_int" : "as_float";
        out.line("#define RT_SETTING_" + row->key + "(numbers) " + type + "((numbers)[" + std::to_string(at++) + "])");
    }
}

void write_features(SourceWriter& out, const SceneFeatures& features, const Settings& settings, const KernelRow& row) {
    out.define_int("RT_HAS_INSTANCES", features.instances);
    if (features.scale != 0) out.line("#define RT_SCENE_SCALE 0x1p" + std::to_string(features.scale) + "f");
    if (features.masks) out.define_int("RT_HAS_MASKS", 1);
    out.define_int("RT_HAS_SPHERES", features.spheres);
    out.define_int("RT_HAS_POLYGONS", features.polygons);
    out.define_int("RT_HAS_PLANES", features.planes);
    out.define_int("RT_HAS_NORMALS", features.normals);
    const bool uvs = features.uvs && (features.textures || row.has(kReadsUvs));
    out.define_int("RT_HAS_UVS", uvs);
    out.define_int("RT_HAS_ATTRIBUTES", features.normals || uvs || features.uvs2 || features.tangents || features.colors);
    if (features.colors) out.define_int("RT_HAS_COLORS", 1);
    out.define_int("RT_HAS_TEXTURES", features.textures);
    if (features.maps) out.define_int("RT_HAS_MAPS", 1);
    const std::string mips = settings.mips != "auto" ? settings.mips : row.has(kPicksLights) ? "smooth" : "off";
    if (features.mips && mips != "off") out.define_int("RT_HAS_MIPS", 1);
    // `path` has cones of its own.
    if (features.mips && mips != "off" && !row.has(kPicksLights)) out.define_int("RT_CARRIES_CONES", 1);
    if (features.mips && mips == "smooth") out.define_int("RT_MIX_MIPS", 1);
    if (features.tangents) out.define_int("RT_HAS_TANGENTS", 1);
    if (features.uvs2) out.define_int("RT_HAS_UVS2", 1);
    if (features.wraps) out.define_int("RT_HAS_WRAPS", 1);
    if (features.shapes) out.define_int("RT_HAS_SHAPES", 1);
    if (features.sky_picture && row.has(kPicksLights)) out.define_int("RT_HAS_SKY_PICTURE", 1);
    if (features.light_tree) out.define_int("RT_LIGHT_TREE", 1);
    const Optics optics = optics_known(row, features.optics);
    if (row.has(kPicksLights | kWhitted)) out.define_uint("RT_LIGHTS", optics.lights);
    if (row.has(kPicksLights)) out.define_uint("RT_LOBES", optics.lobes);
    if (optics.cutouts) out.define_int("RT_HAS_CUTOUTS", 1);
}

// Writes the beginning of every kernel: types, lanes, the structure's types, the buffers, and shapes. Returns the names of the
// buffers as arguments.
std::string write_preamble(SourceWriter& out, const Layout& layout, const rt_plugin& accel, const Scene& scene,
                           const SceneFeatures& features, const KernelRow& row) {
    for (const char* name : {"rt_shared.h", "rt_types.h", "lanes/lanes.h"}) out.include(name);
    if (!layout.cpu) out.include("lanes/subgroup.h");
    if (row.has(kAllHits)) out.include("lanes/hit_list.h");
    for (const char* name : {"lanes/rays.h", "lanes/ray_space.h", "primitives/loaded_prim.h"}) out.include(name);
    if (layout.cpu)
        for (const char* name : {"lanes/single_ray.h", "primitives/triangle_row.h"}) out.include(name);
    out.include("lanes/spread_ray.h");
    if (accel.accel->types.text) out.include(accel, accel.accel->types);
    out.include("lanes/packet_stream.h");
    if (features.shapes) out.include("rt_shape.h");
    const std::string arguments = write_context(out, *accel.accel, features, row.has(kPicksLights));
    if (features.shapes) write_shapes(out, scene);
    return arguments;
}

void write_queries(SourceWriter& out, const KernelRow& row, const Layout& layout, const SceneFeatures& features,
                   const rt_plugin& accel) {
    TraversalTemplate traversal;
    traversal.file = plugin_kernel_name(accel, accel.accel->traverse);
    traversal.text = plugin_kernel_text(accel, accel.accel->traverse);
    traversal.cpu = layout.cpu;
    traversal.requeues = (row.needs & RT_REQUEUES_LONG_RAYS) != 0;
    traversal.by_warps = (row.needs & RT_TRAVERSES_WARPS) != 0;
    traversal.spreads = (accel.accel->capabilities & RT_TRAVERSES_SINGLE_RAYS) != 0 && layout.lanes > 1;
    out.define_int("RT_QUERIES", row.has(kNearestOnly) ? 1 : 2);
    write_query(out, traversal, features, false);
    if (!row.has(kNearestOnly)) write_query(out, traversal, features, true);
}

}  // namespace

KernelSource kernel_for(const KernelRow& row, const Settings& settings, const Layout& layout, const Scene& scene,
                        const AccelData& data) {
    const rt_plugin& accel = *data.layout;
    SceneFeatures features = features_of(scene, data.scene, settings.optics);
    features.light_tree = row.has(kPicksLights) && has_light_tree(settings);
    KernelSource source;
    source.row = &row;
    source.what = std::string(row.what) + " with accel " + accel.id;
    // Of Whitted's tracers instances, polygons and shapes would spill more registers, which costs more than the limit gains.
    const bool is_plain = !features.instances && !features.polygons && !features.shapes;
    source.limit_registers = !layout.cpu && (row.has(kLimitRegistersAlways) || (row.has(kLimitRegisters) && is_plain));

    SourceWriter out;
    write_layout(out, layout);
    write_numbers(out);
    write_features(out, features, settings, row);
    if (features.textures && has_bright_textures(scene)) out.define_int("RT_HAS_BRIGHT_TEXTURES", 1);
    if (settings.portable) out.line("#define RT_PORTABLE");
    if (settings.debug) out.line("#define RT_DEBUG");
    if (source.limit_registers) out.line("#define RT_FEWER_REGISTERS");
    for (const std::string& define : row.defines) out.line("#define " + define);
    if (row.define) row.define(out, settings);
    out.define_uint("RT_KERNEL_CONTRACT", accel.accel->kernel_contract);
    for (const Capability& capability : capabilities())
        if (accel.accel->capabilities & capability.bit) out.line(std::string("#define ") + capability.define);
    for (const auto& [name, value] : data.defines) out.define_uint(name, value);

    const std::string scene_arguments = write_preamble(out, layout, accel, scene, features, row);
    write_queries(out, row, layout, features, accel);
    for (const char* name : {"lanes/vec.h", "shading/power.h", "shading/surface.h", "shading/point.h", "tracers/camera.h"})
        out.include(name);
    const rt_u32 surfaces = row.has(kPicksLights) ? optics_known(row, features.optics).lobes & kSurfaceLobes : 0;
    if (surfaces != 0) write_surfaces(out, surfaces);
    for (const char* name : row.headers) out.include(name);
    out.include(row.file);

    source.declarations = kernel_text(row.file);
    source.macros = {
        {"RT_CTX_PARAMS", scene_arguments},
        {"RT_OVERFLOWS_PARAM", settings.debug ? "overflows," : ""},
        {"RT_GROUPS_PARAMS", layout.cpu ? "first_group, group_count, group_share, taken_before, taken," : "first_group,"}};
    source.text = out.text();
    source.options = "-cl-std=CL1.2";
    if (settings.fast_math) source.options += " -cl-fast-relaxed-math";
    return source;
}

}  // namespace clarity
