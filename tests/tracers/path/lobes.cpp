#include "tracers/path/lobes.hpp"

#include <cmath>
#include <cstring>
#include <map>
#include <memory>

#include "base/angle.hpp"
#include "kernels/kernel_row.hpp"
#include "tracers/path/lane_kernel.hpp"

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
    if (!found) {
        std::vector<std::string> parts = {
            "rt_shared.h",
            grain ? "\n" : "#define RT_LIGHTS RT_LIGHTS_ALL\n#define RT_LOBES (RT_LOBES_ALL & ~RT_LOBE_GRAIN)\n",
            "rt_types.h",
            "lanes/lanes.h",
            "lanes/vec.h",
            "sampling/math.h",
            "sampling/warps.h",
            "shading/power.h"};
        parts.insert(parts.end(), surface_headers().begin(), surface_headers().end() - 1);  // all but bsdf_of.h
        found = std::make_unique<LaneKernel>(parts, kReads, kWrites, kBody, lanes);
    }
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

Lobe colored(Lobe lobe, float r, float g, float b) {
    lobe.color[0] = r;
    lobe.color[1] = g;
    lobe.color[2] = b;
    return lobe;
}

Lobe mixture(float mirror, float glass_share, float eta) {
    Lobe lobe{"mixture"};
    lobe.diffuse = 1 - mirror - glass_share;
    lobe.mirror = mirror;
    lobe.glass = glass_share;
    lobe.eta = eta;
    return colored(lobe, 0.9f, 0.5f, 0.2f);
}

namespace {

std::vector<Lobe> lobes_with_density() {
    return {lambert(0.8f, 0.5f, 0.2f),
            metal(0.3f),
            metal(0.5f),
            metal(0.5f, false),
            metal(0.8f),
            colored(metal(1), 0.9f, 0.6f, 0.3f),
            glass(0.4f, 1.5f),
            glass(0.4f, 1 / 1.5f),
            glass(0.7f, 2.4f, false),
            glass(0.8f, 1 / 1.2f),
            colored(glass(1, 1.33f), 0.9f, 0.6f, 0.3f),
            mixture(0.3f, 0.2f, 1.5f),
            mixture(0, 0.5f, 1 / 1.5f)};
}

Lobe tilted(Lobe lobe) {
    lobe.name += ", tilted";
    lobe.coat_tilt = 0.4f;
    return lobe;
}

}  // namespace

std::vector<Lobe> layers_with_density() {
    const auto sheet = [](rt_layers& l) { l.transmission = 0.8f; };
    const auto solid = [](rt_layers& l) { l.transmission = 0.8f, l.metallic = 0.2f, l.flags = RT_LAYERS_SOLID; };
    const auto coat = [](rt_layers& l) { l.clearcoat = 0.8f, l.clearcoat_roughness = 0.4f; };
    const auto fibres = [](rt_layers& l) { l.sheen_color[0] = 0.7f, l.sheen_roughness = 0.5f; };
    const auto grain = [](float strength, float degrees) {
        return [=](rt_layers& l) { l.anisotropy = strength, l.anisotropy_rotation = degrees; };
    };
    const auto all = [=](rt_layers& l) { sheet(l), coat(l), fibres(l), l.metallic = 0.4f, l.specular_weight = 0.7f; };
    return {layered("core", 0.5f),
            layered("metal", 0.4f, [](rt_layers& l) { l.metallic = 1; }),
            colored(layered("half metal", 0.7f, [](rt_layers& l) { l.metallic = 0.5f; }), 0.9f, 0.5f, 0.1f),
            layered("smooth core", 0),
            layered("sheet", 0.5f, sheet),
            layered("smooth sheet", 0, sheet),
            layered("solid", 0.5f, solid),
            layered("smooth solid", 0, solid),
            layered("weak solid", 0.4f, [=](rt_layers& l) { solid(l), l.specular_weight = 0.4f, l.specular_color[0] = 3; }),
            layered("filmed solid", 0.3f, [=](rt_layers& l) { solid(l), l.iridescence = 0.7f; }),
            layered("varnished solid", 0, [=](rt_layers& l) { solid(l), coat(l), fibres(l); }),
            layered("varnish", 0.6f, coat),
            tilted(layered("varnish", 0.6f, coat)),
            layered("varnish on smooth metal", 0, [=](rt_layers& l) { coat(l), l.metallic = 1; }),
            layered("smooth varnish", 0.4f, [](rt_layers& l) { l.clearcoat = 1; }),
            layered("fibres", 0.6f, fibres),
            layered("fine fibres", 0.6f, [](rt_layers& l) { l.sheen_color[0] = 1, l.sheen_roughness = 0.2f; }),
            layered("film", 0.4f, [](rt_layers& l) { l.iridescence = 0.8f; }),
            colored(layered("film on metal", 0.5f, [](rt_layers& l) { l.iridescence = 1, l.metallic = 1; }), 0.9f, 0.5f, 0.1f),
            layered("grain", 0.3f, grain(0.6f, 0)),
            layered("grain, turned", 0.4f, grain(0.9f, 30)),
            layered("grain on metal", 0.1f, [=](rt_layers& l) { grain(0.5f, 70)(l), l.metallic = 1; }),
            layered("smooth but for its grain", 0, [=](rt_layers& l) { grain(0.7f, 110)(l), l.metallic = 1; }),
            layered("grain, solid", 0.4f, [=](rt_layers& l) { grain(0.7f, 30)(l), solid(l); }),
            layered("grain, sheet", 0.4f, [=](rt_layers& l) { grain(0.7f, 30)(l), sheet(l); }),
            layered("all", 0.5f, [=](rt_layers& l) { all(l), grain(0.5f, 40)(l); })};
}
std::vector<Lobe> all_with_density() {
    std::vector<Lobe> all = lobes_with_density();
    for (const Lobe& lobe : layers_with_density()) all.push_back(lobe);
    return all;
}

double Lobe::squared_eta() const {
    return layered && glass == 0 ? 1 : double(eta) * eta;
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
