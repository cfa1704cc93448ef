#include "tools/check/shapes/surface_checks.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"
#include "base/error.hpp"
#include "base/numbers.hpp"
#include "plugin/parameters.hpp"
#include "scene/motion/matrix.hpp"
#include "stand/multi_preparer.hpp"
#include "stand/ray_text.hpp"
#include "structures/accel_build.hpp"
#include "tracers/rays/ray_queries.hpp"

namespace clarity::check {
namespace {

// Stretches, then turns about an axis of no particular direction.
Affine placement(const Vec& at, double degrees, const Vec& scale) {
    const double half = degrees * 0.5 * kRadPerDegree;
    const Vec axis = std::sin(half) * normalized({1, 2, -0.5});
    Matrix m = rotation({axis[0], axis[1], axis[2], std::cos(half)}) * scaling(scale);
    for (size_t i = 0; i < 3; ++i) m[4 * i + 3] = at[i];
    return to_affine(m);
}

// All trials, each placed in several ways, far enough from each other.
struct PlacedShapes {
    Scene scene;
    std::vector<size_t> trial;  // of each shape
};
PlacedShapes place_all(const std::vector<ShapeTrial>& trials, const std::vector<TouchedPart>& parts) {
    double reach = 0;
    for (const TouchedPart& part : parts)
        reach = std::max(reach, double(part.subject.size) + 2 * double(part.subject.coordinate));
    PlacedShapes placed;
    Scene& scene = placed.scene;
    scene.materials = trials.front().scene.materials;
    scene.shape_kinds = trials.front().scene.shape_kinds;
    struct Way {
        double degrees;
        Vec scale;
        double row;
    };
    const Way ways[] = {{0, {1, 1, 1}, 0}, {40, {1, 1, 1}, 3}, {-110, {0.5, -1.5, 0.8}, 7}, {25, {0.05, 0.05, 0.05}, 10}};
    for (size_t i = 0; i < trials.size(); ++i) {
        const Scene& from = trials[i].scene;
        Shape shape = from.shapes.front();
        shape.first_part = static_cast<rt_u32>(scene.shape_parts.size());
        scene.shape_numbers.resize((scene.shape_numbers.size() + 3) / 4 * 4);
        const auto shift = static_cast<rt_u32>(scene.shape_numbers.size());
        scene.shape_numbers.insert(scene.shape_numbers.end(), from.shape_numbers.begin(), from.shape_numbers.end());
        for (ShapePart part : from.shape_parts) {
            part.first_more += shift;
            scene.shape_parts.push_back(part);
        }
        for (const Way& way : ways) {
            shape.world_from_object = placement({4 * reach * double(i), reach * way.row, 0}, way.degrees, way.scale);
            scene.shapes.push_back(shape);
            placed.trial.push_back(i);
        }
    }
    return placed;
}

// A ray that starts just before a touch, in the world, and what it must find.
struct Aimed {
    rt_ray ray;
    size_t part;
    rt_i32 shape;
    double t, room;
    bool alone;  // the shape has no other part that may be nearer
};

std::vector<Aimed> aim(const std::vector<TouchedPart>& parts, const PlacedShapes& placed) {
    std::vector<Aimed> all;
    for (size_t s = 0; s < placed.trial.size(); ++s)
        for (size_t p = 0; p < parts.size(); ++p) {
            if (parts[p].trial != placed.trial[s]) continue;
            const Shape& shape = placed.scene.shapes[s];
            const Matrix m = to_matrix(shape.world_from_object);
            size_t taken = 0;
            for (const Touch& touch : parts[p].touches) {
                if (!touch.is_smooth || touch.is_second || touch.cosine < 0.3 || !(touch.hit.t > 0) || touch.ray.t_min < 0)
                    continue;
                if (++taken > 60) break;
                const Vec d = to_vec(touch.ray.direction);
                const double before = std::min(double(touch.hit.t), 0.3 * double(parts[p].subject.size) / length(d));
                // Each third ray comes from far away. t_min keeps it from other shapes.
                const double farther = taken % 3 == 2 ? 300 * double(parts[p].subject.size) / length(d) : 0;
                const Vec way = direction(m, d), at = point(m, touch.at), from = at - (before + farther) * way;
                Aimed aimed{ray_of(from, way, farther), p, static_cast<rt_i32>(s), 0, 0, shape.part_count == 1};
                const Vec dw = to_vec(aimed.ray.direction);
                aimed.t = dot(at - to_vec(aimed.ray.origin), dw) / dot(dw, dw);
                double largest = 0;
                for (size_t k = 0; k < 3; ++k) largest = std::max({largest, std::fabs(at[k]), std::fabs(from[k])});
                // Rounding must not move the ray beyond the neighbours that made the touch smooth.
                const double shrunk = length(way) / length(d);
                if (2 * 0x1p-24 * largest > 0.1 * shrunk * neighbour_distance(parts[p].subject)) continue;
                // In the units of t: what rounding of world coordinates adds, seen from the shape's own space.
                aimed.room = (2 * slack_of(parts[p].subject) / length(d) + 4e-6 * largest / length(dw)) / touch.cosine;
                all.push_back(aimed);
            }
        }
    return all;
}

}  // namespace

Outcome hits_placed(ShapeStand& stand, const Step& step) {
    if (!stand.accel()) return Outcome::skipped("no structure for scenes was found");
    const std::vector<TouchedPart>& parts = stand.parts(step);
    step("placing shapes in a scene", kShapeTrace_s);
    const PlacedShapes placed = place_all(stand.trials(step), parts);
    const std::vector<Aimed> aimed = aim(parts, placed);
    if (aimed.empty()) return Outcome::skipped("no ray met a smooth piece of the surface");
    const auto scene = std::make_shared<const Scene>(placed.scene);
    const auto device = stand.device(step);
    step("building a structure for the scene", kShapeCompile_s);
    Progress progress;
    BuildTarget target;
    target.place = BuildPlace::here;
    const auto accel = std::make_shared<const AccelData>(
        build_accel(*scene, *stand.accel(), default_parameters(*stand.accel()), progress, target));
    RayQueries queries(device);
    size_t asked = 0;
    for (const Variant& variant : stand.variants(step)) {
        Settings settings;
        settings.lanes = variant.lanes;
        settings.portable = variant.portable;
        step("compiling the scene's kernels for " + variant.text(), kShapeCompile_s);
        const auto prepared = prepare_queries(*device, scene, accel, settings, progress);
        // Nearest without limit; then t_max just behind and just before the hit, nearest and any.
        for (const double side : {0.0, 1.0, -1.0})
            for (const bool any_hit : {false, true}) {
                if (side == 0 && any_hit) continue;
                std::vector<rt_ray> rays;
                std::vector<size_t> of;
                for (size_t i = 0; i < aimed.size(); ++i) {
                    if (side < 0 && !aimed[i].alone) continue;
                    rt_ray ray = aimed[i].ray;
                    if (side != 0) ray.t_max = static_cast<float>(aimed[i].t + side * 2 * aimed[i].room);
                    if (!(ray.t_max > 0)) continue;
                    rays.push_back(ray);
                    of.push_back(i);
                }
                step("tracing rays at placed shapes with " + variant.text(), kShapeCompile_s);
                RayQuery query;
                query.any_hit = any_hit;
                std::vector<rt_hit> hits;
                queries.trace(*prepared, RayBlocks(rays, prepared->layout.lanes), query, &hits);
                asked += rays.size();
                for (size_t i = 0; i < rays.size(); ++i) {
                    const Aimed& at = aimed[of[i]];
                    const bool expected = side >= 0;
                    bool right;
                    std::string found;
                    if (any_hit) {
                        right = (hits[i].t == 0) == expected;
                        found = hits[i].t == 0 ? "occluded" : "free";
                    } else {
                        const bool hit = hits[i].prim >= 0 && std::isfinite(hits[i].t);
                        const double beside = double(hits[i].t) - at.t;
                        right = expected
                                    ? hit && hits[i].prim == at.shape && beside <= at.room && (!at.alone || beside >= -at.room)
                                    : !hit;
                        found = hit ? "t " + exact_text(hits[i].t) + ", prim " + std::to_string(hits[i].prim) : "nothing";
                    }
                    if (right) continue;
                    return Outcome::failed(
                        std::string(any_hit ? "any-hit" : "nearest") + " with " + variant.text() + ": ray " +
                        ray_text(rays[i]) + " at placement " + std::to_string(at.shape % 4 + 1) + " of " +
                        parts[at.part].subject.what + " found " + found + ", expected " +
                        (expected ? "t " + exact_text(static_cast<float>(at.t)) + ", prim " + std::to_string(at.shape)
                                  : std::string("nothing before t_max")));
                }
            }
    }
    return Outcome::passed(std::to_string(asked) + " rays at " + std::to_string(placed.trial.size()) +
                           " placed shapes are right");
}

}  // namespace clarity::check
