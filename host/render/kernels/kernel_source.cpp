#include "render/kernels/kernel_source.hpp"

#include <algorithm>
#include <sstream>

#include "base/error.hpp"
#include "device/kernel_files.hpp"
#include "render/settings/aov.hpp"

namespace clarity {
namespace {

// The scene's buffers in the order of the kernels' arguments; the plugin's slots follow.
struct Member {
    const char *type, *name;
};
constexpr Member kMembers[] = {
    {"rt_packed_prim", "leaves"}, {"rt_instance", "instances"}, {"rt_polygon", "polygons"},
    {"float", "polygon_corners"}, {"rt_plane", "planes"},       {"rt_material", "materials"},
    {"rt_triangle", "triangles"}, {"float", "normals"},         {"float", "uvs"},
    {"rt_texture", "textures"},   {"uint", "texels"},           {"rt_light", "lights"},
};

// Turns of a traversal after which a ray is long. On an H200 32 to 64 serve nearly as well (docs/performance.md).
constexpr unsigned kStepBudget = 48;

void define(std::ostream& out, const std::string& name, unsigned value) {
    out << "#define " << name << ' ' << value << "u\n";
}
void define_int(std::ostream& out, const std::string& name, unsigned value) {
    out << "#define " << name << ' ' << value << "\n";
}

// Each quantity's number, for aov.cl to compare, and RT_AOV, the one that the program is for.
void define_aovs(std::ostream& out, const Aov& wanted) {
    for (const Aov& aov : aov_table()) define_int(out, kernel_macro(aov), static_cast<unsigned>(&aov - aov_table().data()));
    out << "#define RT_AOV " << kernel_macro(wanted) << "\n";
    if (wanted.counts_steps) out << "#define RT_COUNT_STEPS\n";
}

// #line keeps the compiler's messages at the author's file.
void part(std::ostream& out, const std::string& name, const std::string& text) {
    out << "#line 1 \"" << name << "\"\n" << text << "\n";
}
void include(std::ostream& out, const std::string& name) {
    part(out, "cl/" + name, kernel_text(name));
}

void context(std::ostream& out, const rt_accel& accel) {
    out << "#line 1 \"generated context\"\ntypedef struct rt_ctx {\n";
    std::string params, init;
    const auto add = [&](const std::string& type, const std::string& name) {
        out << "    const global " << type << " *" << name << ";\n";
        params += (params.empty() ? "" : ", ") + ("const global " + type + " *restrict ctx_" + name);
        init += " ctx." + name + " = ctx_" + name + ";";
    };
    for (const Member& member : kMembers) add(member.type, member.name);
    for (rt_u32 s = 0; s < accel.slot_count; ++s) add(accel.slots[s].cl_type, accel.slots[s].name);
    out << "} rt_ctx;\n";
    // Layouts that differ between host and device stop the compiler with a name that says which.
    const auto check = [&](const std::string& type, const std::string& name, size_t bytes) {
        out << "typedef char " << name << "_has_" << bytes << "_bytes_on_the_host[sizeof(" << type << ") == " << bytes
            << " ? 1 : -1];\n";
    };
    check("rt_packed_prim", "rt_packed_prim", sizeof(rt_packed_prim));
    check("rt_instance", "rt_instance", sizeof(rt_instance));
    check("rt_material", "rt_material", sizeof(rt_material));
    check("rt_frame", "rt_frame", sizeof(rt_frame));
    for (rt_u32 s = 0; s < accel.slot_count; ++s)
        check(accel.slots[s].cl_type, std::string("slot_") + accel.slots[s].name, accel.slots[s].elem_bytes);
    out << "#define RT_CTX_PARAMS " << params << "\n#define RT_CTX_INIT(ctx) rt_ctx ctx;" << init << "\n";
}

// A plugin's traversal, and what its inclusions are to have.
struct Template {
    const std::string &file, &text;
    bool cpu;
    bool double_leaf;  // for measuring what they take
    bool instances;
    bool requeued_rays;
    bool by_warps;
};
// What a traversal calls leaf tests, and what these are called by the name of theirs: rt_leaf_mesh or rt_leaf_scene.
struct LeafStep {
    const char *macro, *suffix;
    bool cpu_only;
};
constexpr LeafStep kLeafSteps[] = {{"RT_LEAF", "", false},
                                   {"RT_LEAF_CANDIDATE", "_candidate", true},
                                   {"RT_LEAF_TEST", "_test", true},
                                   {"RT_SINGLE_RAY_CANDIDATES", "_candidates", true},
                                   {"RT_SINGLE_RAY_TEST", "_single_ray", true}};

// One inclusion, with the leaf tests that it may use. The prototype makes it inline whatever the author wrote.
void traversal(std::ostream& out, const Template& plugin, const std::string& name, const std::string& leaf, bool mixed) {
    const auto each_step = [&](const auto& write) {
        for (const LeafStep& step : kLeafSteps)
            if (plugin.cpu || !step.cpu_only) write(std::string(step.macro), leaf + step.suffix);
    };
    out << "#define RT_TRAVERSE RT_FN(" << name << ")\n#define RT_LOADED_PRIM RT_FN(rt_loaded_prim)\n"
        << "#define RT_TRAVERSE_STREAM RT_FN(" << name << "_stream)\n";
    if (plugin.requeued_rays) out << "#define RT_TRAVERSE_REQUEUED RT_FN(" << name << "_long)\n";
    if (plugin.by_warps) out << "#define RT_TRAVERSE_WARP RT_FN(" << name << "_warp)\n";
    define_int(out, "RT_TRIANGLES_ONLY", !mixed);
    each_step([&](const std::string& macro, const std::string& function) {
        out << "#define " << macro << " RT_FN(" << function << ")\n";
    });
    if (plugin.cpu) {
        define_int(out, "RT_SINGLE_RAY_MIXED", mixed);
        include(out, "primitives/leaf_single_ray.h");
    }
    if (plugin.double_leaf) {
        each_step([&](const std::string& macro, const std::string& function) {
            out << "#define " << macro << "_ONCE RT_FN(" << function << ")\n#undef " << macro << "\n#define " << macro
                << " RT_FN(" << function << "_double)\n";
        });
        define_int(out, "RT_LEAF_INSTANCES", mixed && plugin.instances);
        include(out, "primitives/double_leaf.h");
        each_step([&](const std::string& macro, const std::string&) { out << "#undef " << macro << "_ONCE\n"; });
        out << "#undef RT_LEAF_INSTANCES\n";
    }
    out << "RT_INLINE void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit);\n#if RT_STREAM > 1\n"
           "RT_INLINE void RT_TRAVERSE_STREAM(const rt_ctx *ctx, uint root, const rt_rays *rays, rt_hits *hits, uint count);\n"
           "#endif\n#ifdef RT_TRAVERSE_REQUEUED\n"
           "RT_INLINE void RT_TRAVERSE_REQUEUED(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit, "
           "local rt_requeue_scratch *shared);\n#endif\n#ifdef RT_TRAVERSE_WARP\n"
           "RT_INLINE void RT_TRAVERSE_WARP(const rt_ctx *ctx, uint root, uint octant, const rt_rays *rays, rt_hits *hits);\n"
           "#endif\n";
    part(out, plugin.file, plugin.text);
    each_step([&](const std::string& macro, const std::string&) { out << "#undef " << macro << "\n"; });
    out << "#undef RT_TRAVERSE\n#undef RT_TRAVERSE_STREAM\n#undef RT_TRAVERSE_REQUEUED\n#undef RT_TRAVERSE_WARP\n"
           "#undef RT_LOADED_PRIM\n#undef RT_TRIANGLES_ONLY\n#undef RT_SINGLE_RAY_MIXED\n";
}

void query(std::ostream& out, bool any_hit, const SceneFeatures& features, const Template& plugin) {
    out << "#define RT_ANY_HIT " << any_hit << "\n#define RT_FN(name) RT_CAT(name, " << (any_hit ? "_any" : "_closest")
        << ")\n";
    include(out, "primitives/record.h");
    include(out, "primitives/triangle.h");
    if (plugin.cpu) include(out, "primitives/triangle_single_ray.h");
    if (features.spheres) include(out, "primitives/sphere.h");
    if (features.polygons) include(out, "primitives/polygon.h");
    if (features.planes) include(out, "primitives/plane.h");
    if (features.instances) {
        include(out, "primitives/leaf_mesh.h");
        traversal(out, plugin, "rt_mesh", "rt_leaf_mesh", false);
    }
    include(out, "primitives/leaf_scene.h");
    traversal(out, plugin, "rt_scene", "rt_leaf_scene", features.spheres || features.polygons || features.instances);
    include(out, "primitives/query.h");
    out << "#undef RT_ANY_HIT\n#undef RT_FN\n";
}

bool defines_flag(const rt_plugin& accel, const std::string& flag) {
    const rt_cl_file& types = accel.accel->types;
    return types.text && plugin_kernel_text(accel, types).find("\n#define " + flag + "\n") != std::string::npos;
}

}  // namespace

SceneFeatures features_of(const Scene& scene, const BuildScene& build) {
    SceneFeatures f;
    f.instances = !build.instances.empty();
    f.spheres = !build.spheres.empty();
    f.polygons = !build.polygons.empty();
    f.planes = !build.planes.empty();
    f.normals = !scene.normals.empty() && !build.attribute_triangle.empty();
    f.textures = std::any_of(scene.materials.begin(), scene.materials.end(),
                             [](const Material& m) { return m.values.texture != RT_NONE; });
    f.uvs = !scene.uvs.empty() && !build.attribute_triangle.empty();
    return f;
}

bool requeues_long_rays(const rt_plugin& accel) {
    return defines_flag(accel, "RT_REQUEUES_LONG_RAYS");
}

bool traverses_by_steps(const rt_plugin& accel) {
    return defines_flag(accel, "RT_TRAVERSES_BY_STEPS");
}

bool traverses_by_warps(const rt_plugin& accel) {
    return defines_flag(accel, "RT_TRAVERSES_BY_WARPS");
}

KernelSource assemble_kernel(const Settings& settings, const Layout& layout, KernelKind kind, const SceneFeatures& features,
                             const rt_plugin& accel, const std::map<std::string, rt_u32>& defines, FramePart frame_part) {
    std::ostringstream out;
    define_int(out, "RT_LANES", layout.lanes);
    define_int(out, "RT_MAX_PIXELS", layout.max_pixels);
    define_int(out, "RT_CPU", layout.cpu);
    define_int(out, "RT_GROUP_SIDE", layout.group_side);
    define_int(out, "RT_HAS_INSTANCES", features.instances);
    define_int(out, "RT_HAS_SPHERES", features.spheres);
    define_int(out, "RT_HAS_POLYGONS", features.polygons);
    define_int(out, "RT_HAS_PLANES", features.planes);
    define_int(out, "RT_HAS_NORMALS", features.normals);
    const bool uvs = features.uvs && (features.textures || kind == KernelKind::aov);  // who else would look
    define_int(out, "RT_HAS_UVS", uvs);
    define_int(out, "RT_HAS_ATTRIBUTES", features.normals || uvs);
    define_int(out, "RT_HAS_TEXTURES", features.textures);
    if (settings.portable) out << "#define RT_PORTABLE\n";
    if (settings.debug) out << "#define RT_DEBUG\n";
    KernelSource source;
    // With instances there are four traversals, and what would have to be put aside costs more; with polygons as much.
    source.fewer_registers = kind == KernelKind::color && !layout.cpu && !features.instances && !features.polygons;
    if (source.fewer_registers) out << "#define RT_FEWER_REGISTERS\n";
    std::string kernel_file;
    switch (kind) {
        case KernelKind::generations:
            out << "#define RT_SHOW_GENERATIONS\n";
            kernel_file = "tracers/iterative.cl";
            source.entry = "trace_iterative";
            break;
        case KernelKind::color:
            kernel_file = "tracers/" + settings.tracer + ".cl";
            source.entry = "trace_" + settings.tracer;
            if (frame_part < FramePart::whole) {
                define_int(out, "RT_PART", std::min(static_cast<unsigned>(frame_part), 2u));
                kernel_file = "tracers/frame_parts.cl";
                source.entry = "trace_parts";
            }
            break;
        case KernelKind::aov:
            define_aovs(out, find_aov(settings.aov));
            kernel_file = "tracers/aov.cl";
            source.entry = "trace_aov";
            break;
        case KernelKind::counted_rays:
            out << "#define RT_COUNT_STEPS\n";
            [[fallthrough]];
        case KernelKind::rays:
            kernel_file = "queries/rays.cl";
            source.entry = "trace_rays";
            break;
        case KernelKind::requeued_rays:
            define_int(out, "RT_STEP_BUDGET", kStepBudget);
            define(out, "RT_REQUEUE_ITEMS", kRequeueItems);
            kernel_file = "queries/requeued_rays.cl";
            source.entry = "trace_short";
            break;
        case KernelKind::dynamic_fetch:
            kernel_file = "queries/dynamic_fetch.cl";
            source.entry = "trace_dynamic_fetch";
            break;
        case KernelKind::warp_rays:
        case KernelKind::warp_pairs:
            define(out, "RT_RAYS_PER_ITEM", warp_rays_each(kind));
            kernel_file = "queries/warp_rays.cl";
            source.entry = "trace_warps";
            break;
        case KernelKind::inspect:
            out << "#define RT_INSPECT\n#define RT_COUNT_STEPS\n";
            kernel_file = "tracers/inspect.cl";
            source.entry = "trace_inspect";
            break;
    }
    const bool shades = kind == KernelKind::color || kind == KernelKind::generations || kind == KernelKind::inspect;
    const bool queues = shades && source.entry != kWavefrontEntry;  // a packet's own, in private memory
    if (queues) define_int(out, "RT_RAY_SLOTS", settings.ray_slots);
    for (const auto& [name, value] : defines) define(out, name, value);

    const std::string folder = std::string("plugins/accel/") + accel.id + "/";
    const rt_cl_file &types = accel.accel->types, &traverse = accel.accel->traverse;
    include(out, "rt_types.h");
    include(out, "lanes/lanes.h");
    if (!layout.cpu) include(out, "lanes/subgroup.h");
    include(out, "lanes/rays.h");
    include(out, "lanes/ray_space.h");
    include(out, "primitives/loaded_prim.h");
    if (layout.cpu)
        for (const char* name : {"lanes/single_ray.h", "primitives/triangle_row.h"}) include(out, name);
    if (types.text) part(out, folder + types.name, plugin_kernel_text(accel, types));
    include(out, "lanes/packet_stream.h");
    context(out, *accel.accel);
    const std::string file = folder + traverse.name, text = plugin_kernel_text(accel, traverse);
    Template plugin{
        file, text, layout.cpu, false, features.instances, kind == KernelKind::requeued_rays, warp_rays_each(kind) > 0};
    plugin.double_leaf = frame_part == FramePart::closest_double_leaf || frame_part == FramePart::whole_closest_double_leaf;
    query(out, false, features, plugin);
    plugin.double_leaf = frame_part == FramePart::whole_any_double_leaf;
    if (kind != KernelKind::aov && kind != KernelKind::dynamic_fetch) query(out, true, features, plugin);
    include(out, "lanes/vec.h");
    include(out, "shading/surface.h");
    include(out, "tracers/camera.h");
    if (kind == KernelKind::rays || kind == KernelKind::counted_rays || kind == KernelKind::requeued_rays ||
        kind == KernelKind::dynamic_fetch || warp_rays_each(kind) > 0)
        include(out, "queries/ray_blocks.h");
    if (shades) include(out, "shading/material.h");
    if (queues)
        for (const char* name : {"tracers/ray_queue.h", "tracers/inspect.h"}) include(out, name);
    if (shades) include(out, "shading/shading.h");
    // Where packets are single pixels, which only GPUs have. Rays are written down, and generations counted, in the other.
    const bool one_pixel =
        layout.max_pixels == 1 && layout.lanes == 1 && kind == KernelKind::color && source.entry == "trace_iterative";
    if (shades && (one_pixel || !queues)) include(out, "tracers/ray_step.h");
    if (queues)
        include(out, one_pixel ? "tracers/iterative_single.h" : "tracers/generations.h");
    else if (shades)
        for (const char* name : {"lanes/work_distribution.h", "tracers/wavefront_rays.h"}) include(out, name);
    include(out, kernel_file);

    source.text = out.str();
    source.options = "-cl-std=CL1.2";
    if (settings.fast_math) source.options += " -cl-fast-relaxed-math";
    return source;
}

}  // namespace clarity
