#include "check/hits/all_hits_checks.hpp"

#include <algorithm>
#include <cmath>

#include "base/numbers.hpp"
#include "render/tracers/rays/ray_text.hpp"

namespace clarity::check {
namespace {

constexpr size_t kAllRays = 96;  // of a set: a program compiles in seconds, and these rays take milliseconds

bool is_of(const Contact& contact, const rt_hit& hit) {
    return contact.prim == hit.prim && contact.instance == hit.instance &&
           std::fabs(contact.t - hit.t) <= contact.t_error + kRelativeError * std::fabs(contact.t);
}

std::string text_of(const rt_hit& hit) {
    return "primitive " + std::to_string(hit.prim) + " at t " + exact_text(hit.t);
}

// What is wrong with the list of one ray; empty: nothing. It may have what is only nearly hit, and a sphere a second time.
std::string list_fault(const rt_ray& ray, const Truth& truth, const rt_hit* begin, const rt_hit* end) {
    for (const rt_hit* hit = begin; hit != end; ++hit) {
        if (!(hit->t >= ray.t_min && hit->t < ray.t_max)) return text_of(*hit) + " is outside of its limits";
        if (hit > begin && (hit->t < hit[-1].t || (hit->t == hit[-1].t && hit->prim <= hit[-1].prim)))
            return text_of(*hit) + " is listed behind " + text_of(hit[-1]) + ": hits are ordered by t and number, each once";
        const auto is_same = [hit](const rt_hit& other) { return other.prim == hit->prim && other.instance == hit->instance; };
        if (std::none_of(truth.contacts.begin(), truth.contacts.end(), [hit](const Contact& c) { return is_of(c, *hit); }) &&
            !std::any_of(begin, hit, is_same))
            return text_of(*hit) + " is listed, but the ray does not meet it there";
    }
    for (const Contact& contact : truth.contacts) {
        if (!contact.certain) continue;
        // Where the ray meets an edge, it is certain of one of the triangles there.
        const auto serves = [&](const rt_hit& hit) {
            if (is_of(contact, hit)) return true;
            return std::any_of(truth.contacts.begin(), truth.contacts.end(),
                               [&](const Contact& other) { return is_of(other, hit) && other.latest == contact.latest; });
        };
        if (std::none_of(begin, end, serves))
            return "primitive " + std::to_string(contact.prim) + " at t " + exact_text(float(contact.t)) +
                   " is not listed: a traversal looks for more as long as `hit->t` is not shortened, and does not stop at a "
                   "hit";
    }
    return {};
}

Outcome trace_all(Bench& bench, const Variant& variant, const char* name, const Step& step, uint64_t& listed, size_t& longest) {
    const RaySet& set = bench.set(name, step);
    const std::vector<Truth>& truths = bench.truths(set, step);
    CheckedScene& scene = bench.scene(step);
    step(std::string("listing all hits of ") + name + " with " + variant.text(), compile_limit_s(bench.options()));
    const AllHits all = scene.trace_all(variant, set.rays, false), counted = scene.trace_all(variant, set.rays, true);
    for (size_t i = 0; i < set.rays.size(); ++i) {
        std::string why =
            list_fault(set.rays[i], truths[i], all.hits.data() + all.first[i], all.hits.data() + all.first[i + 1]);
        if (why.empty() && counted.count(i) != all.count(i))
            why = std::to_string(all.count(i)) + " hits are listed, but " + std::to_string(counted.count(i)) + " are counted";
        if (!why.empty())
            return Outcome::failed("with " + variant.text() + ", all hits of the ray " + ray_text(set.rays[i]) + " of " + name +
                                   ": " + why);
        longest = std::max<size_t>(longest, all.count(i));
    }
    listed += all.hits.size();
    return Outcome::passed("");
}

Outcome all_hits_of(Bench& bench, const Step& step) {
    bench.scene(step);
    // One lane shows what a traversal stops at, and its program is the smallest. The most lanes have lists for many rays at
    // once.
    std::vector<int> lanes = bench.options().lanes;
    lanes = bench.options().quick || lanes.size() < 2 ? std::vector<int>{lanes.front()}
                                                      : std::vector<int>{lanes.front(), lanes.back()};
    uint64_t listed = 0;
    size_t longest = 0;
    for (const int count : lanes)
        for (const char* name : {"hits.random", "hits.nested", "hits.instances", "hits.primitives"}) {
            Outcome outcome = trace_all(bench, {count, false, false}, name, step, listed, longest);
            if (outcome.kind == Outcome::Kind::failed) return outcome;
        }
    return Outcome::passed(std::to_string(listed) + " hits are listed and counted, up to " + std::to_string(longest) +
                           " of a ray");
}

}  // namespace

Check all_hits_check(const BenchInput& input) {
    BenchInput few = input;
    few.options.rays = std::min<size_t>(few.options.rays, kAllRays);
    const auto bench = std::make_shared<Bench>(few);
    return {"hits.all", "all hits along a ray, in their order, and how many they are",
            [=](const Step& step) { return all_hits_of(*bench, step); }};
}

}  // namespace clarity::check
