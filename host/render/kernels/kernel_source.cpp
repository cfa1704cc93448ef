#include "render/kernels/kernel_source.hpp"

#include "plugin/capabilities.hpp"
#include "render/kernels/shape_source.hpp"
#include "render/kernels/surface_source.hpp"
#include "render/kernels/traversal_source.hpp"
#include "scene/bright_texture.hpp"
#include "scene/surface_models.hpp"

namespace clarity {
namespace {

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
    source.macros = {{"RT_CTX_PARAMS", scene_arguments},
                     {"RT_OVERFLOWS_PARAM", settings.debug ? "overflows," : ""},
                     {"RT_GROUPS_PARAMS", layout.cpu ? "first_group, group_count, group_share, taken_before, taken," : "first_group,"}};
    source.text = out.text();
    source.options = "-cl-std=CL1.2";
    if (settings.fast_math) source.options += " -cl-fast-relaxed-math";
    return source;
}

}  // namespace clarity
