// lobes_test.cpp -- the surfaces of `path`: densities, reciprocity, weights, and values beside the reference.
#include "tracers/path/lobes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>

#include "base/angle.hpp"
#include "base/statistics.hpp"
#include "reference/path_surface.hpp"
#include "support/workbench.hpp"
#include "tracers/path/lane_kernel.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// How far a value may be off: by a share of light that is spread over the hemisphere, and by a share of itself.
struct Room {
    double spread, share;
};
void expect_reference(const Lobe& lobe, const MaterialValues& material, const Room& room) {
    const reference::PathSurface truth(material, to_vec(lobe.color), true);
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
    double found = 0, wanted = 0;
    for (size_t i = 0; i < queries.size(); ++i) {
        const Vec f = truth.value(to_vec(queries[i].wo), to_vec(queries[i].wi));
        found += std::min(1.0, double(answers[i].f[1])), wanted += std::min(1.0, f[1]);
        for (size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(answers[i].f[k], f[k], room.spread * std::abs(queries[i].wi[2]) + room.share * f[k])
                << lobe.name << " " << i << " " << k;
    }
    EXPECT_NEAR(found, wanted, (room.spread > 0.01 ? 0.03 : 0.01) * wanted) << lobe.name;
}

// Cells of equal solid angle over the sphere of directions.
constexpr int kUp = 40, kAround = 32, kCells = kUp * kAround;

// The mean density of each of `cells`, by the middles of sub x sub parts of equal solid angle, and the greatest of them.
struct CellDensity {
    double mean = 0, greatest = 0;
};
std::vector<CellDensity> densities(const Lobe& lobe, double mu, const std::vector<int>& cells, int sub) {
    auto grid = draws(mu, cells.size() * size_t(sub * sub), 1);
    size_t at = 0;
    for (const int c : cells)
        for (int k = 0; k < sub * sub; ++k, ++at) {
            const double z = 2 * (c / kAround + (k / sub + 0.5) / sub) / kUp - 1, r = std::sqrt(1 - z * z);
            const double phi = 2 * kPi * ((c % kAround + (k % sub + 0.5) / sub) / kAround - 0.5);
            grid[at].wi[0] = float(r * std::cos(phi));
            grid[at].wi[1] = float(r * std::sin(phi));
            grid[at].wi[2] = float(z);
        }
    const auto answers = ask(lobe, grid);
    std::vector<CellDensity> found(cells.size());
    for (size_t i = 0; i < answers.size(); ++i) {
        CellDensity& cell = found[i / size_t(sub * sub)];
        cell.mean += double(answers[i].density) / (sub * sub);
        cell.greatest = std::max(cell.greatest, double(answers[i].density));
    }
    return found;
}

// The mean density of each cell. A lobe that is narrower than a part of a cell is integrated once more, with smaller parts.
std::vector<double> mean_densities(const Lobe& lobe, double mu) {
    std::vector<int> cells(kCells), uneven;
    std::iota(cells.begin(), cells.end(), 0);
    const auto coarse = densities(lobe, mu, cells, 8);
    std::vector<double> mean(kCells);
    for (const int c : cells) {
        mean[size_t(c)] = coarse[size_t(c)].mean;
        if (coarse[size_t(c)].greatest > 2 * coarse[size_t(c)].mean) uneven.push_back(c);
    }
    if (uneven.empty()) return mean;
    const auto fine = densities(lobe, mu, uneven, 64);
    for (size_t i = 0; i < uneven.size(); ++i) mean[size_t(uneven[i])] = fine[i].mean;
    return mean;
}

// How far the counts of drawn directions are from what their density says, over cells of equal solid angle.
double density_misfit(const Lobe& lobe, double mu, unsigned seed) {
    constexpr size_t kDraws = 100000;
    const auto drawn = ask(lobe, draws(mu, kDraws, seed));
    std::vector<double> count(kCells), expected;
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
    double total = 0;
    for (const double density : mean_densities(lobe, mu)) {
        const double share = density * 4 * kPi / kCells;
        expected.push_back(share * kDraws);
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
    return normal_of_chi_square(chi_square, std::max(1.0, degrees));
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
        const double passed = compare(ask(lobe, through), ask(other_side, out_again), 1 / lobe.squared_eta());
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
    // The reference integrates for seconds.
    size_t number = 0;
    const auto is_left_out = [&number] { return few_ways() && number++ % 4 != 0; };
    for (const auto& surface : surfaces)
        if (!is_left_out()) expect_reference(colored(surface.lobe, 0.9f, 0.5f, 0.2f), surface.material, {3e-3, 0.02});
    for (Lobe lobe : layers_with_density()) {
        if (lobe.coat_tilt != 0 || is_left_out()) continue;
        MaterialValues material(default_material());
        material.model = RT_MODEL_GLTF;
        material.roughness = std::sqrt(lobe.alpha);
        material.ior = lobe.eta;
        material.layers = lobe.layers;
        for (float& c : material.layers.sheen_color) c = lobe.layers.sheen_color[0];
        for (float& c : material.layers.specular_color) c = lobe.layers.specular_color[0];
        expect_reference(colored(lobe, 0.9f, 0.5f, 0.2f), material,
                         lobe.layers.anisotropy > 0 ? Room{0.09, 0.03} : Room{3e-3, 0.02});
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
