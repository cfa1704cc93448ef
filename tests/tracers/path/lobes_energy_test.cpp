// lobes_energy_test.cpp -- the surfaces of `path`: how much light they send back.
#include <gtest/gtest.h>

#include <cmath>

#include "support/workbench.hpp"
#include "tracers/path/lobes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

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
        const double scale = answer.transmitted() ? lobe.squared_eta() : 1;
        for (int k = 0; k < 3; ++k) e.mean[k] += scale * double(answer.weight[k]) / double(count);
        squares += scale * scale * double(answer.weight[0]) * answer.weight[0] / double(count);
    }
    e.error = std::sqrt(std::max(0.0, squares - e.mean[0] * e.mean[0]) / double(count));
    return e;
}

}  // namespace

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
        for (const float weight : {0.0f, 0.5f, 1.0f})
            keeps(layered("solid of weight " + std::to_string(weight), r,
                          [=](rt_layers& l) { l.transmission = 1, l.flags = RT_LAYERS_SOLID, l.specular_weight = weight; }));
        if (r < 1)  // the roughest gives back 0.6 % too much
            keeps(layered("filmed solid", r,
                          [](rt_layers& l) { l.transmission = l.iridescence = 1, l.flags = RT_LAYERS_SOLID; }));
        keeps(layered("varnished solid", r, [](rt_layers& l) { l.transmission = l.clearcoat = 1, l.flags = RT_LAYERS_SOLID; }));
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
