#include "render/kernels/kernel_source.hpp"

#include <algorithm>

#include "plugin/capabilities.hpp"
#include "render/kernels/layout.hpp"
#include "render/kernels/shape_source.hpp"
#include "render/kernels/traversal_source.hpp"
#include "render/settings/aov.hpp"
#include "render/settings/settings.hpp"

namespace clarity {
namespace {

// Defines a number for each AOV: RT_AOV_T, ... One program computes all that need no counters, another one those that do, so
// that changing from one to the next compiles nothing.
void write_aovs(SourceWriter& out, const Aov& wanted) {
    for (const Aov& aov : aov_table()) out.define_int(kernel_macro(aov), number_of(aov));
    out.define_int("RT_AOV_COUNT", static_cast<unsigned>(aov_table().size()));
    out.line("#define RT_AOV");
    if (wanted.counts_steps) out.line("#define RT_COUNT_STEPS");
}

void write_layout(SourceWriter& out, const Layout& layout) {
    out.define_int("RT_LANES", layout.lanes);
    out.define_int("RT_MAX_PIXELS", layout.max_pixels);
    out.define_int("RT_CPU", layout.cpu);
    out.define_int("RT_GROUP_SIDE", layout.group_side);
}

void write_features(SourceWriter& out, const SceneFeatures& features, const KernelRow& row) {
    out.define_int("RT_HAS_INSTANCES", features.instances);
    out.define_int("RT_HAS_SPHERES", features.spheres);
    out.define_int("RT_HAS_POLYGONS", features.polygons);
    out.define_int("RT_HAS_PLANES", features.planes);
    out.define_int("RT_HAS_NORMALS", features.normals);
    const bool uvs = features.uvs && (features.textures || row.has(kReadsUvs));
    out.define_int("RT_HAS_UVS", uvs);
    out.define_int("RT_HAS_ATTRIBUTES", features.normals || uvs);
    out.define_int("RT_HAS_TEXTURES", features.textures);
    if (features.wraps) out.define_int("RT_HAS_WRAPS", 1);
    if (features.shapes) out.define_int("RT_HAS_SHAPES", 1);
}

// Writes the beginning of every kernel: types, lanes, the structure's types, the buffers, and shapes.
void write_preamble(SourceWriter& out, const Layout& layout, const rt_plugin& accel, const Scene& scene,
                    const SceneFeatures& features) {
    for (const char* name : {"rt_shared.h", "rt_types.h", "lanes/lanes.h"}) out.include(name);
    if (!layout.cpu) out.include("lanes/subgroup.h");
    for (const char* name : {"lanes/rays.h", "lanes/ray_space.h", "primitives/loaded_prim.h"}) out.include(name);
    if (layout.cpu)
        for (const char* name : {"lanes/single_ray.h", "primitives/triangle_row.h"}) out.include(name);
    if (accel.accel->types.text) out.include(accel, accel.accel->types);
    out.include("lanes/packet_stream.h");
    if (features.shapes) out.include("rt_shape.h");
    write_context(out, *accel.accel, features);
    if (features.shapes) write_shapes(out, scene);
}

void write_queries(SourceWriter& out, const KernelRow& row, const KernelChoice& choice, const SceneFeatures& features,
                   const rt_plugin& accel) {
    TraversalTemplate traversal;
    traversal.file = plugin_kernel_name(accel, accel.accel->traverse);
    traversal.text = plugin_kernel_text(accel, accel.accel->traverse);
    traversal.cpu = choice.layout.cpu;
    traversal.requeues = (row.needs & RT_REQUEUES_LONG_RAYS) != 0;
    traversal.by_warps = (row.needs & RT_TRAVERSES_WARPS) != 0;
    const FramePart part = choice.part;
    traversal.double_leaf = part == FramePart::closest_double_leaf || part == FramePart::whole_closest_double_leaf;
    write_query(out, traversal, features, false);
    traversal.double_leaf = part == FramePart::whole_any_double_leaf;
    if (!row.has(kNearestOnly)) write_query(out, traversal, features, true);
}

}  // namespace

KernelSource kernel_for(const KernelChoice& choice, const Scene& scene, const AccelData& data) {
    const Settings& settings = choice.settings;
    const Layout& layout = choice.layout;
    const FramePart part = choice.part;
    const rt_plugin& accel = *data.layout;
    const KernelRow& row = kernel_row(choice);
    const SceneFeatures features = features_of(scene, data.scene);
    KernelSource source;
    source.row = &row;
    source.what = std::string(row.what) + " with accel " + accel.id;
    // Exception: with instances, polygons or shapes more registers would be spilled, which costs more than the limit gains.
    source.limit_registers =
        row.has(kLimitRegisters) && !layout.cpu && !features.instances && !features.polygons && !features.shapes;

    SourceWriter out;
    write_layout(out, layout);
    write_features(out, features, row);
    if (settings.portable) out.line("#define RT_PORTABLE");
    if (settings.debug) out.line("#define RT_DEBUG");
    if (source.limit_registers) out.line("#define RT_FEWER_REGISTERS");
    for (const std::string& define : row.defines) out.line("#define " + define);
    if (choice.kind == KernelKind::aov) write_aovs(out, find_aov(settings.aov));
    if (part < FramePart::whole) out.define_int("RT_PART", std::min(static_cast<unsigned>(part), 2u));
    if (row.has(kRaySlots)) out.define_int("RT_RAY_SLOTS", static_cast<unsigned>(settings.ray_slots));
    out.define_uint("RT_KERNEL_CONTRACT", accel.accel->kernel_contract);
    for (const Capability& capability : capabilities())
        if (accel.accel->capabilities & capability.bit) out.line(std::string("#define ") + capability.define);
    for (const auto& [name, value] : data.defines) out.define_uint(name, value);

    write_preamble(out, layout, accel, scene, features);
    write_queries(out, row, choice, features, accel);
    for (const char* name : {"lanes/vec.h", "shading/surface.h", "tracers/camera.h"}) out.include(name);
    for (const char* name : row.headers) out.include(name);
    out.include(row.file);

    source.text = out.text();
    source.options = "-cl-std=CL1.2";
    if (settings.fast_math) source.options += " -cl-fast-relaxed-math";
    return source;
}

}  // namespace clarity
