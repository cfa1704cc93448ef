#include "tools/check/hits/judge.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/numbers.hpp"
#include "stand/ray_text.hpp"
#include "tools/check/hits/checked_scene.hpp"

namespace clarity::check {
namespace {

const char* words(Fault fault, bool any_hit) {
    switch (fault) {
        case Fault::none:
            return "right";
        case Fault::missed:
            return any_hit ? "are said to be free, but something is hit" : "hit nothing, but there is something";
        case Fault::too_far:
            return "hit something behind the nearest primitive";
        case Fault::wrong_distance:
            return "have another distance than the primitive that they name";
        case Fault::not_there:
            return any_hit ? "are said to be occluded, but nothing is between t_min and t_max"
                           : "hit a primitive that the ray does not meet";
        case Fault::outside_limits:
            return "are not between t_min and t_max";
        case Fault::no_leaf:
            return "hit what lies behind the last leaf: a leaf range reaches too far";
        case Fault::not_a_number:
            return "are no numbers";
    }
    return "";
}

const char* kind_text(const Contact& contact) {
    if (contact.instance >= 0) return "triangles of instances";
    switch (RT_REF_KIND(contact.ref)) {
        case RT_REF_SPHERE:
            return "spheres";
        case RT_REF_POLYGON:
            return "polygons";
        default:
            return "triangles of the world";
    }
}

std::string octant_text(const rt_ray& ray) {
    std::string text = "(";
    for (int k = 0; k < 3; ++k) text += std::string(k ? "," : "") + (std::signbit(ray.direction[k]) ? "-" : "+");
    return text + ")";
}

std::string hit_text(const rt_hit& hit, bool any_hit) {
    if (any_hit) return hit.t == 0 ? "occluded" : "free";
    if (hit.prim < 0) return "nothing";
    return "t " + exact_text(hit.t) + ", prim " + std::to_string(hit.prim) +
           (hit.instance >= 0 ? ", instance " + std::to_string(hit.instance) : "");
}

std::string truth_text(const Truth& truth, bool any_hit) {
    const Contact* c = truth.nearest_certain();
    if (any_hit) return c ? "occluded" : truth.contacts.empty() ? "free" : "either";
    if (!c) return truth.contacts.empty() ? "nothing" : "nothing, or what it grazes";
    return "t " + exact_text(static_cast<float>(c->t)) + ", prim " + std::to_string(c->prim) +
           (c->instance >= 0 ? ", instance " + std::to_string(c->instance) : "");
}

Fault judge_nearest(const rt_ray& ray, const Truth& truth, const rt_hit& hit) {
    if (std::isnan(hit.t)) return Fault::not_a_number;
    if (hit.prim < 0 || !std::isfinite(hit.t)) return truth.nearest_certain() ? Fault::missed : Fault::none;
    if (hit.prim >= static_cast<rt_i32>(kTrapPrim)) return Fault::no_leaf;
    if (hit.t < ray.t_min || hit.t > ray.t_max) return Fault::outside_limits;
    bool named = false;
    for (const Contact& contact : truth.contacts) {
        if (contact.prim != hit.prim || contact.instance != hit.instance) continue;
        named = true;
        if (std::fabs(contact.t - hit.t) > contact.t_error) continue;
        return hit.t > truth.latest() + contact.t_error ? Fault::too_far : Fault::none;
    }
    return named ? Fault::wrong_distance : Fault::not_there;
}

Fault judge_any(const Truth& truth, const rt_hit& hit) {
    if (std::isnan(hit.t)) return Fault::not_a_number;
    const bool occluded = hit.t == 0;
    if (!occluded && truth.nearest_certain()) return Fault::missed;
    return occluded && truth.contacts.empty() ? Fault::not_there : Fault::none;
}

}  // namespace

Fault judge(const rt_ray& ray, const Truth& truth, const rt_hit& hit, bool any_hit) {
    return any_hit ? judge_any(truth, hit) : judge_nearest(ray, truth, hit);
}

bool Faults::misses() const {
    return std::any_of(wrong.begin(), wrong.end(),
                       [](const One& one) { return one.fault == Fault::missed || one.fault == Fault::too_far; });
}

Faults Faults::of(const std::vector<rt_ray>& set, const std::vector<Truth>& truths, const std::vector<rt_hit>& hits,
                  bool any_hit) {
    Faults faults;
    faults.rays = set.size();
    faults.any_hit = any_hit;
    for (size_t i = 0; i < set.size(); ++i) {
        const Fault fault = judge(set[i], truths[i], hits[i], any_hit);
        if (fault != Fault::none) faults.wrong.push_back({i, fault});
    }
    return faults;
}

std::string Faults::text(const std::vector<rt_ray>& set, const std::vector<Truth>& truths, const std::vector<rt_hit>& hits,
                         int lanes) const {
    std::map<Fault, size_t> kinds;
    std::set<std::string> octants, primitives;
    std::map<size_t, size_t> by_lane;
    for (const One& one : wrong) {
        ++kinds[one.fault];
        octants.insert(octant_text(set[one.ray]));
        if (const Contact* c = truths[one.ray].nearest_certain()) primitives.insert(kind_text(*c));
        ++by_lane[one.ray % static_cast<size_t>(lanes)];
    }
    std::set<std::string> all_octants;
    for (const rt_ray& ray : set) all_octants.insert(octant_text(ray));
    std::string text = std::to_string(wrong.size()) + " of " + std::to_string(rays) +
                       (any_hit ? " any-hit answers " : " nearest hits ") + "are wrong: ";
    size_t left = kinds.size();
    for (const auto& [fault, count] : kinds) text += std::to_string(count) + " " + words(fault, any_hit) + (--left ? "; " : "");
    if (wrong.size() > 2 && octants.size() == 1 && all_octants.size() > 4)
        text += "; all of these rays have the direction signs " + *octants.begin();
    if (wrong.size() > 2 && primitives.size() == 1) text += "; all of them at " + *primitives.begin();
    if (wrong.size() > 4 && lanes > 1 && by_lane.size() <= static_cast<size_t>(lanes) / 4) {
        text += "; all in lane";
        for (const auto& [lane, count] : by_lane) text += " " + std::to_string(lane);
    }
    const One& first = wrong.front();
    text += ". The first: ray " + ray_text(set[first.ray]) + " -- found " + hit_text(hits[first.ray], any_hit) + ", expected " +
            truth_text(truths[first.ray], any_hit);
    return text;
}

}  // namespace clarity::check
