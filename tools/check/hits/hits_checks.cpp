#include "tools/check/hits/hits_checks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <regex>
#include <sstream>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "base/problem.hpp"
#include "device/kernel_files.hpp"
#include "plugin/capabilities.hpp"
#include "rt_plugin.h"
#include "stand/ray_text.hpp"
#include "tools/check/hits/built_checks.hpp"
#include "tools/check/hits/hit_stand.hpp"
#include "tools/check/oclgrind.hpp"

namespace clarity::check {
namespace {

// Whether a structure finds all hits along a ray, and counts as many.
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

Outcome trace_all(HitStand& stand, const Variant& variant, const char* name, const Step& step, uint64_t& listed,
                  size_t& longest) {
    const RaySet& set = stand.set(name, step);
    const std::vector<Truth>& truths = stand.truths(set, step);
    CheckedScene& scene = stand.scene(step);
    step(std::string("listing all hits of ") + name + " with " + variant.text(), compile_limit_s(stand.options()));
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

Outcome all_hits_of(HitStand& stand, const Step& step) {
    stand.scene(step);
    // One lane shows what a traversal stops at, and its program is the smallest. The most lanes have lists for many rays at
    // once.
    std::vector<int> lanes = stand.options().lanes;
    lanes = stand.options().quick || lanes.size() < 2 ? std::vector<int>{lanes.front()}
                                                      : std::vector<int>{lanes.front(), lanes.back()};
    uint64_t listed = 0;
    size_t longest = 0;
    for (const int count : lanes)
        for (const char* name : {"hits.random", "hits.nested", "hits.instances", "hits.primitives"}) {
            Outcome outcome = trace_all(stand, Variant::plain(count), name, step, listed, longest);
            if (outcome.kind == Outcome::Kind::failed) return outcome;
        }
    return Outcome::passed(std::to_string(listed) + " hits are listed and counted, up to " + std::to_string(longest) +
                           " of a ray");
}

// The check `hits.all`.
Check all_hits_check(const StandInput& input) {
    StandInput few = input;
    few.options.rays = std::min<size_t>(few.options.rays, kAllRays);
    const auto stand = std::make_shared<HitStand>(few);
    return {"hits.all", "all hits along a ray, in their order, and how many they are",
            [=](const Step& step) { return all_hits_of(*stand, step); }};
}

// Names of the host that a plugin's kernels must not define.

// What plugins bind for the templates of cl/ (CONTRACT.md).
constexpr const char* kBindings[] = {"RT_PACKET_STACK_SIZE", "RT_PACKET_RAYS",  "RT_STEP_STACK_SIZE",
                                     "RT_STEP_DONE",         "RT_STEP_IS_LEAF", "RT_TRAVERSES_PACKETS"};

bool is_reserved(const std::string& name, bool is_undef) {
    if (name.rfind("RT_", 0) != 0 && name.rfind("rt_", 0) != 0 && name != "vfloat" && name != "vint" && name != "vmask")
        return false;
    if (std::find(std::begin(kBindings), std::end(kBindings), name) != std::end(kBindings)) return false;
    // <id>_types.h may take back a capability.
    return !(is_undef && std::any_of(capabilities().begin(), capabilities().end(),
                                     [&](const Capability& capability) { return name == capability.define; }));
}

// What is wrong: "my_tree.cl:3 defines RT_LANES, ..."; empty: nothing. A compiler's message about it would be a riddle.
Problem reserved_name_fault(const rt_plugin& tracer) {
    static const std::regex directive(R"(\s*#\s*(define|undef)\s+(\w+).*)"), mark(R"(\s*#line\s+(\d+)\s+\"([^\"]*)\".*)");
    for (const rt_cl_file* file : {&tracer.accel->types, &tracer.accel->traverse}) {
        if (!file->text) continue;
        std::istringstream text(plugin_kernel_text(tracer, *file));
        std::string shown = plugin_kernel_name(tracer, *file), line;
        std::smatch found;
        for (unsigned number = 1; std::getline(text, line); ++number) {
            if (std::regex_match(line, found, mark)) {  // the next line's place
                number = static_cast<unsigned>(std::stoul(found[1])) - 1;
                shown = found[2];
            } else if (shown.rfind("cl/", 0) != 0 && std::regex_match(line, found, directive) &&
                       is_reserved(found[2], found[1] == "undef")) {
                return shown + ":" + std::to_string(number) + " has `#" + found[1].str() + " " + found[2].str() +
                       "`, which is a name of the host: choose one that begins with " + tracer.id + "_ or its capitals";
            }
        }
    }
    return {};
}

Outcome compile(HitStand& stand, const rt_plugin& tracer, const Step& step) {
    if (const Problem why = reserved_name_fault(tracer)) return Outcome::failed(why.text());
    for (const Variant& variant : stand.variants(step)) try {
            stand.compiled(variant, step);
        } catch (const Error& e) {
            std::string log = e.details().substr(0, 400);
            std::replace(log.begin(), log.end(), '\n', ' ');
            return Outcome::failed("for " + variant.text() + ": " + e.what() + (log.empty() ? "" : ": " + log));
        }
    return Outcome::passed(std::to_string(stand.variants(step).size()) + " programs compiled");
}

Outcome strange_set(HitStand& stand, const std::string& name, const Step& step) {
    const RaySet& set = stand.set(name, step);
    const auto is_strange = [](size_t i) { return i % 5 == 2; };
    const BruteForce force(stand.scene(step).build_scene());
    std::vector<Truth> truths;  // strange rays hit nothing
    for (size_t i = 0; i < set.rays.size(); ++i) truths.push_back(is_strange(i) ? Truth() : force.trace(set.rays[i]));
    return trace_passes(stand, set.rays, step, [&](const Pass& pass) {
        std::vector<rt_hit> hits = pass.traced.hits;
        for (size_t i = 0; i < hits.size(); ++i) {
            if (!is_strange(i)) continue;
            rt_hit& hit = hits[i];
            if (std::isnan(hit.t) || hit.prim < -1 || hit.prim >= static_cast<rt_i32>(kTrapPrim))
                return Outcome::failed("the ray " + ray_text(set.rays[i]) + " has an answer that is none: t " +
                                       std::to_string(hit.t) + ", prim " + std::to_string(hit.prim));
            hit.t = INFINITY, hit.prim = -1;  // no answer of a strange ray is wrong: it counts as a miss
        }
        const Faults faults = Faults::of(set.rays, truths, hits, pass.any_hit);
        if (faults.wrong.empty()) return Outcome::passed("");
        Outcome outcome =
            Outcome::failed("beside rays that are no numbers (`--only hits.random` tells whether it is right without them): " +
                            faults.text(set.rays, truths, hits, pass.variant.lanes));
        outcome.repeat = write_report(stand, name, faults, set.rays, hits, pass.what);
        return outcome;
    });
}

Outcome accesses(HitStand& stand, const Step& step) {
    const Variant variant = Variant::plain(stand.options().lanes.front());
    size_t rays = 0;
    for (const RaySet& set : stand.sets(step))
        for (const bool any_hit : {false, true}) {
            CheckedScene& scene = stand.compiled(variant, step);
            step(std::string("tracing ") + set.name + " on a simulated device", compile_limit_s(stand.options()));
            scene.trace(variant, set.rays, any_hit);
            rays += set.rays.size();
        }
    return Outcome::passed("every access of " + std::to_string(rays) + " rays is within its buffer");
}

}  // namespace

void fit_lanes(HitsOptions& options, const DeviceInfo& info) {
    if (!info.traces_packets() && !options.lanes_are_named) options.lanes = {1};  // as resolve_packet()
}

std::vector<Check> access_checks(const rt_plugin& plugin, const rt_plugin* layout,
                                 const std::function<std::shared_ptr<Device>()>& open, const HitsOptions& options) {
    HitsOptions few = options;
    few.rays = 16;
    few.lanes.resize(1);
    const auto stand = std::make_shared<HitStand>(StandInput{plugin, layout, open, few});
    return {{kAccessCheck, kAccessTried, [=](const Step& step) { return accesses(*stand, step); }}};
}

std::vector<Check> hits_checks(const rt_plugin& plugin, const rt_plugin* layout,
                               const std::function<std::shared_ptr<Device>()>& open_device, const HitsOptions& options) {
    const auto opened = std::make_shared<std::shared_ptr<Device>>();
    const OpenDevice open = [opened, open_device] {
        if (!*opened) *opened = open_device();
        return *opened;
    };
    const StandInput input{plugin, layout, open, options};
    const rt_plugin& tracer = layout ? *layout : plugin;
    const auto stand = std::make_shared<HitStand>(input), regular = std::make_shared<HitStand>(input, kRegularScene),
               floor = std::make_shared<HitStand>(input, kFloorScene), sizes = std::make_shared<HitStand>(input, kSizesScene);
    std::vector<Check> checks = {
        {"hits.kernels", "the kernels compile for each number of lanes, and define no name of the host",
         [=, &tracer](const Step& step) { return compile(*stand, tracer, step); }},
        {"hits.stack", "the traversal stack holds the tree, with --debug",
         [=](const Step& step) { return stack_check(input, *stand, *regular, step); }},
        {"hits.pushes", "the traversal asks RT_STACK_OK before each push",
         [=](const Step& step) { return pushes_check(input, step); }},
        {"hits.counts", "primitives are tested by the host", [=](const Step& step) { return counts_check(input, step); }}};
    for (const auto& of : {sizes, stand, floor, regular})
        for (const RaySet& set : of->test().rays(BuildScene(), 0, 0)) {
            const std::string name = set.name;
            if (set.strange)
                checks.push_back({name, set.tried, [=](const Step& step) { return strange_set(*of, name, step); }});
            else
                checks.push_back({name, set.tried, [=](const Step& step) { return trace_set(*of, name, step); }});
        }
    checks.push_back(planes_check(input));
    const RaySet crowd = crowd_ray_sets(BuildScene(), 0).front();
    checks.push_back({crowd.name, crowd.tried, [=](const Step& step) { return crowd_check(input, step); }});
    for (Check& check : built_checks(input)) checks.push_back(std::move(check));
    checks.push_back(all_hits_check(input));
    checks.push_back(device_hits_check(plugin, layout, open));
    return checks;
}

}  // namespace clarity::check
