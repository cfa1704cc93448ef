#include "tools/check/builds/result_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <tuple>
#include <unordered_map>

#include "base/angle.hpp"
#include "base/text.hpp"

namespace clarity::check {
namespace {

const char* kind_of(rt_u32 ref) {
    switch (RT_REF_KIND(ref)) {
        case RT_REF_TRIANGLE:
            return "triangle ";
        case RT_REF_SPHERE:
            return "sphere ";
        case RT_REF_POLYGON:
            return "polygon ";
        case RT_REF_INSTANCE:
            return "instance ";
    }
    return "primitive of no kind ";
}
std::string name_of(rt_u32 ref) {
    return kind_of(ref) + std::to_string(RT_REF_INDEX(ref));
}

// A box, a sphere or an oriented box that `levels` showed.
struct Volume {
    std::array<float, 6> box{};  // lo, hi; a sphere: centre, radius, 0, 0; an oriented box: -lengths, lengths of `halves`
    bool sphere = false, oriented = false;
    std::array<float, 3> center{};  // these two are of oriented boxes
    std::array<float, 9> halves{};
    bool operator<(const Volume& o) const {
        return std::tie(sphere, box, center, halves) < std::tie(o.sphere, o.box, o.center, o.halves);
    }
    // The coordinates of a point along the volume's own axes.
    std::array<double, 3> inward(const float* p) const {
        if (!oriented) return {p[0], p[1], p[2]};
        std::array<double, 3> at{};
        for (int a = 0; a < 3; ++a) {
            // Lengths near 0 have no direction: whether such a point is inside the plane is for the hits to tell.
            if (!(box[3 + a] > 0)) continue;
            for (int k = 0; k < 3; ++k) at[a] += (double(p[k]) - center[k]) * halves[3 * a + k] / box[3 + a];
        }
        return at;
    }
    bool sound() const {
        if (sphere) {
            for (int k = 0; k < 3; ++k)
                if (!std::isfinite(box[k])) return false;
            return box[3] >= 0;
        }
        for (int k = 0; k < 3; ++k)
            if (!(box[k] <= box[k + 3])) return false;
        return true;
    }
    bool holds(const float* p) const {
        if (!sphere) {
            const std::array<double, 3> at = inward(p);
            // The axes of an oriented box are shown rounded, and traversals compute with them in single precision: 1e-5 of its
            // size.
            const double slack = oriented ? 1e-5 * std::max({box[3], box[4], box[5]}) : 0;
            for (int k = 0; k < 3; ++k)
                if (!(at[k] >= box[k] - slack && at[k] <= box[k + 3] + slack)) return false;
            return true;
        }
        double d2 = 0;
        for (int k = 0; k < 3; ++k) d2 += (double(p[k]) - box[k]) * (double(p[k]) - box[k]);
        // A traversal computes with spheres in single precision, so rounding is theirs to plan for: 1e-6 of the radius.
        return std::sqrt(d2) <= double(box[3]) * (1 + 1e-6);
    }
    double surface() const {
        if (sphere) return 4 * kPi * double(box[3]) * box[3];
        const double x = double(box[3]) - box[0], y = double(box[4]) - box[1], z = double(box[5]) - box[2];
        return 2 * (x * y + y * z + z * x);
    }
    // How far p is outside, along the axis on which it is most; a sphere: from its surface.
    double outside(const float* p) const {
        double most = 0;
        if (sphere) {
            double d2 = 0;
            for (int k = 0; k < 3; ++k) d2 += (double(p[k]) - box[k]) * (double(p[k]) - box[k]);
            return std::sqrt(d2) - box[3];
        }
        const std::array<double, 3> at = inward(p);
        for (int k = 0; k < 3; ++k) most = std::max({most, double(box[k]) - at[k], at[k] - box[k + 3]});
        return most;
    }
};

struct Collected {
    std::vector<Volume> volumes;
};

std::vector<Volume> volumes_of(const rt_plugin& plugin, const rt_built& built, rt_u32 group, rt_u32 level, Problem& why) {
    Collected collected;
    rt_volume_sink sink{};
    sink.struct_bytes = sizeof sink;
    sink.ctx = &collected;
    sink.box = [](void* ctx, const float lo[3], const float hi[3]) {
        Volume v;
        std::copy_n(lo, 3, v.box.begin());
        std::copy_n(hi, 3, v.box.begin() + 3);
        static_cast<Collected*>(ctx)->volumes.push_back(v);
    };
    sink.sphere = [](void* ctx, const float center[3], float radius) {
        Volume v;
        v.sphere = true;
        std::copy_n(center, 3, v.box.begin());
        v.box[3] = radius;
        static_cast<Collected*>(ctx)->volumes.push_back(v);
    };
    sink.oriented_box = [](void* ctx, const float center[3], const float halves[9]) {
        Volume v;
        v.oriented = true;
        std::copy_n(center, 3, v.center.begin());
        std::copy_n(halves, 9, v.halves.begin());
        for (int a = 0; a < 3; ++a) {
            const float* const h = halves + 3 * a;
            v.box[3 + a] = std::hypot(h[0], h[1], h[2]);
            v.box[a] = -v.box[3 + a];
        }
        static_cast<Collected*>(ctx)->volumes.push_back(v);
    };
    Progress progress;
    HostServices services("levels", progress);
    try {
        services.check(1, [&] { return plugin.accel->levels(services.host(), &built, group, level, &sink); });
    } catch (const std::exception& e) {
        why = e.what();
    }
    return std::move(collected.volumes);
}

std::string level_text(rt_u32 level) {
    return level == RT_LEVEL_BOTTOM ? "the bottom level" : "level " + std::to_string(level);
}

std::string text(const char* format, double a, double b = 0, double c = 0) {
    char buffer[160];
    std::snprintf(buffer, sizeof buffer, format, a, b, c);
    return buffer;
}

// Checks one group.
Problem loose_in_group(const rt_plugin& plugin, const BuildScene& scene, const rt_built& built, rt_u32 group) {
    constexpr rt_u32 kMostLevels = 64;
    Problem why;
    const std::vector<Volume> bottom = volumes_of(plugin, built, group, RT_LEVEL_BOTTOM, why);
    if (why) return why;
    const std::set<Volume> leaves(bottom.begin(), bottom.end());
    std::vector<Volume> shallow;  // leaves above the level that is looked at
    const rt_group& range = scene.groups[group];
    for (rt_u32 n = 0; n < kMostLevels; ++n) {
        const rt_u32 level = n == 0 ? RT_LEVEL_BOTTOM : n - 1;
        std::vector<Volume> volumes = n == 0 ? bottom : volumes_of(plugin, built, group, level, why);
        if (why) return why;
        if (n > 0 && volumes.empty()) break;
        for (const Volume& v : volumes)
            if (!v.sound())
                return level_text(level) + " of group " + std::to_string(group) +
                       (v.sphere ? " has a sphere of radius " + text("%g", v.box[3])
                                 : " has a box from " + text("%g %g %g", v.box[0], v.box[1], v.box[2]) + " to " +
                                       text("%g %g %g", v.box[3], v.box[4], v.box[5])) +
                       ", which is no volume: no ray, or every ray, enters it";
        std::vector<Volume> all = volumes;
        if (n > 0) all.insert(all.end(), shallow.begin(), shallow.end());
        for (rt_u32 i = range.first; i < range.first + range.count; ++i) {
            const rt_u32 ref = scene.prims[i].ref;
            if (RT_REF_KIND(ref) != RT_REF_TRIANGLE) continue;
            const rt_packed_prim& t = scene.triangles[RT_REF_INDEX(ref)];
            for (const float* corner : {t.a, t.b, t.c}) {
                if (std::any_of(all.begin(), all.end(), [&](const Volume& v) { return v.holds(corner); })) continue;
                const Volume* nearest = nullptr;
                double least = INFINITY;
                for (const Volume& v : all)
                    if (v.outside(corner) < least) least = v.outside(corner), nearest = &v;
                if (!nearest)
                    return level_text(level) + " of group " + std::to_string(group) +
                           " shows no volume, but the group has primitives";
                return "a corner of " + name_of(ref) + " of group " + std::to_string(group) + " at " +
                       text("%.9g %.9g %.9g", corner[0], corner[1], corner[2]) + " is in no volume of " + level_text(level) +
                       "; it is " + text("%.3g", least) + " outside of the nearest one" +
                       (least < 1e-5 * (1 + std::fabs(corner[0]) + std::fabs(corner[1]) + std::fabs(corner[2]))
                            ? ": a bound that was rounded to the wrong side"
                            : "");
            }
        }
        if (n > 0)
            for (const Volume& v : volumes)
                if (leaves.count(v)) shallow.push_back(v);
    }
    return {};
}

// How often each primitive of the input is a leaf. unknown: names the first leaf that is none of them.
std::unordered_map<rt_u32, rt_u32> times_of(const BuildScene& scene, const BuilderResult& result, Problem& unknown) {
    std::unordered_map<rt_u32, rt_u32> times;
    times.reserve(scene.prims.size() * 2);
    for (const rt_prim& prim : scene.prims) times[prim.ref] = 0;
    const auto* refs = static_cast<const rt_u32*>(result.refs.data());
    for (uint64_t i = 0; i < result.leaf_count; ++i) {
        const auto known = times.find(refs[i]);
        if (known != times.end())
            ++known->second;
        else if (!unknown)
            unknown = "leaf " + std::to_string(i) + " is " + name_of(refs[i]) + ", which was not in the input";
    }
    return times;
}

}  // namespace

Problem unknown_ref(const BuildScene& scene, const BuilderResult& result) {
    Problem unknown;
    times_of(scene, result, unknown);
    return unknown;
}

Problem missing_refs(const BuildScene& scene, const BuilderResult& result) {
    Problem unknown;
    auto times = times_of(scene, result, unknown);
    if (unknown) return unknown;
    size_t missing = 0;
    rt_u32 first = 0;
    for (const rt_prim& prim : scene.prims)
        if (times[prim.ref] == 0 && missing++ == 0) first = prim.ref;
    if (missing == 0) return {};
    return std::to_string(missing) + " of " + std::to_string(scene.prims.size()) + " primitives are in no leaf, the first is " +
           name_of(first) + ": rays cannot hit them";
}

namespace {

// A finished build, as plugins are given it.
struct Finished {
    explicit Finished(const BuilderResult& result) : roots(result.roots) {
        for (const BuilderResult::Slot& slot : result.slots) {
            slots.push_back(slot.memory.data());
            counts.push_back(slot.count);
        }
        built = {sizeof built, static_cast<rt_u32>(roots.size()), slots.data(), counts.data(), roots.data()};
    }
    std::vector<const void*> slots;
    std::vector<uint64_t> counts;
    std::vector<rt_u32> roots;
    rt_built built;
};

}  // namespace

Problem loose_bounds(const rt_plugin& plugin, const BuildScene& scene, BuilderResult& result) {
    Finished finished(result);
    for (rt_u32 g = 0; g < result.roots.size(); ++g) {
        Problem why = loose_in_group(plugin, scene, finished.built, g);
        if (!why) continue;
        // Are its primitives below another group's root?
        for (rt_u32 other = 0; other < result.roots.size(); ++other) {
            if (result.roots[other] == result.roots[g]) continue;
            finished.roots[g] = result.roots[other];
            if (loose_in_group(plugin, scene, finished.built, g)) continue;
            return "root " + std::to_string(result.roots[g]) + ", which was reported for group " + std::to_string(g) +
                   ", is not that of its tree: its primitives are below root " + std::to_string(result.roots[other]) +
                   ", which was reported as that of the tree of group " + std::to_string(other);
        }
        return why;
    }
    return {};
}

std::vector<double> relative_surfaces(const rt_plugin& plugin, const BuilderResult& result) {
    constexpr rt_u32 kMostLevels = 128;
    const Finished finished(result);
    std::vector<double> surfaces;
    for (rt_u32 g = 0; g < result.roots.size(); ++g) {
        double first = 0, all = 0;
        for (rt_u32 level = 0; level < kMostLevels; ++level) {
            Problem why;
            const std::vector<Volume> volumes = volumes_of(plugin, finished.built, g, level, why);
            if (volumes.empty()) break;
            for (const Volume& v : volumes) all += v.surface();
            if (level == 0) first = all;
        }
        surfaces.push_back(first > 0 && std::isfinite(all) ? all / first : 0);
    }
    return surfaces;
}

Problem cost_fault(const BuildScene& scene, const std::vector<PosedCosts>& poses) {
    constexpr double kSurfaces = 2, kCosts = 1.3;  // where volumes have twice the surface, costs rise by 1.3 at least
    constexpr rt_u32 kLeast = 60;                  // primitives of a group
    for (rt_u32 g = 0; g < scene.groups.size(); ++g) {
        if (scene.groups[g].count < kLeast) continue;
        const auto says = [g](const PosedCosts& pose) { return pose.costs[g] >= 0; };
        if (std::any_of(poses.begin(), poses.end(), [](const PosedCosts& pose) { return pose.costs[0] >= 0; }) &&
            std::none_of(poses.begin(), poses.end(), says))
            return "a refit reports the cost of the world, but never that of group " + std::to_string(g) + " of " +
                   std::to_string(scene.groups[g].count) +
                   " primitives: the host would never build its tree again, however slow it became";
        for (const PosedCosts& a : poses)
            for (const PosedCosts& b : poses) {
                if (a.costs[g] < 0 || b.costs[g] < 0 || b.surfaces[g] == 0 || std::isinf(b.costs[g])) continue;
                if (a.surfaces[g] < kSurfaces * b.surfaces[g] || a.costs[g] > kCosts * b.costs[g]) continue;
                return "the cost that a refit reports of group " + std::to_string(g) + " does not follow its boxes: it is " +
                       std::to_string(a.costs[g]) + " " + a.pose + ", where they have " + std::to_string(a.surfaces[g]) +
                       " times the surface of the first level, and " + std::to_string(b.costs[g]) + " " + b.pose +
                       ", where they have " + std::to_string(b.surfaces[g]) +
                       " times: the host would never build a tree again that has become slow";
            }
    }
    return {};
}

Problem wasted_memory(const rt_accel& accel, const BuildCase& input, const BuilderResult& result) {
    constexpr uint64_t kFree = 64u << 10;
    // The nodes of a topology, which has no traversal, are freed as soon as they are packed. Its builder may ask for as many as
    // it might need.
    const bool is_kept = accel.traverse.name != nullptr;
    uint64_t bytes = 0;
    for (size_t s = 0; s < result.slots.size(); ++s) {
        const BuilderResult::Slot& slot = result.slots[s];
        const uint64_t size = slot.memory.bytes();
        bytes += size;
        const auto* p = static_cast<const unsigned char*>(slot.memory.data());
        uint64_t used = size;
        while (used > 0 && p[used - 1] == 0) --used;
        if (is_kept && size - used > kFree && used < size / 2)
            return std::string("slot ") + accel.slots[s].name + " has " + memory_text(size) + ", of which only the first " +
                   memory_text(used) + " are written: the device keeps all of it";
    }
    if (bytes > 64 * input.input_bytes() + (1u << 20))
        return "the slots take " + memory_text(bytes) + " for an input of " + memory_text(input.input_bytes());
    return {};
}

}  // namespace clarity::check
