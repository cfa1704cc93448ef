#include "render/kernels/traversal_source.hpp"

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

constexpr Member kShapeMembers[] = {{"rt_shape", "shapes"}, {"float", "shape_numbers"}};  // of scenes with shapes

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

// One instance of the template. name: name of the traversal's function, leaf: of the leaf tests' functions, both without the
// query's suffix. mixed: whether leaves may hold other primitives than triangles. instances: whether they may hold instances.
struct Instance {
    std::string name, leaf;
    bool mixed, instances;
};

void define_function(SourceWriter& out, const std::string& macro, const std::string& function) {
    out.line("#define " + macro + " RT_FN(" + function + ")");
}

void write_traversal(SourceWriter& out, const TraversalTemplate& traversal, const Instance& instance) {
    const auto each_step = [&](const auto& write) {
        for (const LeafStep& step : kLeafSteps)
            if (traversal.cpu || !step.cpu_only) write(std::string(step.macro), instance.leaf + step.suffix);
    };
    define_function(out, "RT_TRAVERSE", instance.name);
    define_function(out, "RT_LOADED_PRIM", "rt_loaded_prim");
    define_function(out, "RT_TRAVERSE_STREAM", instance.name + "_stream");
    if (traversal.requeues) define_function(out, "RT_TRAVERSE_REQUEUED", instance.name + "_long");
    if (traversal.by_warps) define_function(out, "RT_TRAVERSE_WARP", instance.name + "_warp");
    out.define_int("RT_TRIANGLES_ONLY", !instance.mixed);
    each_step([&](const std::string& macro, const std::string& function) { define_function(out, macro, function); });
    if (traversal.cpu) {
        out.define_int("RT_SINGLE_RAY_MIXED", instance.mixed);
        out.include("primitives/leaf_single_ray.h");
    }
    if (traversal.double_leaf) {
        each_step([&](const std::string& macro, const std::string& function) {
            define_function(out, macro + "_ONCE", function);
            out.undef(macro);
            define_function(out, macro, function + "_double");
        });
        out.define_int("RT_LEAF_INSTANCES", instance.instances);
        out.include("primitives/double_leaf.h");
        each_step([&](const std::string& macro, const std::string&) { out.undef(macro + "_ONCE"); });
        out.undef("RT_LEAF_INSTANCES");
    }
    out.line(kPrototypes);
    out.part(traversal.file, traversal.text);
    each_step([&](const std::string& macro, const std::string&) { out.undef(macro); });
    for (const char* macro : {"RT_TRAVERSE", "RT_TRAVERSE_STREAM", "RT_TRAVERSE_REQUEUED", "RT_TRAVERSE_WARP", "RT_LOADED_PRIM",
                              "RT_TRIANGLES_ONLY", "RT_SINGLE_RAY_MIXED"})
        out.undef(macro);
}

}  // namespace

void write_context(SourceWriter& out, const rt_accel& accel, const SceneFeatures& features) {
    out.line("#line 1 \"generated context\"\ntypedef struct rt_ctx {");
    std::string params, init;
    const auto add = [&](const std::string& type, const std::string& name) {
        out.line("    const global " + type + " *" + name + ";");
        params += (params.empty() ? "" : ", ") + ("const global " + type + " *restrict ctx_" + name);
        init += " ctx." + name + " = ctx_" + name + ";";
    };
    for (const Member& member : kMembers) add(member.type, member.name);
    if (features.shapes)
        for (const Member& member : kShapeMembers) add(member.type, member.name);
    for (rt_u32 s = 0; s < accel.slot_count; ++s)
        if (!(accel.slots[s].flags & RT_SLOT_HOST_ONLY)) add(accel.slots[s].cl_type, accel.slots[s].name);
    out.line("} rt_ctx;");
    // If the size of a struct differs between host and device, compiling fails, and the message names the struct.
    const auto check = [&](const std::string& type, const std::string& name, size_t bytes) {
        out.line("typedef char " + name + "_has_" + std::to_string(bytes) + "_bytes_on_the_host[sizeof(" + type +
                 ") == " + std::to_string(bytes) + " ? 1 : -1];");
    };
    check("rt_packed_prim", "rt_packed_prim", sizeof(rt_packed_prim));
    check("rt_instance", "rt_instance", sizeof(rt_instance));
    check("rt_material", "rt_material", sizeof(rt_material));
    check("rt_frame", "rt_frame", sizeof(rt_frame));
    if (features.shapes) check("rt_shape", "rt_shape", sizeof(rt_shape));
    for (rt_u32 s = 0; s < accel.slot_count; ++s)
        if (!(accel.slots[s].flags & RT_SLOT_HOST_ONLY))
            check(accel.slots[s].cl_type, std::string("slot_") + accel.slots[s].name, accel.slots[s].elem_bytes);
    out.line("#define RT_CTX_PARAMS " + params);
    out.line("#define RT_CTX_INIT(ctx) rt_ctx ctx;" + init);
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
