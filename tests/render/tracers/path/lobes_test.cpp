// lobes_test.cpp -- the surfaces of `path`: densities, reciprocity, weights and energy.
#include "render/tracers/path/lobes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "base/angle.hpp"
#include "reference/path_surface.hpp"
#include "render/tracers/path/lane_kernel.hpp"
#include "support/workbench.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

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

// RT_MODEL_GLTF, a layer at a time and all together.
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

// A random number of a standard normal distribution that is as unlikely as a chi-square of `degrees` degrees (Wilson, Hilferty
// 1931).
double normal_of(double chi_square, double degrees) {
    const double k = 2 / (9 * degrees);
    return (std::cbrt(chi_square / degrees) - (1 - k)) / std::sqrt(k);
}

// How far the counts of drawn directions are from what their density says, over cells of equal solid angle.
double density_misfit(const Lobe& lobe, double mu, unsigned seed) {
    constexpr int kUp = 40, kAround = 32, kSub = 8;
    constexpr size_t kDraws = 100000;
    const auto drawn = ask(lobe, draws(mu, kDraws, seed));
    std::vector<double> count(kUp * kAround), expected(kUp * kAround);
    double deltas = 0, lost = 0;
    for (const LobeAnswer& answer : drawn) {
        if (!answer.valid()) {
            ++lost;
        } else if (answer.delta()) {
            ++deltas;
        } else {
            const int up = std::min(kUp - 1, int((answer.wi[2] + 1) / 2 * kUp));
            const double turn = std::atan2(answer.wi[1], answer.wi[0]) / (2 * kPi) + 0.5;
            ++count[size_t(up) * kAround + size_t(std::min(kAround - 1, int(turn * kAround)))];
        }
    }
    auto grid = draws(mu, size_t(kUp) * kAround * kSub * kSub, 1);
    size_t at = 0;
    for (int c = 0; c < kUp * kAround; ++c)
        for (int k = 0; k < kSub * kSub; ++k, ++at) {
            const double z = 2 * (c / kAround + (k / kSub + 0.5) / kSub) / kUp - 1, r = std::sqrt(1 - z * z);
            const double phi = 2 * kPi * ((c % kAround + (k % kSub + 0.5) / kSub) / kAround - 0.5);
            grid[at].wi[0] = float(r * std::cos(phi));
            grid[at].wi[1] = float(r * std::sin(phi));
            grid[at].wi[2] = float(z);
        }
    const auto densities = ask(lobe, grid);
    double total = 0;
    for (size_t i = 0; i < densities.size(); ++i) {
        const double share = double(densities[i].density) * 4 * kPi / double(densities.size());
        expected[i / (kSub * kSub)] += share * kDraws;
        total += share;
    }
    // Draws without a direction and those of deltas are counts of their own: the density's integral leaves them.
    double chi_square = 0, degrees = -1, rest_count = lost + deltas, rest_expected = (1 - total) * kDraws;
    for (size_t c = 0; c < count.size(); ++c) {
        if (expected[c] < 20) {
            rest_count += count[c];
            rest_expected += expected[c];
            continue;
        }
        chi_square += (count[c] - expected[c]) * (count[c] - expected[c]) / expected[c];
        ++degrees;
    }
    if (rest_expected > 20) {
        chi_square += (rest_count - rest_expected) * (rest_count - rest_expected) / rest_expected;
        ++degrees;
    } else if (rest_count > 60) {
        return 1000;
    }
    return normal_of(chi_square, std::max(1.0, degrees));
}

// Of solids. Sheets have the same medium on both sides.
double squared_eta(const Lobe& lobe) {
    return lobe.layered && lobe.glass == 0 ? 1 : double(lobe.eta) * lobe.eta;
}

struct Energy {
    double mean[3] = {};  // of light 1 from everywhere
    double error = 0;     // standard error of the red mean, if the draws were not stratified
};
Energy energy(const Lobe& lobe, double mu, unsigned side, unsigned seed) {
    Energy e;
    const size_t count = size_t(side) * side;
    double squares = 0;
    for (const LobeAnswer& answer : ask(lobe, strata(mu, side, seed))) {
        if (!answer.valid()) continue;
        // In balance the radiance on the other side is eta^2 times that of this side.
        const double scale = answer.transmitted() ? squared_eta(lobe) : 1;
        for (int k = 0; k < 3; ++k) e.mean[k] += scale * double(answer.weight[k]) / double(count);
        squares += scale * scale * double(answer.weight[0]) * answer.weight[0] / double(count);
    }
    e.error = std::sqrt(std::max(0.0, squares - e.mean[0] * e.mean[0]) / double(count));
    return e;
}

}  // namespace

// Fixed seeds. A failure by chance (beyond 4 sigma, one in 30,000) is repeated with another seed.
TEST(PathLobes, DirectionsAreDrawnWithTheirDensity) {
    for (const Lobe& lobe : all_with_density()) {
        if (lobe.alpha == 0 && lobe.layers.anisotropy > 0) continue;  // narrower than the cells
        for (const double mu : quick() ? std::vector<double>{0.6} : std::vector<double>{0.95, 0.6, 0.15}) {
            double misfit = density_misfit(lobe, mu, 11);
            if (misfit > 4) misfit = density_misfit(lobe, mu, 12);
            EXPECT_LT(misfit, 4) << lobe.name << ", cosine " << mu;
        }
    }
}

TEST(PathLobes, WeightsAreValuesOverDensities) {
    for (const Lobe& lobe : all_with_density()) {
        size_t spread = 0;
        for (const LobeAnswer& answer : ask(lobe, draws(0.5, 20000, 21))) {
            if (!answer.valid()) continue;
            for (const float w : answer.weight) EXPECT_TRUE(w >= 0 && w < 50) << lobe.name << " " << w;
            if (answer.delta()) continue;
            ++spread;
            EXPECT_NEAR(answer.pdf, answer.drawn_density, 1e-5 * answer.pdf) << lobe.name;
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(answer.weight[k] * answer.pdf, answer.drawn_f[k], 1e-5 * answer.drawn_f[k]) << lobe.name;
        }
        EXPECT_GT(spread, lobe.layered && lobe.alpha == 0 ? 500u : 3000u) << lobe.name;
    }
}

// f(wo, wi) = f(wi, wo) on one side; through a surface f(wo, wi) / eta_o^2 = f(wi, wo) / eta_i^2.
TEST(PathLobes, ValuesAreReciprocal) {
    for (const Lobe& lobe : all_with_density()) {
        std::vector<LobeQuery> there = draws(0.5, 4000, 31), back = there, through = there, out_again = there;
        for (size_t i = 0; i < there.size(); ++i) {
            const auto direction = [](float u, float v, float* w) {
                const float z = 0.02f + 0.98f * u, r = std::sqrt(1 - z * z), phi = 6.2831853f * v;
                w[0] = r * std::cos(phi), w[1] = r * std::sin(phi), w[2] = z;
            };
            direction(there[i].u[0], there[i].u[1], there[i].wo);
            direction(there[i].u[2], there[(i + 1) % there.size()].u[0], there[i].wi);
            std::memcpy(back[i].wo, there[i].wi, sizeof back[i].wo);
            std::memcpy(back[i].wi, there[i].wo, sizeof back[i].wi);
        }
        for (size_t i = 0; i < there.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const float down = k == 2 ? -1 : 1;  // the frame is on the side of the ray
                through[i].wo[k] = there[i].wo[k];
                through[i].wi[k] = down * there[i].wi[k];
                out_again[i].wo[k] = there[i].wi[k];
                out_again[i].wi[k] = down * there[i].wo[k];
            }
        Lobe other_side = lobe;
        other_side.eta = 1 / lobe.eta;
        const auto compare = [&](const std::vector<LobeAnswer>& forth, const std::vector<LobeAnswer>& reverse, double scale) {
            double sum = 0;
            for (size_t i = 0; i < there.size(); ++i)
                for (int k = 0; k < 3; ++k) {
                    const double a = double(forth[i].f[k]) / there[i].wi[2],
                                 b = scale * double(reverse[i].f[k]) / there[i].wo[2];
                    EXPECT_NEAR(a, b, 1e-3 * (a + b) + 2e-6) << lobe.name;  // near total reflection floats are that coarse
                    sum += a;
                }
            return sum;
        };
        EXPECT_GT(compare(ask(lobe, there), ask(lobe, back), 1), 1) << lobe.name;
        const double passed = compare(ask(lobe, through), ask(other_side, out_again), 1 / squared_eta(lobe));
        EXPECT_EQ(passed > 1, lobe.passes()) << lobe.name;
    }
}

// The reference in double precision shares no line with the kernels, and integrates the losses between facets by itself. Tables
// of losses are off by 0.001, which is a share of light that is spread over the hemisphere.
TEST(PathLobes, ValuesAreThoseOfTheReference) {
    const auto material = [](rt_u32 model, float roughness, float ior, rt_u32 flags = 0) {
        rt_material m{};
        m.model = model;
        m.roughness = roughness;
        m.ior = ior;
        m.flags = flags;
        m.reflect = 0.3f;
        m.refract = 0.2f;
        return m;
    };
    const struct {
        rt_material material;
        Lobe lobe;
    } surfaces[] = {
        {material(RT_MODEL_LAMBERT, 0, 1), lambert(0.9f, 0.5f, 0.2f)},
        {material(RT_MODEL_CONDUCTOR, 0.2f, 1), metal(0.2f)},
        {material(RT_MODEL_CONDUCTOR, 0.5f, 1), metal(0.5f)},
        {material(RT_MODEL_CONDUCTOR, 0.5f, 1, RT_MATERIAL_SINGLE_SCATTER), metal(0.5f, false)},
        {material(RT_MODEL_CONDUCTOR, 1, 1), metal(1)},
        {material(RT_MODEL_DIELECTRIC, 0.3f, 1.5f), glass(0.3f, 1.5f)},
        {material(RT_MODEL_DIELECTRIC, 0.6f, 1 / 1.5f), glass(0.6f, 1 / 1.5f)},
        {material(RT_MODEL_DIELECTRIC, 1, 1.2f), glass(1, 1.2f)},
        {material(RT_MODEL_DIELECTRIC, 1, 1 / 2.4f, RT_MATERIAL_SINGLE_SCATTER), glass(1, 1 / 2.4f, false)},
        {material(RT_MODEL_WHITTED, 0, 1.5f), mixture(0.3f, 0.2f, 1.5f)},
    };
    for (const auto& surface : surfaces) {
        const Lobe lobe = colored(surface.lobe, 0.9f, 0.5f, 0.2f);
        const reference::PathSurface truth(surface.material, {0.9f, 0.5f, 0.2f}, true);
        std::vector<LobeQuery> queries = draws(0.5, 3000, 81);
        for (size_t i = 0; i < queries.size(); ++i) {
            const auto direction = [](double z, double turn, float* w) {
                const double r = std::sqrt(1 - z * z);
                w[0] = float(r * std::cos(2 * kPi * turn)), w[1] = float(r * std::sin(2 * kPi * turn)), w[2] = float(z);
            };
            const float* const u = queries[i].u;
            direction(0.03 + 0.97 * u[0], u[1], queries[i].wo);
            direction(i % 2 ? 0.03 + 0.97 * u[2] : -0.03 - 0.97 * u[2], u[0] * 97 - std::floor(u[0] * 97), queries[i].wi);
        }
        const auto answers = ask(lobe, queries);
        for (size_t i = 0; i < queries.size(); ++i) {
            const Vec f = truth.value(to_vec(queries[i].wo), to_vec(queries[i].wi));
            for (size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(answers[i].f[k], f[k], 3e-3 * std::abs(queries[i].wi[2]) + 0.02 * f[k]) << lobe.name << " " << i;
        }
    }
}

TEST(PathLobes, WhiteSurfacesKeepAllLight) {
    const auto is_one = [](const Lobe& lobe) {
        double mean = 0;
        const int rings = 8;  // of a sphere in a furnace, as a camera far away sees it: mu^2 is uniform
        for (int i = 0; i < rings; ++i) {
            const double mu = std::sqrt((i + 0.5) / rings);
            const Energy e = energy(lobe, mu, 200, 41u + unsigned(i));
            EXPECT_NEAR(e.mean[0], 1, 0.002 + 4 * e.error) << lobe.name << ", cosine " << mu;
            mean += e.mean[0] / rings;
        }
        EXPECT_NEAR(mean, 1, 0.002) << lobe.name;
    };
    is_one(lambert(1, 1, 1));
    const auto some = [](std::vector<float> all, std::vector<float> few) { return quick() ? few : all; };
    for (const float r : some({0, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f, 1}, {0, 0.3f, 0.7f, 1}))
        is_one(metal(r));
    for (const float eta : some({1.1f, 1.5f, 2.4f, 1 / 1.1f, 1 / 1.5f, 1 / 2.4f}, {1.5f, 1 / 1.5f}))
        for (const float r : some({0, 0.1f, 0.3f, 0.5f, 0.7f, 1}, {0, 0.4f, 1})) is_one(glass(r, eta));
    is_one(glass(0, 1));
    is_one(colored(mixture(0.3f, 0.2f, 1.5f), 1, 1, 1));
    is_one(colored(mixture(0.1f, 0.6f, 1 / 1.5f), 1, 1, 1));
}

// As a sphere in a furnace: of all directions together at most 2 % are lost, and none is won.
TEST(PathLobes, WhiteLayersKeepLight) {
    const auto keeps = [](const Lobe& lobe) {
        double mean = 0, error = 0, most = 0;
        const int rings = 8;
        for (int i = 0; i < rings; ++i) {
            const Energy e = energy(lobe, std::sqrt((i + 0.5) / rings), 160, 91u + unsigned(i));
            mean += e.mean[0] / rings;
            error += e.error / rings;
            most = std::max(most, e.mean[0]);
        }
        EXPECT_NEAR(mean, 0.991, 0.011 + 2 * error) << lobe.name;

        EXPECT_LT(most, 1.08) << lobe.name << ", of one direction";
    };
    const auto metallic = [](float share) { return [=](rt_layers& l) { l.metallic = share; }; };
    const std::vector<float> all = {0, 0.3f, 0.7f, 1}, few = {0.3f, 1};
    keeps(layered("fine fibres", 0.5f, [](rt_layers& l) { l.sheen_color[0] = 1, l.sheen_roughness = 0.15f; }));
    for (const float r : quick() ? few : all) {
        for (const float share : {0.0f, 0.5f, 1.0f}) keeps(layered("metal " + std::to_string(share), r, metallic(share)));
        keeps(layered("half weight", r, [](rt_layers& l) { l.specular_weight = 0.5f; }));
        keeps(layered("bright", r, [](rt_layers& l) { l.specular_color[0] = 20; }));
        keeps(layered("sheet", r, [](rt_layers& l) { l.transmission = 1; }));
        keeps(layered("solid", r, [](rt_layers& l) { l.transmission = 1, l.flags = RT_LAYERS_SOLID; }));
        for (const float below : quick() ? std::vector<float>{0.3f} : all) {
            keeps(layered("varnish", below, [=](rt_layers& l) { l.clearcoat = 1, l.clearcoat_roughness = r; }));
            keeps(layered("varnish on metal", below,
                          [=](rt_layers& l) { l.clearcoat = 1, l.clearcoat_roughness = r, l.metallic = 1; }));
            keeps(layered("film on metal", below,
                          [=](rt_layers& l) { l.iridescence = 1, l.iridescence_thickness = 100 + 600 * r, l.metallic = 1; }));
            keeps(layered("fibres", below, [=](rt_layers& l) { l.sheen_color[0] = 1, l.sheen_roughness = r; }));
        }
        keeps(layered("all", r, [=](rt_layers& l) {
            l.clearcoat = 1, l.clearcoat_roughness = 0.2f, l.sheen_color[0] = 1, l.sheen_roughness = 0.5f, l.metallic = 0.3f;
            l.transmission = 0.5f;
        }));
    }
}

// The same, of spheres whose grain lies in all directions.
TEST(PathLobes, WhiteGrainsKeepLight) {
    for (const float roughness : {0.0f, 0.3f, 0.7f})
        for (const float strength : quick() ? std::vector<float>{1} : std::vector<float>{0.3f, 0.7f, 1})
            for (const auto& [metallic, clear] : {std::pair(1.0f, 0.0f), std::pair(0.0f, 0.0f), std::pair(0.0f, 1.0f)}) {
                double mean = 0, error = 0, most = 0;
                const int rings = 8, turns = 6;
                std::string name;
                for (int i = 0; i < rings * turns; ++i) {
                    const Lobe lobe = layered("grain " + std::to_string(strength) +
                                                  (metallic > 0 ? " metal"
                                                   : clear > 0  ? " sheet"
                                                                : ""),
                                              roughness, [&, m = metallic, c = clear](rt_layers& l) {
                                                  l.anisotropy = strength, l.metallic = m, l.transmission = c;
                                                  l.anisotropy_rotation = 180 * (float(i % turns) + 0.5f) / turns;
                                              });
                    const Energy e = energy(lobe, std::sqrt((i / turns + 0.5) / rings), 80, 91u + unsigned(i));
                    mean += e.mean[0] / (rings * turns);
                    error += e.error / (rings * turns);
                    most = std::max(most, e.mean[0]);
                    name = lobe.name;
                }
                EXPECT_NEAR(mean, 0.991, 0.011 + error) << name;
                EXPECT_LT(most, 1.08) << name << ", of one direction";
            }
}

// KHR_materials_anisotropy's formulas, one direction after another.
TEST(PathLobes, AGrainIsThatOfTheExtension) {
    const double across = 0.3 * 0.3, along = across + (1 - across) * 0.6 * 0.6, turn = 25 * kPi / 180;
    Lobe lobe = layered("grain", 0.3f, [](rt_layers& l) { l.anisotropy = 0.6f, l.anisotropy_rotation = 25, l.metallic = 1; });
    const auto project = [&](const Vec& w) {
        return Vec{along * (std::cos(turn) * w[0] + std::sin(turn) * w[1]),
                   across * (std::cos(turn) * w[1] - std::sin(turn) * w[0]), w[2]};
    };
    std::vector<LobeQuery> queries = draws(0.7, 3000, 17);
    for (LobeQuery& query : queries) {
        const double phi = 2 * kPi * query.u[0], z = 0.1 + 0.9 * query.u[1], r = std::sqrt(1 - z * z);
        query.wi[0] = float(r * std::cos(phi)), query.wi[1] = float(r * std::sin(phi)), query.wi[2] = float(z);
    }
    const auto white = ask(lobe, queries), black = ask(colored(lobe, 0, 0, 0), queries);
    for (size_t i = 0; i < queries.size(); ++i) {
        const Vec o = to_vec(queries[i].wo), w = to_vec(queries[i].wi), h = normalized(o + w);
        const double x = std::cos(turn) * h[0] + std::sin(turn) * h[1], y = std::cos(turn) * h[1] - std::sin(turn) * h[0];
        const double stretched = x * x / (along * along) + y * y / (across * across) + h[2] * h[2];
        const double facets = 1 / (kPi * along * across * stretched * stretched);
        const double seen = 0.5 / (w[2] * length(project(o)) + o[2] * length(project(w))) * facets * w[2];
        // The difference of white and black is free of what does not depend on the colour; light of several facets is in both.
        const double schlick = std::pow(1 - dot(o, h), 5);
        const double single = white[i].f[1] - black[i].f[1], rest = single - seen * (1 - schlick);
        EXPECT_GE(rest, -2e-3 * seen - 1e-6) << i;
        EXPECT_LE(rest, 2e-3 * seen + 0.45 * w[2] / kPi) << i;
    }
}

// A grain without strength is none: the same bits as of kernels that know no grain.
TEST(PathLobes, AGrainWithoutStrengthIsNone) {
    for (Lobe lobe : all_with_density()) {
        if (lobe.layers.anisotropy > 0) continue;
        lobe.layers.anisotropy_rotation = 25;
        const auto queries = draws(0.5, 3000, 19);
        const auto with = ask(lobe, queries), without = ask(lobe, queries, 16, false);
        EXPECT_EQ(std::memcmp(with.data(), without.data(), with.size() * sizeof with[0]), 0) << lobe.name;
    }
}

// No colour comes back brighter than it is, and dark metals absorb.
TEST(PathLobes, ColoredMetalsAbsorb) {
    for (const float roughness : {0.3f, 0.7f, 1.0f}) {
        const Energy e = energy(colored(metal(roughness), 0.9f, 0.5f, 0.1f), 0.8, 250, 51);
        EXPECT_LT(e.mean[0], 0.92);
        EXPECT_LT(e.mean[1], 0.53);
        EXPECT_LT(e.mean[2], 0.13);
        EXPECT_GT(e.mean[0], 0.75);
        EXPECT_GT(e.mean[1], 0.25);
        EXPECT_GT(e.mean[2], 0.02);
    }
}

// The albedo of a single scattering, by a quadrature in double precision of D G2 F / (4 cos cos) over half vectors with F = 1
// and height-correlated Smith: rows of roughness, columns of the cosine 0.1, 0.2 .. 1, and the mean over a hemisphere.
TEST(PathLobes, SingleScatteringHasTheAlbedoOfGgx) {
    const struct {
        float roughness;
        double albedo[10], mean;
    } rows[] = {{0.1f, {0.9941, 0.9986, 0.9994, 0.9996, 0.9997, 0.9998, 0.9998, 0.9999, 0.9999, 0.9999}, 0.9995},
                {0.2f, {0.9290, 0.9751, 0.9884, 0.9932, 0.9955, 0.9966, 0.9973, 0.9978, 0.9981, 0.9983}, 0.9941},
                {0.3f, {0.8843, 0.9140, 0.9459, 0.9646, 0.9751, 0.9813, 0.9851, 0.9877, 0.9894, 0.9907}, 0.9765},
                {0.4f, {0.8883, 0.8698, 0.8861, 0.9079, 0.9264, 0.9404, 0.9506, 0.9581, 0.9636, 0.9677}, 0.9404},
                {0.5f, {0.8916, 0.8482, 0.8379, 0.8443, 0.8573, 0.8717, 0.8853, 0.8973, 0.9074, 0.9158}, 0.8823},
                {0.6f, {0.8824, 0.8258, 0.7963, 0.7839, 0.7821, 0.7867, 0.7948, 0.8044, 0.8146, 0.8245}, 0.8029},
                {0.7f, {0.8619, 0.7927, 0.7490, 0.7211, 0.7040, 0.6946, 0.6906, 0.6906, 0.6932, 0.6978}, 0.7074},
                {0.8f, {0.8331, 0.7489, 0.6922, 0.6513, 0.6212, 0.5988, 0.5821, 0.5699, 0.5611, 0.5552}, 0.6042},
                {0.9f, {0.7985, 0.6974, 0.6278, 0.5759, 0.5353, 0.5028, 0.4762, 0.4541, 0.4356, 0.4200}, 0.5024},
                {1.0f, {0.7602, 0.6416, 0.5601, 0.4989, 0.4507, 0.4115, 0.3789, 0.3513, 0.3275, 0.3069}, 0.4091}};
    for (const auto& row : rows) {
        const Lobe lobe = metal(row.roughness, false);
        for (int k = 0; k < 10; ++k) {
            const double cosine = (k + 1) / 10.0;
            EXPECT_NEAR(energy(lobe, cosine, 160, 61).mean[0], row.albedo[k], 0.0005) << row.roughness << " " << cosine;
        }
        double mean = 0;
        const int rings = 32;  // of equal cosine^2
        for (int i = 0; i < rings; ++i)
            mean += energy(lobe, std::sqrt((i + 0.5) / rings), 64, 62u + unsigned(i)).mean[0] / rings;
        EXPECT_NEAR(mean, row.mean, 0.0007) << row.roughness;
    }
}

TEST(PathLobes, LanesAgree) {
    for (const Lobe& lobe : all_with_density()) {
        const std::vector<LobeQuery> queries = draws(0.4, 3000, 71);
        const auto one = ask(lobe, queries, 1);
        for (const int lanes : lane_counts()) {
            const auto found = ask(lobe, queries, unsigned(lanes));
            size_t differ = 0;
            for (size_t i = 0; i < one.size(); ++i) differ += std::memcmp(&found[i], &one[i], sizeof one[i]) != 0;
            EXPECT_EQ(differ, 0u) << lobe.name << ", " << lanes << " lanes";
        }
    }
}
