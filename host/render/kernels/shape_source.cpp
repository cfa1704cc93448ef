#include "render/kernels/shape_source.hpp"

#include <vector>

namespace clarity {
namespace {

// The kinds of which the scene has shapes, as indices of Scene::shape_kinds.
std::vector<size_t> kinds_in(const Scene& scene) {
    std::vector<bool> used(scene.shape_kinds.size());
    for (const Shape& shape : scene.shapes) used[shape.kind] = true;
    std::vector<size_t> kinds;
    for (size_t i = 0; i < used.size(); ++i)
        if (used[i]) kinds.push_back(i);
    return kinds;
}

// A function that chooses by the kind of a shape. each, all: the code for a kind that takes one ray at a time, or all lanes; $
// stands for the plugin's id. at_end: what follows the switch.
void write_choice(SourceWriter& out, const Scene& scene, const std::vector<size_t>& kinds, const std::string& signature,
                  const std::string& each, const std::string& all, const std::string& at_end) {
    // Not inlined: the tests of shapes are long, and leaf tests are in several places.
    out.line("RT_NOINLINE " + signature +
             "\n{\n"
             "    const global float *numbers = shape->numbers, *more = ctx->shape_numbers + shape->first_more;\n"
             "    switch (shape->kind) {");
    for (const size_t kind : kinds) {
        const rt_plugin& plugin = *scene.shape_kinds[kind].plugin;
        std::string code = plugin.primitive->flags & RT_SHAPE_SINGLE_RAY ? each : all;
        code.replace(code.find('$'), 1, plugin.id);
        out.line("    case " + std::to_string(kind) + "u:\n        " + code);
    }
    out.line("    }\n" + at_end + "}");
}

}  // namespace

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
    write_choice(out, scene, kinds,
                 "vfloat rt_shape_hit(const rt_ctx *ctx, const global rt_shape *shape, const rt_shape_rays *ray, uint bits, "
                 "vfloat *u, vfloat *v)",
                 "RT_SHAPE_HIT_EACH($_hit)", "return $_hit(numbers, more, ray, u, v);", "    return RT_INFINITY;\n");
    write_choice(out, scene, kinds,
                 "void rt_shape_surface_at(const rt_ctx *ctx, const global rt_shape *shape, rt_vec at, vfloat u, vfloat v, "
                 "uint bits, rt_shape_surface *s)",
                 "RT_SHAPE_SURFACE_EACH($_surface)", "$_surface(numbers, more, at, u, v, s);\n        return;", "");
}

}  // namespace clarity
