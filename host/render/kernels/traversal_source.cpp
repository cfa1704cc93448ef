#include "render/kernels/traversal_source.hpp"

#include "render/kernels/scene_buffers.hpp"
#include "scene/surface_models.hpp"

namespace clarity {
namespace {

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
struct Instance {
    std::string name, leaf;
    bool mixed, instances;
};

void define_function(SourceWriter& out, const std::string& macro, const std::string& function) {
    out.line("#define " + macro + " RT_FN(" + function + ")");
}

// A traversal of one ray: its leaf tests, the traversal, and the function that spreads a packet over it.
void write_spread_traversal(SourceWriter& out, const TraversalTemplate& traversal, const Instance& instance) {
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

void write_traversal(SourceWriter& out, const TraversalTemplate& traversal, const Instance& instance) {
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

}  // namespace

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
        if ((buffer.of && !(features.*buffer.of)) || (buffer.of_emitters && !picks_lights)) continue;
        if (buffer.of_layers && !(picks_lights && (features.optics.lobes & (RT_LOBE_LAYERS | kSurfaceLobes)))) continue;
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

}  // namespace clarity
