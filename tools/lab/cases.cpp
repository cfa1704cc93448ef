// cases.cpp -- the generators of scenes, and of the rays into them.
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "tools/check/hits/ray_maker.hpp"
#include "tools/check/scene_maker.hpp"
#include "tools/lab/lab.hpp"

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

// How far a point has come at a time from 0 to 1.
using Move = Point (*)(const Point& at, float time, float chance);
Point turned(const Point& at, float angle) {
    const float c = std::cos(angle), s = std::sin(angle);
    return {c * at[0] + s * at[2], at[1], c * at[2] - s * at[0]};
}
// Turns, faster near the axis: neighbours part, a little in each pose.
Point swirl(const Point& at, float time, float) {
    return turned(at, 5 * time / (0.3f + at[0] * at[0] + at[2] * at[2]));
}
// Bends to and fro: neighbours stay neighbours.
Point sway(const Point& at, float time, float) {
    return {at[0] + 0.3f * std::sin(6 * time) * at[1], at[1], at[2]};
}
// At rest, and in one moment thrown about.
Point burst(const Point& at, float time, float chance) {
    return time < 0.45f ? sway(at, 0.2f * time, 0) : turned({at[0], at[1] * (0.3f + chance), at[2]}, 40 * chance);
}

struct Generator {
    const char* name;
    void (*make)(Maker&, unsigned triangles);
    Move move = nullptr;  // of scenes that move
};
constexpr Generator kGenerators[] = {{"city", city},     {"soup", soup},         {"needles", needles}, {"teapots", teapots},
                                     {"crowds", crowds}, {"swirl", soup, swirl}, {"sway", soup, sway}, {"burst", soup, burst}};

// The triangles of `make` in each pose: a mesh each, far from the others, so that a ray sees its own pose alone.
constexpr float kApart = 8;
Scene posed(const Maker& rest, Move move, unsigned poses, uint64_t seed) {
    Maker make(seed);
    for (unsigned pose = 0; pose < poses; ++pose) {
        Maker chances(seed);  // the same in each pose
        const float time = float(pose) / float(poses);
        for (size_t i = 0; i + 8 < rest.scene.positions.size(); i += 9) {
            const float chance = chances.random();
            const auto corner = [&](size_t k) {
                const float* const p = rest.scene.positions.data() + i + 3 * k;
                return move({p[0], p[1], p[2]}, time, chance);
            };
            make.triangle(corner(0), corner(1), corner(2));
        }
        Affine at = kIdentity;
        at[11] = kApart * float(pose);
        make.place(make.mesh(), at);
        make.scene.instances.back().apart = true;
    }
    return std::move(make.scene);
}

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
    if ((of.poses > 1) != (generator->move != nullptr))
        throw Error(Exit::usage,
                    "case " + of.name + ": `poses` is for the scenes that move, swirl, sway and burst, and they need it");
    MadeCase made;
    if (generator->move) {
        made.scene = posed(make, generator->move, of.poses, of.seed);
    } else {
        make.place(make.mesh());
        made.scene = std::move(make.scene);
    }
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
        if (!generator->move) continue;
        // Rays and poses in turns, so that each pose has rays of both kinds.
        made.rays.back().origin[2] += kApart * float(i % of.poses);
        made.rays.back().t_max = kApart / 2;
    }
    return made;
}

}  // namespace clarity::lab
