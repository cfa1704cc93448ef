#include "render/tracers/path/lobes.hpp"

#include <cmath>
#include <cstring>
#include <map>
#include <memory>

#include "base/angle.hpp"
#include "render/tracers/path/lane_kernel.hpp"

namespace clarity::test {
namespace {

constexpr unsigned kLayers = 17, kReads = 19 + kLayers, kWrites = 16;
static_assert(sizeof(LobeQuery) == 4 * 9 && sizeof(LobeAnswer) == 4 * kWrites);

const char* const kBody = R"(
    rt_bsdf b;
    b.color = rt_vec_of(in[0], in[1], in[2]);
    b.diffuse = in[3]; b.mirror = in[4]; b.metal = in[5]; b.glass = in[6]; b.eta = in[8];
    b.compensate = RT_MASK(in[9] > 0.5f);
    rt_matter m = rt_no_matter();
    const vfloat *n = in + 19;
    m.color = b.color;
    m.roughness = sqrt(in[7]); m.ior = b.eta;
    m.metallic = n[1]; m.specular_weight = n[2]; m.specular_color = rt_vec_of(n[3], n[3], n[3]);
    m.transmission = n[4]; m.solid = RT_MASK(n[5] > 0.5f);
    m.clearcoat = n[6]; m.clearcoat_roughness = n[7];
    m.coat_normal = rt_normalize(rt_vec_of(n[10], rt_vfloat(0.0f), rt_vfloat(1.0f)));
    m.iridescence = n[11]; m.iridescence_ior = n[12]; m.iridescence_thickness = n[13];
    m.sheen_color = rt_vec_of(n[8], n[8], n[8]); m.sheen_roughness = n[9];
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    m.anisotropy = n[14]; m.grain_x = n[15]; m.grain_y = n[16];
#endif
    b.layered = rt_layered_of(&m, RT_MASK(n[0] > 0.5f), rt_vfloat(1.0f));
    b.facets = rt_choose_facets(b.layered.lanes, b.layered.facets, rt_even_facets(in[7]));
    b.eta = rt_select(b.layered.sheet, rt_vfloat(1.0f), b.eta);
    const rt_vec wo = rt_vec_of(in[10], in[11], in[12]), wi = rt_vec_of(in[16], in[17], in[18]);
    const vmask all = RT_MASK(in[9] > -1.0f);
    const rt_bsdf_sample s = rt_bsdf_draw(&b, wo, in[13], in[14], in[15], all);
    out[0] = s.wi.x; out[1] = s.wi.y; out[2] = s.wi.z;
    out[3] = s.weight.x; out[4] = s.weight.y; out[5] = s.weight.z; out[6] = s.pdf;
    out[7] = rt_select(s.valid, rt_vfloat(1.0f), rt_vfloat(0.0f)) + rt_select(s.delta, rt_vfloat(2.0f), rt_vfloat(0.0f)) +
             rt_select(s.transmitted, rt_vfloat(4.0f), rt_vfloat(0.0f));
    rt_vec f = rt_bsdf_eval(&b, wo, wi, all, out + 11);
    out[8] = f.x; out[9] = f.y; out[10] = f.z;
    f = rt_bsdf_eval(&b, wo, s.wi, s.valid, out + 15);
    out[12] = f.x; out[13] = f.y; out[14] = f.z;
)";

LaneKernel& kernel(unsigned lanes, bool grain) {
    static std::map<std::pair<unsigned, bool>, std::unique_ptr<LaneKernel>> compiled;
    std::unique_ptr<LaneKernel>& found = compiled[{lanes, grain}];
    if (!found)
        found = std::make_unique<LaneKernel>(
            std::vector<std::string>{
                "rt_shared.h",
                grain ? "\n" : "#define RT_LIGHTS RT_LIGHTS_ALL\n#define RT_LOBES (RT_LOBES_ALL & ~RT_LOBE_GRAIN)\n",
                "rt_types.h",
                "lanes/lanes.h",
                "lanes/vec.h",
                "sampling/math.h",
                "sampling/warps.h",
                "shading/power.h",
                "shading/albedo_grazing.h",
                "shading/albedo_sheen.h",
                "shading/lost_metal.h",
                "shading/lost_glass_outside.h",
                "shading/lost_glass_inside.h",
                "shading/microfacets.h",
                "shading/sheen.h",
                "shading/matter.h",
                "shading/film.h",
                "shading/layers.h",
                "shading/layer_lobes.h",
                "shading/bsdf.h"},
            kReads, kWrites, kBody, lanes);
    return *found;
}

}  // namespace

Lobe lambert(float r, float g, float b) {
    Lobe lobe{"Lambert"};
    lobe.diffuse = 1;
    lobe.color[0] = r;
    lobe.color[1] = g;
    lobe.color[2] = b;
    return lobe;
}

Lobe metal(float roughness, bool compensate) {
    Lobe lobe{"metal of roughness " + std::to_string(roughness)};
    lobe.metal = 1;
    lobe.alpha = roughness * roughness;
    lobe.compensate = compensate;
    return lobe;
}

Lobe glass(float roughness, float eta, bool compensate) {
    Lobe lobe{"glass of roughness " + std::to_string(roughness) + ", eta " + std::to_string(eta)};
    lobe.glass = 1;
    lobe.alpha = roughness * roughness;
    lobe.eta = eta;
    lobe.compensate = compensate;
    return lobe;
}

Lobe layered(const std::string& name, float roughness, const std::function<void(rt_layers&)>& change) {
    Lobe lobe{name + " of roughness " + std::to_string(roughness)};
    lobe.layered = true;
    lobe.alpha = roughness * roughness;
    lobe.eta = 1.5f;
    lobe.layers = default_material().layers;
    change(lobe.layers);
    const bool solid = (lobe.layers.flags & RT_LAYERS_SOLID) != 0;
    if (solid) lobe.glass = (1 - lobe.layers.metallic) * lobe.layers.transmission;
    return lobe;
}

bool Lobe::passes() const {
    const bool sheet = layered && layers.transmission > 0 && layers.metallic < 1;
    return alpha > 0 && (glass > 0 || sheet);
}

std::vector<LobeAnswer> ask(const Lobe& lobe, const std::vector<LobeQuery>& queries, unsigned lanes, bool grain) {
    std::vector<float> rows;
    rows.reserve(queries.size() * kReads);
    for (const LobeQuery& query : queries) {
        rows.insert(rows.end(), {lobe.color[0], lobe.color[1], lobe.color[2], lobe.diffuse, lobe.mirror, lobe.metal, lobe.glass,
                                 lobe.alpha, lobe.eta, float(lobe.compensate)});
        const float* const numbers = query.wo;
        rows.insert(rows.end(), numbers, numbers + 9);
        const rt_layers& l = lobe.layers;
        const double turn = l.anisotropy_rotation * kPi / 180;
        rows.insert(rows.end(), {float(lobe.layered), l.metallic, l.specular_weight, l.specular_color[0], l.transmission,
                                 float(l.flags & RT_LAYERS_SOLID), l.clearcoat, l.clearcoat_roughness, l.sheen_color[0],
                                 l.sheen_roughness, lobe.coat_tilt, l.iridescence, l.iridescence_ior, l.iridescence_thickness,
                                 l.anisotropy, float(std::cos(turn)), float(std::sin(turn))});
    }
    const std::vector<float> found = kernel(lanes, grain).run(std::move(rows));
    std::vector<LobeAnswer> answers(queries.size());
    std::memcpy(answers.data(), found.data(), found.size() * sizeof(float));
    return answers;
}

std::vector<LobeQuery> strata(double mu, unsigned side, unsigned seed) {
    std::vector<LobeQuery> queries = draws(mu, size_t(side) * side, seed);
    for (size_t i = 0; i < queries.size(); ++i) {
        float* const u = queries[i].u;
        u[1] = std::min((float(i % side) + u[1]) / float(side), 0.99999994f);
        u[2] = std::min((float(i / side) + u[2]) / float(side), 0.99999994f);
    }
    return queries;
}

std::vector<LobeQuery> draws(double mu, size_t count, unsigned seed) {
    std::mt19937 random(seed);
    const auto u = [&] { return float(random() >> 8) * 0x1p-24f; };
    std::vector<LobeQuery> queries(count);
    const float sine = float(std::sqrt(1 - mu * mu));
    for (LobeQuery& query : queries) query = {{sine * 0.6f, sine * -0.8f, float(mu)}, {u(), u(), u()}, {0, 0.6f, 0.8f}};
    return queries;
}

}  // namespace clarity::test
