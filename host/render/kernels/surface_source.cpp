#include "render/kernels/surface_source.hpp"

#include "scene/surface_models.hpp"

namespace clarity {
namespace {

// The choice of one function. call: what follows `case N:`; $ stands for the plugin's id.
void write_choice(SourceWriter& out, const std::vector<SurfaceModel>& models, const std::string& signature,
                  const std::string& call, const std::string& else_return) {
    out.line("RT_NOINLINE " + signature + "\n{\n    switch (model) {");
    for (const SurfaceModel& model : models) {
        std::string code = call;
        for (size_t at; (at = code.find('$')) != std::string::npos;) code.replace(at, 1, model.id);
        out.line("    case " + std::to_string(model.number) + "u:\n        " + code);
    }
    out.line("    }\n    " + else_return + "\n}");
}

}  // namespace

void write_surfaces(SourceWriter& out, rt_u32 lobes) {
    std::vector<SurfaceModel> models;
    for (SurfaceModel& model : surface_models())
        if (lobes & lobe_of_surface(model.number)) models.push_back(std::move(model));
    out.line("#define RT_SURFACE_PLUGINS");
    out.include("shading/surface_draw.h");
    for (const SurfaceModel& model : models) out.include(*model.plugin, model.surface.kernels);
    out.line("#line 1 \"generated choice of surfaces\"");
    write_choice(
        out, models,
        "float3 rt_surface_eval_by(uint model, const global float *numbers, float3 color, float3 wo, float3 wi, float *pdf)",
        "*pdf = $_pdf(numbers, color, wo, wi);\n        return $_eval(numbers, color, wo, wi);", "return (float3)(0.0f);");
    write_choice(
        out, models,
        "rt_surface_draw rt_surface_sample_by(uint model, const global float *numbers, float3 color, float3 wo, float3 u)",
        "return $_sample(numbers, color, wo, u);",
        "rt_surface_draw none;\n    none.wi = none.weight = (float3)(0.0f);\n    none.pdf = 0.0f;\n    return none;");
}

}  // namespace clarity
