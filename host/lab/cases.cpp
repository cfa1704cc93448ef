// cases.cpp -- the generators of scenes, and of the rays into them.
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "check/hits/ray_maker.hpp"
#include "check/scene_maker.hpp"
#include "lab/lab.hpp"

namespace clarity::lab {
namespace {

using check::Maker;
using check::Point;

// Houses of all heights on a square, most of them low: boxes that stand side by side.
void city(Maker& make, unsigned triangles) {
    const auto side = static_cast<unsigned>(std::max(1.0, std::sqrt(triangles / 12.0)));
    const float step = 2.0f / float(side);
    for (unsigned i = 0; i < side * side; ++i) {
        const float x = -1 + step * float(i % side), z = -1 + step * float(i / side), h = make.random();
        make.box({x, 0, z}, {x + step * (0.4f + 0.5f * make.random()), 0.02f + 0.8f * h * h * h, z + 0.8f * step});
    }
}
// Triangles of any size and place.
void soup(Maker& make, unsigned triangles) {
    make.soup({0, 0, 0}, 1, 0.1f, triangles);
}
// Long thin ones: their boxes overlap whatever one does.
void needles(Maker& make, unsigned triangles) {
    for (unsigned i = 0; i < triangles; ++i) {
        const Point a = make.around({0, 0, 0}, 1), b = make.around(a, 0.5f), c = make.around(a, 0.004f);
        make.triangle(a, b, c);
    }
}
// A few finely divided balls in a large hall: nearly all primitives in little of the space.
void teapots(Maker& make, unsigned triangles) {
    make.box({-20, -20, -20}, {20, 20, 20});
    constexpr unsigned kBalls = 5;
    const auto rings = static_cast<int>(std::max(3.0, std::sqrt(triangles / (4.0 * kBalls))));
    for (unsigned i = 0; i < kBalls; ++i) make.ball(make.around({0, 0, 0}, 1), 0.2f, 2 * rings, rings);
}

// Triangles of all sizes, a few large ones among many small ones, in crowds and between them: where the halves of a list part
// is no good place for a plane.
void crowds(Maker& make, unsigned triangles) {
    for (unsigned i = 0; i < triangles; ++i) {
        const unsigned crowd = i % 7;
        // A tenth lies anywhere. Crowd k is 0.7^k as wide as the first one.
        const bool alone = make.random() < 0.1f;
        const float angle = 2.4f * float(crowd), wide = alone ? 1 : 0.25f * std::pow(0.7f, float(crowd));
        const Point middle = {0.7f * std::cos(angle), 0.2f * float(crowd) - 0.6f, 0.7f * std::sin(angle)};
        const Point at = make.around(alone ? Point{0, 0, 0} : middle, wide);
        const float size = wide * 0.5f * std::pow(0.02f, make.random());
        make.triangle(at, make.around(at, size), make.around(at, size));
    }
}

struct Generator {
    const char* name;
    void (*make)(Maker&, unsigned triangles);
};
constexpr Generator kGenerators[] = {
    {"city", city}, {"soup", soup}, {"needles", needles}, {"teapots", teapots}, {"crowds", crowds}};

}  // namespace

MadeCase make_case(const Case& of) {
    const auto* const generator = std::find_if(std::begin(kGenerators), std::end(kGenerators),
                                               [&](const Generator& one) { return of.scene == one.name; });
    if (generator == std::end(kGenerators)) {
        std::string names;
        for (const Generator& one : kGenerators) names += (names.empty() ? "" : ", ") + std::string(one.name);
        throw Error(Exit::usage, "case " + of.name + ": no generator '" + of.scene + "'; there are " + names);
    }
    Maker make(of.seed);
    generator->make(make, of.triangles);
    make.place(make.mesh());
    MadeCase made;
    made.scene = std::move(make.scene);
    // Half of the rays come from a camera and agree in their directions; the others leave points in any direction.
    check::RayMaker rays(71, of.seed);
    const check::Region region{"", {0, 0, 0}, 1};
    const Point eye = make.around({0, 1.2f, 0}, 0.5f);
    const Point from = {eye[0] + 2.2f, eye[1], eye[2] + 2.2f};
    for (unsigned i = 0; i < of.rays; ++i) {
        if (i < of.rays / 2)
            made.rays.push_back(check::RayMaker::from_to(from, rays.within(region, 0.9f)));
        else
            made.rays.push_back(rays.into(region, 1.5f));
    }
    return made;
}

}  // namespace clarity::lab
