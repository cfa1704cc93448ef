// lobes.hpp -- draws and evaluates surfaces of cl/shading/bsdf.h by themselves, on the default device.
#pragma once
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::test {

struct Lobe {
    std::string name;
    float color[3] = {1, 1, 1};
    float diffuse = 0, mirror = 0, metal = 0, glass = 0, alpha = 0, eta = 1;
    bool compensate = true;
    bool layered = false;  // RT_MODEL_GLTF by these, and not by the shares
    rt_layers layers{};
    float coat_tilt = 0;         // slope of the varnish against the surface
    bool passes() const;         // light through the surface, with a density
    double squared_eta() const;  // of both sides; sheets have the same medium on both
};
Lobe lambert(float r, float g, float b);
Lobe metal(float roughness, bool compensate = true);
// White, of ior 1.5 and RT_MODEL_GLTF.
Lobe layered(const std::string& name, float roughness, const std::function<void(rt_layers&)>& change = [](rt_layers&) {});
Lobe glass(float roughness, float eta, bool compensate = true);

Lobe colored(Lobe lobe, float r, float g, float b);
Lobe mixture(float mirror, float glass_share, float eta);
// Surfaces whose densities differ; those of RT_MODEL_GLTF have a layer at a time, and all together.
std::vector<Lobe> layers_with_density();
std::vector<Lobe> all_with_density();

// What is asked of one lane: a direction is drawn for wo by u, and the lobe is evaluated for wi.
struct LobeQuery {
    float wo[3], u[3], wi[3];
};
struct LobeAnswer {
    float wi[3], weight[3], pdf, flags;  // drawn; flags: 1 valid, 2 delta, 4 transmitted
    float f[3], density;                 // for the given wi
    float drawn_f[3], drawn_density;     // for the drawn wi
    bool valid() const { return int(flags) & 1; }
    bool delta() const { return int(flags) & 2; }
    bool transmitted() const { return int(flags) & 4; }
};

// Asks `queries` of a lobe, with as many lanes as named. The programs are compiled once. grain: whether they know surfaces with
// a grain.
std::vector<LobeAnswer> ask(const Lobe& lobe, const std::vector<LobeQuery>& queries, unsigned lanes = 16, bool grain = true);

// A direction with a cosine of mu to the normal and `count` triples of random numbers.
std::vector<LobeQuery> draws(double mu, size_t count, unsigned seed);
// The same with side x side triples, whose last two numbers are one in each stratum.
std::vector<LobeQuery> strata(double mu, unsigned side, unsigned seed);

}  // namespace clarity::test
