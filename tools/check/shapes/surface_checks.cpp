#include "tools/check/shapes/surface_checks.hpp"

#include <algorithm>
#include <cmath>

#include "base/numbers.hpp"
#include "stand/seed.hpp"

namespace clarity::check {
namespace {

std::string number(double x) {
    return exact_text(static_cast<float>(x));
}

// How the host sees a point of a surface: the errors that it adds for a shape which is not placed elsewhere (RT_PLACED_ERROR
// and RT_ORIGIN_ERROR of surface.h).
double error_of(const ProbeSurface& surface, const Vec& at) {
    const Vec n = normalized(to_vec(surface.normal));
    double products = 0, largest = 0;
    for (size_t k = 0; k < 3; ++k) {
        products += std::fabs(n[k] * at[k]);
        largest = std::max(largest, std::fabs(at[k]));
    }
    return double(surface.error) + 7 * 0x1p-24 * products + 12 * 0x1p-24 * largest;
}

}  // namespace

Outcome surface_height(ShapeStand& stand, const Step& step) {
    RayFindings findings;
    for (const TouchedPart& part : stand.parts(step)) {
        const ShapeSubject& subject = part.subject;
        const double lift = 1e-3 * double(subject.size);
        std::vector<ProbePoint> points;  // above and below
        std::vector<size_t> of;
        for (size_t i = 0; i < part.touches.size(); ++i) {
            const Touch& touch = part.touches[i];
            const ProbeSurface& surface = part.surfaces[i];
            findings.tried();
            const Vec normal = to_vec(surface.normal);
            const bool behind = dot(normal, to_vec(touch.ray.direction)) > 0;
            if (!std::isfinite(surface.height) || !std::isfinite(surface.error) || !std::isfinite(dot(normal, normal)) ||
                !(dot(normal, normal) > 0)) {
                findings.wrong(subject, touch.ray, behind, "normal, height or error are no numbers, or the normal is 0");
                continue;
            }
            const double room = 2 * slack_of(subject) + 4 * double(surface.error);
            if (std::fabs(double(surface.height)) > room) {
                findings.wrong(
                    subject, touch.ray, behind,
                    "the hit at t " + exact_text(touch.hit.t) + " is " + exact_text(surface.height) + " above the surface");
                continue;
            }
            if (!touch.is_smooth || lift < 20 * slack_of(subject) * 0.25) continue;
            for (const double sign : {1.0, -1.0}) {
                const Vec at = touch.at + sign * lift * normalized(normal);
                points.push_back({{float(at[0]), float(at[1]), float(at[2])}, touch.hit.u, touch.hit.v});
                of.push_back(i);
            }
        }
        step("computing heights beside the surface of " + subject.what, kShapeTrace_s);
        const std::vector<ProbeSurface> found = stand.first_probe(step).surfaces(subject, points);
        for (size_t i = 0; i < points.size(); ++i) {
            const double expected = i % 2 ? -lift : lift;
            if (std::fabs(double(found[i].height) - expected) <= 0.3 * lift) continue;
            const Touch& touch = part.touches[of[i]];
            findings.wrong(subject, touch.ray, dot(to_vec(part.surfaces[of[i]].normal), to_vec(touch.ray.direction)) > 0,
                           "a point that is " + number(expected) + " from the hit at t " + exact_text(touch.hit.t) +
                               " along the normal has the height " + exact_text(found[i].height));
        }
    }
    if (!findings.empty())
        return Outcome::failed(
            findings.text("heights disagree with the hits: height is the distance above the surface, along the normal"));
    return Outcome::passed(std::to_string(findings.tried_count()) + " heights agree with the hits");
}

Outcome surface_normal(ShapeStand& stand, const Step& step) {
    RayFindings slanted, inward;
    for (const TouchedPart& part : stand.parts(step)) {
        const ShapeSubject& subject = part.subject;
        // A shape is closed if rays from outside of its box meet it an even number of times; it is seen from outside first.
        std::vector<rt_ray> behind;
        std::vector<size_t> firsts;
        for (size_t i = 0; i < part.touches.size(); ++i) {
            const Touch& touch = part.touches[i];
            if (touch.is_smooth) {
                const Vec n = to_vec(part.surfaces[i].normal);
                slanted.tried();
                // Differences are exact where the ray comes steeply.
                if (touch.cosine > 0.3 && !(std::fabs(dot(n, touch.across)) >= 0.98 * length(n)))
                    slanted.wrong(subject, touch.ray, dot(n, to_vec(touch.ray.direction)) > 0,
                                  "normal " + exact_text(part.surfaces[i].normal[0]) + " " +
                                      exact_text(part.surfaces[i].normal[1]) + " " + exact_text(part.surfaces[i].normal[2]) +
                                      ", but neighbouring hits show " + number(touch.across[0]) + " " +
                                      number(touch.across[1]) + " " + number(touch.across[2]));
            }
        }
        size_t from_outside = 0, once = 0, face_away = 0;
        size_t first_away = 0;
        for (size_t i = 0; i < part.touches.size(); ++i) {
            const Touch& touch = part.touches[i];
            if (touch.is_second || touch.ray.t_min < 0) continue;
            bool outside = false;
            for (size_t k = 0; k < 3; ++k)
                outside = outside || touch.ray.origin[k] < subject.lo[k] || touch.ray.origin[k] > subject.hi[k];
            if (!outside || !touch.is_smooth || touch.cosine < 0.2) continue;
            ++from_outside;
            behind.push_back(touch.ray);
            firsts.push_back(i);
            if (dot(to_vec(part.surfaces[i].normal), to_vec(touch.ray.direction)) > 0) {
                if (face_away++ == 0) first_away = i;
            }
        }
        // Whether each has another hit behind: at most one in a hundred has none, at an edge.
        for (size_t i = 0; i < behind.size(); ++i)
            behind[i].t_min = static_cast<float>(double(part.touches[firsts[i]].hit.t) +
                                                 2 * neighbour_distance(subject) / length(to_vec(behind[i].direction)));
        step("looking behind the hits of " + subject.what, kShapeTrace_s);
        const std::vector<ProbeHit> next = stand.first_probe(step).hits(subject, behind);
        for (size_t i = 0; i < behind.size(); ++i) once += !is_hit(behind[i], next[i]);
        const bool closed = from_outside >= 20 && once * 100 <= from_outside;
        inward.tried(closed ? from_outside : 0);
        if (closed && face_away * 50 > from_outside) {
            inward.wrong(subject, part.touches[first_away].ray, true,
                         std::to_string(face_away) + " of " + std::to_string(from_outside) + " normals there point inwards");
        }
    }
    if (!slanted.empty()) return Outcome::failed(slanted.text("normals are not across the surface"));
    if (!inward.empty())
        return Outcome::failed(
            inward.text("rays that come from outside of a closed shape see the back of its surface: normals point outwards"));
    return Outcome::passed(std::to_string(slanted.tried_count()) + " normals are across the surface" +
                           (inward.tried_count() ? ", and outward where the shape is closed" : ""));
}

Outcome surface_leaving(ShapeStand& stand, const Step& step) {
    RayFindings findings;
    std::mt19937 random = random_of(51, stand.options().seed);
    for (const TouchedPart& part : stand.parts(step)) {
        const ShapeSubject& subject = part.subject;
        std::vector<rt_ray> rays;
        std::vector<double> near;  // as far as a hit is the surface itself
        for (size_t i = 0; i < part.touches.size(); ++i) {
            const Touch& touch = part.touches[i];
            const ProbeSurface& surface = part.surfaces[i];
            const Vec n = to_vec(surface.normal);
            if (!touch.is_smooth || !(dot(n, n) > 0) || !std::isfinite(dot(n, n))) continue;
            const double error = error_of(surface, touch.at);
            for (const double side : {1.0, -1.0}) {
                Vec way = random_direction(random);
                const double cosine = side * dot(way, normalized(n));
                if (std::fabs(cosine) < 0.1) continue;
                if (cosine < 0) way = -1.0 * way;
                const Vec from = touch.at + (side * error - double(surface.height)) * normalized(n);
                rays.push_back(ray_of(from, way));
                near.push_back(std::min(30 * error / std::fabs(cosine), neighbour_distance(subject)));
            }
        }
        step("tracing rays that leave " + subject.what, kShapeTrace_s);
        const std::vector<ProbeHit> answers = stand.first_probe(step).hits(subject, rays);
        findings.tried(rays.size());
        for (size_t i = 0; i < rays.size(); ++i)
            if (is_hit(rays[i], answers[i]) && double(answers[i].t) < near[i])
                findings.wrong(subject, rays[i], false, "found the surface again at t " + exact_text(answers[i].t));
    }
    // One in a thousand may meet another sheet of the surface.
    if (findings.wrong_count() * 1000 > findings.tried_count())
        return Outcome::failed(
            findings.text("rays that start `error` above the surface and leave it meet it again, which makes black dots: make "
                          "s->error larger, or "
                          "the test more exact"));
    return Outcome::passed(std::to_string(findings.tried_count()) + " rays leave the surface");
}

}  // namespace clarity::check
