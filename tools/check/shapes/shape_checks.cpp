#include "tools/check/shapes/shape_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "stand/ray_text.hpp"
#include "stand/seed.hpp"
#include "tools/check/oclgrind.hpp"
#include "tools/check/shapes/shape_stand.hpp"
#include "tools/check/shapes/surface_checks.hpp"

namespace clarity::check {
namespace {

using Shared = std::shared_ptr<ShapeStand>;

std::string t_text(const rt_ray& ray, const ProbeHit& hit) {
    return is_hit(ray, hit) ? "t " + exact_text(hit.t) : std::string("nothing");
}

bool from_behind(const TouchedPart& part, size_t touch) {
    return dot(to_vec(part.surfaces[touch].normal), to_vec(part.touches[touch].ray.direction)) > 0;
}

Outcome kernels_compile(ShapeStand& stand, const Step& step) {
    for (const Variant& variant : stand.variants(step)) try {
            stand.probe(variant, step);
        } catch (const Error& e) {
            std::string log = e.details().substr(0, 400);
            std::replace(log.begin(), log.end(), '\n', ' ');
            return Outcome::failed("for " + variant.text() + ": " + e.what() + (log.empty() ? "" : ": " + log));
        }
    return Outcome::passed(std::to_string(stand.variants(step).size()) + " programs compiled");
}

// All answers are hits within t_min and the box, or none.
Outcome within_box(ShapeStand& stand, const Step& step) {
    size_t rays = 0, hits = 0;
    for (const TouchedPart& part : stand.parts(step)) {
        const ShapeSubject& subject = part.subject;
        step("tracing rays at " + subject.what, kShapeTrace_s);
        const std::vector<ProbeHit> answers = stand.first_probe(step).hits(subject, part.rays);
        const double room = 1e-5 * double(subject.size) + 1e-6 * double(subject.coordinate);
        for (size_t i = 0; i < answers.size(); ++i) {
            const rt_ray& ray = part.rays[i];
            ++rays;
            if (std::isnan(answers[i].t))
                return Outcome::failed("the distance of a finite ray is no number: ray " + ray_text(ray) + " at " +
                                       subject.what);
            if (answers[i].t < ray.t_min)
                return Outcome::failed("the distance " + exact_text(answers[i].t) +
                                       " is below t_min, so a hit behind it is lost: ray " + ray_text(ray) + " at " +
                                       subject.what);
            if (!is_hit(ray, answers[i])) continue;
            ++hits;
            const Vec at = point_of(ray, answers[i].t);
            double outside = 0;
            for (size_t k = 0; k < 3; ++k)
                outside = std::max({outside, double(subject.lo[k]) - at[k], at[k] - double(subject.hi[k])});
            if (outside > room)
                return Outcome::failed(
                    "a hit lies " + exact_text(static_cast<float>(outside / double(subject.size))) +
                    " of the box's diagonal outside of the box, where most rays never reach the kernel: ray " + ray_text(ray) +
                    " at " + subject.what + ", t " + exact_text(answers[i].t));
        }
    }
    if (hits == 0) return Outcome::failed("none of " + std::to_string(rays) + " rays at its boxes hits anything");
    return Outcome::passed(std::to_string(hits) + " hits of " + std::to_string(rays) + " rays are in its boxes");
}

// Where a ray meets the surface, rays from other directions meet it, too: from both sides, and with t_min just before the
// point.
Outcome met_again(ShapeStand& stand, const Step& step) {
    RayFindings findings;
    std::mt19937 random = random_of(11, stand.options().seed);
    for (const TouchedPart& part : stand.parts(step)) {
        const ShapeSubject& subject = part.subject;
        const double slack = slack_of(subject);
        std::vector<rt_ray> rays;
        std::vector<double> expected, room;
        std::vector<size_t> of;
        for (size_t i = 0; i < part.touches.size(); ++i) {
            const Touch& touch = part.touches[i];
            if (!touch.is_smooth || touch.cosine < 0.3) continue;
            for (int k = 0; k < 8; ++k) {
                Vec way = k == 0   ? normalized(to_vec(touch.ray.direction))
                          : k == 1 ? -1.0 * normalized(to_vec(touch.ray.direction))
                                   : random_direction(random);
                if (k == 4)  // nearly along the surface: at a silhouette
                    way = normalized(normalized(cross(touch.across, way)) + (i % 2 ? 0.12 : -0.2) * touch.across);
                if (k > 4) way = {}, way[size_t(k) - 5] = i % 2 ? 1 : -1;  // exactly along an axis
                const double cosine = std::fabs(dot(way, touch.across));
                if (cosine < (k == 4 ? 0.1 : 0.3)) continue;
                const double away = (0.05 + 1.2 * std::uniform_real_distribution<double>(0, 1)(random)) * double(subject.size);
                rt_ray ray = ray_of(touch.at - away * way, std::exp2(k % 4 - 2) * way);
                const Vec d = to_vec(ray.direction);
                const double t = dot(touch.at - to_vec(ray.origin), d) / dot(d, d), about = slack / (cosine * length(d));
                ray.t_min = static_cast<float>(t - about);
                rays.push_back(ray);
                expected.push_back(t);
                room.push_back(about);
                of.push_back(i);
            }
        }
        step("tracing rays from other sides at " + subject.what, kShapeTrace_s);
        const std::vector<ProbeHit> answers = stand.first_probe(step).hits(subject, rays);
        findings.tried(rays.size());
        for (size_t i = 0; i < rays.size(); ++i) {
            if (is_hit(rays[i], answers[i]) && std::fabs(double(answers[i].t) - expected[i]) <= 1.01 * room[i]) continue;
            const bool behind = dot(to_vec(part.surfaces[of[i]].normal), to_vec(rays[i].direction)) > 0;
            findings.wrong(subject, rays[i], behind,
                           "found " + t_text(rays[i], answers[i]) + ", but ray " + ray_text(part.touches[of[i]].ray) +
                               " meets the surface there, at t " + exact_text(static_cast<float>(expected[i])));
        }
    }
    if (!findings.empty()) return Outcome::failed(findings.text("rays miss the surface where another ray meets it"));
    if (findings.tried_count() == 0)
        return Outcome::failed("no ray met a smooth piece of the surface, so nothing could be compared");
    return Outcome::passed(std::to_string(findings.tried_count()) + " rays from other sides meet the same points");
}

// The same ray with a direction of another length, and with a larger t_min.
Outcome same_for_any_length(ShapeStand& stand, const Step& step) {
    RayFindings findings;
    for (const TouchedPart& part : stand.parts(step)) {
        const ShapeSubject& subject = part.subject;
        std::vector<rt_ray> rays;
        std::vector<size_t> of;
        std::vector<double> expected;
        for (size_t i = 0; i < part.touches.size(); ++i)
            for (const float factor : {0.125f, 3.7f, 64.f}) {
                const Touch& touch = part.touches[i];
                if (!touch.is_smooth || touch.cosine < 0.3) continue;
                rt_ray ray = touch.ray;
                for (float& d : ray.direction) d *= factor;
                ray.t_min /= factor;
                rays.push_back(ray);
                of.push_back(i);
                expected.push_back(double(touch.hit.t) / double(factor));
            }
        step("tracing rays of other lengths at " + subject.what, kShapeTrace_s);
        const std::vector<ProbeHit> answers = stand.first_probe(step).hits(subject, rays);
        findings.tried(rays.size());
        for (size_t i = 0; i < rays.size(); ++i) {
            const double room = slack_of(subject) / (0.3 * length(to_vec(rays[i].direction)));
            if (is_hit(rays[i], answers[i]) && std::fabs(double(answers[i].t) - expected[i]) <= room) continue;
            findings.wrong(
                subject, rays[i], from_behind(part, of[i]),
                "found " + t_text(rays[i], answers[i]) + ", expected t " + exact_text(static_cast<float>(expected[i])));
        }
    }
    if (!findings.empty())
        return Outcome::failed(findings.text(
            "rays find another point when their direction has another length: it is not of unit length, and t counts in it"));
    return Outcome::passed(std::to_string(findings.tried_count()) + " rays find the same point with directions of any length");
}

bool same_bits(const ProbeHit& a, const ProbeHit& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

// Whether two answers are the same for the host: it reads u and v only where something is hit.
bool same_answer(const rt_ray& ray, const ProbeHit& a, const ProbeHit& b) {
    return is_hit(ray, a) == is_hit(ray, b) && (!is_hit(ray, a) || same_bits(a, b));
}

// Every number of lanes, in any order, and beside rays that are no numbers.
Outcome same_for_any_lanes(ShapeStand& stand, const Step& step, bool strange) {
    size_t rays = 0;
    for (const TouchedPart& part : stand.parts(step)) {
        const ShapeSubject& subject = part.subject;
        step("tracing rays at " + subject.what, kShapeTrace_s);
        const std::vector<ProbeHit> expected = stand.first_probe(step).hits(subject, part.rays);
        for (const Variant& variant : stand.variants(step)) {
            ShapeProbe& probe = stand.probe(variant, step);
            // Each fifth is strange, the others in another order.
            std::vector<rt_ray> asked;
            std::vector<size_t> of;
            std::mt19937 random = random_of(23, stand.options().seed);
            std::vector<size_t> order(part.rays.size());
            for (size_t i = 0; i < order.size(); ++i) order[i] = i;
            std::shuffle(order.begin(), order.end(), random);
            for (const size_t i : order) {
                if (strange && asked.size() % 5 == 2) {
                    rt_ray odd = part.rays[i];
                    const float values[] = {NAN, INFINITY, -INFINITY, 0};
                    float* const numbers = i % 2 ? odd.direction : odd.origin;
                    for (int k = 0; k < 3; ++k)
                        if (i % 8 > 5 || k == static_cast<int>(i % 3)) numbers[k] = values[(i / 2) % 4];
                    asked.push_back(odd);
                    of.push_back(SIZE_MAX);
                }
                asked.push_back(part.rays[i]);
                of.push_back(i);
            }
            step(std::string("tracing ") + (strange ? "rays that are no numbers" : "rays") + " with " + variant.text() +
                     " at " + subject.what,
                 kShapeTrace_s);
            const std::vector<ProbeHit> answers = probe.hits(subject, asked);
            for (size_t i = 0; i < asked.size(); ++i) {
                if (of[i] == SIZE_MAX) continue;
                ++rays;
                if (same_answer(asked[i], answers[i], expected[of[i]])) continue;
                return Outcome::failed("with " + variant.text() +
                                       (strange ? " and rays that are no numbers in other lanes" : "") + ", in lane " +
                                       std::to_string(i % static_cast<size_t>(variant.lanes)) + ", ray " + ray_text(asked[i]) +
                                       " at " + subject.what + " finds " + t_text(asked[i], answers[i]) + ", with " +
                                       stand.variants(step).front().text() + " " + t_text(asked[i], expected[of[i]]) +
                                       ": every lane must be computed by itself (branches on one lane, or `#pragma OPENCL "
                                       "FP_CONTRACT OFF` left out)");
            }
        }
    }
    return Outcome::passed(std::to_string(rays) + " answers are the same in every bit");
}

// Rays along the surface may hit or miss, but what they hit must be there.
Outcome grazing(ShapeStand& stand, const Step& step) {
    size_t rays_traced = 0, hits = 0;
    std::mt19937 random = random_of(31, stand.options().seed);
    for (const TouchedPart& part : stand.parts(step)) {
        const ShapeSubject& subject = part.subject;
        std::vector<rt_ray> rays;
        for (const Touch& touch : part.touches) {
            if (!touch.is_smooth) continue;
            const Vec along = normalized(cross(touch.across, random_direction(random)));
            const double lifts[] = {0, 1e-7, -1e-7, 1e-5, -1e-5};
            const Vec at = touch.at + lifts[rays.size() % 5] * double(subject.size) * touch.across;
            rays.push_back(ray_of(at - double(subject.size) * along, along));
        }
        step("tracing rays along " + subject.what, kShapeTrace_s);
        const std::vector<ProbeHit> answers = stand.first_probe(step).hits(subject, rays);
        std::vector<ProbePoint> points;
        std::vector<size_t> of;
        for (size_t i = 0; i < rays.size(); ++i) {
            ++rays_traced;
            if (std::isnan(answers[i].t))
                return Outcome::failed("a ray along the surface has a distance that is no number: ray " + ray_text(rays[i]) +
                                       " at " + subject.what);
            if (!is_hit(rays[i], answers[i])) continue;
            const Vec at = point_of(rays[i], answers[i].t);
            points.push_back({{float(at[0]), float(at[1]), float(at[2])}, answers[i].u, answers[i].v});
            of.push_back(i);
        }
        step("computing the surface of " + subject.what, kShapeTrace_s);
        const std::vector<ProbeSurface> surfaces = stand.first_probe(step).surfaces(subject, points);
        for (size_t i = 0; i < points.size(); ++i) {
            ++hits;
            if (std::fabs(double(surfaces[i].height)) <= 2e-3 * double(subject.size) + 1e-5 * double(subject.coordinate))
                continue;
            return Outcome::failed("a ray along the surface hits a point that is " + exact_text(surfaces[i].height) +
                                   " above it, as <id>_surface says: ray " + ray_text(rays[of[i]]) + " at " + subject.what +
                                   ", t " + exact_text(answers[of[i]].t));
        }
    }
    return Outcome::passed(std::to_string(hits) + " of " + std::to_string(rays_traced) + " rays along the surface hit it");
}

// Keys at their ends: whatever is accepted gives numbers.
Outcome at_ends(ShapeStand& stand, const Step& step) {
    size_t shapes = 0;
    std::mt19937 random = random_of(41, stand.options().seed);
    for (const ShapeValues& values : values_at_ends(*stand.plugin().primitive, stand.trials(step).front().values)) {
        step("trying " + values.what, kShapeTrace_s);
        const ShapeTrial trial = try_values(stand.plugin(), values);
        if (!trial.why.empty()) continue;
        for (ShapeSubject& subject : subjects_of(stand.plugin(), trial, 1)) {
            if (!std::isfinite(subject.size)) continue;
            if (!(subject.size > 0)) subject.size = 1e-3f * std::max(subject.coordinate, 1.f);  // a point: rays go past it
            ++shapes;
            const std::vector<rt_ray> rays = rays_at(subject, 60, random);
            step("tracing rays at a shape with " + values.what, kShapeTrace_s);
            const std::vector<ProbeHit> answers = stand.first_probe(step).hits(subject, rays);
            std::vector<ProbePoint> points;
            std::vector<size_t> of;
            for (size_t i = 0; i < rays.size(); ++i) {
                if (std::isnan(answers[i].t))
                    return Outcome::failed(values.what + ": the distance of a finite ray is no number: ray " +
                                           ray_text(rays[i]) + " at " + subject.what +
                                           "; narrow the key's range, or refuse such values");
                if (!is_hit(rays[i], answers[i])) continue;
                const Vec at = point_of(rays[i], answers[i].t);
                points.push_back({{float(at[0]), float(at[1]), float(at[2])}, answers[i].u, answers[i].v});
                of.push_back(i);
            }
            const std::vector<ProbeSurface> surfaces = stand.first_probe(step).surfaces(subject, points);
            for (size_t i = 0; i < points.size(); ++i) {
                const Vec n = to_vec(surfaces[i].normal);
                if (std::isfinite(dot(n, n)) && dot(n, n) > 0 && std::isfinite(surfaces[i].height)) continue;
                return Outcome::failed(values.what + ": normal or height of a hit are no numbers: ray " +
                                       ray_text(rays[of[i]]) + " at " + subject.what +
                                       "; narrow the key's range, or refuse such values");
            }
        }
    }
    return Outcome::passed(std::to_string(shapes) + " shapes with a key at its end give numbers");
}

Outcome accesses(ShapeStand& stand, const Step& step) {
    size_t rays = 0;
    for (const TouchedPart& part : stand.parts(step)) rays += part.rays.size();
    return Outcome::passed("every access of " + std::to_string(rays) + " rays and of the surface there is within its buffer");
}

}  // namespace

std::vector<Check> shape_access_checks(const rt_plugin& plugin, const std::function<std::shared_ptr<Device>()>& open,
                                       const HitsOptions& options) {
    HitsOptions few = options;
    few.rays = 12;
    few.lanes.resize(1);
    few.quick = true;
    const auto stand = std::make_shared<ShapeStand>(plugin, nullptr, open, few);
    return {{kAccessCheck, kAccessTried, [=](const Step& step) { return accesses(*stand, step); }}};
}

std::vector<Check> shape_checks(const rt_plugin& plugin, const rt_plugin* accel,
                                const std::function<std::shared_ptr<Device>()>& open, const HitsOptions& options) {
    const auto stand = std::make_shared<ShapeStand>(plugin, accel, open, options);
    const auto check = [&](const char* name, const char* tried, Outcome (*run)(ShapeStand&, const Step&)) {
        return check_of(stand, name, tried, run);
    };
    return {
        check("hits.kernels", "the kernels compile for each number of lanes", kernels_compile),
        check("hits.box", "hits are in the box, not below t_min, and numbers", within_box),
        check("hits.again", "what one ray meets, rays from other sides meet, too", met_again),
        check("hits.length", "directions of any length", same_for_any_length),
        {"hits.lanes", "the same answers for any number of lanes and any neighbours",
         [=](const Step& step) { return same_for_any_lanes(*stand, step, false); }},
        {"hits.strange", "rays that are no numbers disturb no others",
         [=](const Step& step) { return same_for_any_lanes(*stand, step, true); }},
        check("hits.grazing", "rays along the surface", grazing),
        check("hits.ends", "shapes with a key at its least or greatest value", at_ends),
        check("surface.height", "height is the distance from where rays meet the surface", surface_height),
        check("surface.normal", "the normal is the one that neighbouring hits show, outward", surface_normal),
        check("surface.uv", "texture coordinates are 0 to 1, continuous, and turn about where they meet", surface_uv),
        check("surface.leaving", "rays that leave the surface do not meet it again", surface_leaving),
        check("hits.placed", "nearest and any in scenes: turned, stretched, small, from far away, with t_max", hits_placed),
    };
}

}  // namespace clarity::check
