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

std::string prefix_of(size_t kind) {
    return "    case " + std::to_string(kind) + "u:\n";
}

void write_hit(SourceWriter& out, const Scene& scene, const std::vector<size_t>& kinds) {
    // Not inlined: the tests of shapes are long, and leaf tests are in several places.
    out.line(
        "RT_NOINLINE vfloat rt_shape_hit(const rt_ctx *ctx, const global rt_shape *shape, const rt_shape_rays *ray, uint bits, "
        "vfloat *u, vfloat *v)\n{\n"
        "    const global float *numbers = shape->numbers, *more = ctx->shape_numbers + shape->first_more;\n"
        "    switch (shape->kind) {");
    for (const size_t kind : kinds) {
        const rt_plugin& plugin = *scene.shape_kinds[kind].plugin;
        const std::string id = plugin.id;
        if (plugin.primitive->flags & RT_SHAPE_SINGLE_RAY)
            out.line(prefix_of(kind) + "        RT_SHAPE_HIT_EACH(" + id + "_hit)");
        else
            out.line(prefix_of(kind) + "        return " + id + "_hit(numbers, more, ray, u, v);");
    }
    out.line("    }\n    return RT_INFINITY;\n}");
}

void write_surface(SourceWriter& out, const Scene& scene, const std::vector<size_t>& kinds) {
    out.line(
        "RT_NOINLINE void rt_shape_surface_at(const rt_ctx *ctx, const global rt_shape *shape, rt_vec at, vfloat u, vfloat v, "
        "uint bits, rt_shape_surface *s)\n{\n"
        "    const global float *numbers = shape->numbers, *more = ctx->shape_numbers + shape->first_more;\n"
        "    switch (shape->kind) {");
    for (const size_t kind : kinds) {
        const rt_plugin& plugin = *scene.shape_kinds[kind].plugin;
        const std::string id = plugin.id;
        if (plugin.primitive->flags & RT_SHAPE_SINGLE_RAY)
            out.line(prefix_of(kind) + "        RT_SHAPE_SURFACE_EACH(" + id + "_surface)");
        else
            out.line(prefix_of(kind) + "        " + id + "_surface(numbers, more, at, u, v, s);\n        return;");
    }
    out.line("    }\n}");
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
    write_hit(out, scene, kinds);
    write_surface(out, scene, kinds);
}

}  // namespace clarity
