// cases.cpp -- the generators of scenes, and of the rays into them.
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "stand/made_scenes.hpp"
#include "stand/ray_sets.hpp"
#include "tools/lab/lab.hpp"

namespace clarity::lab {
namespace {

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
    void (*make)(SceneMaker&, uint64_t triangles);
    Move move = nullptr;  // of scenes that move
};
constexpr Generator kGenerators[] = {{"city", made::blocks},           {"soup", made::mixed_soup},
                                     {"needles", made::needles},       {"teapots", made::teapots},
                                     {"crowds", made::crowds},         {"swirl", made::mixed_soup, swirl},
                                     {"sway", made::mixed_soup, sway}, {"burst", made::mixed_soup, burst}};

// The triangles of `make` in each pose: a mesh each, far from the others, so that a ray sees its own pose alone.
constexpr float kApart = 8;
Scene posed(const SceneMaker& rest, Move move, unsigned poses, uint64_t seed) {
    SceneMaker make(seed);
    for (unsigned pose = 0; pose < poses; ++pose) {
        SceneMaker chances(seed);  // the same in each pose
        const float time = float(pose) / float(poses);
        for (size_t i = 0; i + 8 < rest.positions.size(); i += 9) {
            const float chance = chances.random();
            const auto corner = [&](size_t k) {
                const float* const p = rest.positions.data() + i + 3 * k;
                return move({p[0], p[1], p[2]}, time, chance);
            };
            make.add_triangle(corner(0), corner(1), corner(2));
        }
        Affine at = kIdentity;
        at[11] = kApart * float(pose);
        make.place_mesh(at).apart = true;
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
    SceneMaker make(of.seed);
    generator->make(make, of.triangles);
    if ((of.poses > 1) != (generator->move != nullptr))
        throw Error(Exit::usage,
                    "case " + of.name + ": `poses` is for the scenes that move, swirl, sway and burst, and they need it");
    MadeCase made;
    if (generator->move) {
        made.scene = posed(make, generator->move, of.poses, of.seed);
    } else {
        make.place_mesh();
        made.scene = std::move(make.scene);
    }
    // Half of the rays come from a camera and agree in their directions; the others leave points in any direction.
    RayMaker rays(71, of.seed);
    const Region region{"", {0, 0, 0}, 1};
    const Point eye = make.around({0, 1.2f, 0}, 0.5f);
    const Point from = {eye[0] + 2.2f, eye[1], eye[2] + 2.2f};
    for (unsigned i = 0; i < of.rays; ++i) {
        if (i < of.rays / 2)
            made.rays.push_back(RayMaker::from_to(from, rays.within(region, 0.9f)));
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
