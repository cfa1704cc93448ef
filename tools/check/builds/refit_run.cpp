#include "tools/check/builds/refit_run.hpp"

#include <algorithm>
#include <atomic>
#include <cfloat>
#include <cstring>
#include <memory>
#include <unordered_map>

#include "base/error.hpp"
#include "base/scoped_fp_mode.hpp"
#include "plugin/capabilities.hpp"

namespace clarity::check {
namespace {

// Serves rt_refit_input::prims, and notes what is asked for.
class AskedPrims {
 public:
    AskedPrims(const BuildScene& moved, const BuilderResult& built, const std::vector<uint8_t>& changed, HostServices& services)
        : services_(services), groups_(group_of_positions(moved, built)), times_(new std::atomic<uint8_t>[groups_.size()]()) {
        std::unordered_map<rt_u32, const rt_prim*> by_ref;
        for (const rt_prim& prim : moved.prims) by_ref[prim.ref] = &prim;
        const auto* const refs = static_cast<const rt_u32*>(built.refs.data());
        leaves_ = GuardedBytes(groups_.size() * sizeof(rt_packed_prim), "the host's leaves (read-only)", 16);
        auto* const leaves = static_cast<rt_packed_prim*>(leaves_.data());
        for (size_t i = 0; i < groups_.size(); ++i) {
            rt_prim prim = *by_ref.at(refs[i]);
            for (int k = 0; k < 3; ++k) {
                prim.lo[k] = std::clamp(prim.lo[k], -FLT_MAX, FLT_MAX);
                prim.hi[k] = std::clamp(prim.hi[k], -FLT_MAX, FLT_MAX);
            }
            prim.mesh = 0;
            prims_.push_back(prim);
            leaves[i] = packed_of(moved, refs[i]);
            wanted_.push_back(groups_[i] < changed.size() && changed[groups_[i]]);
        }
        leaves_.make_read_only();
    }
    const rt_packed_prim* leaves() const { return static_cast<const rt_packed_prim*>(leaves_.data()); }

    static int32_t prims(void* ctx, uint64_t first, uint64_t count, rt_prim* out) {
        auto& self = *static_cast<AskedPrims*>(ctx);
        const uint64_t size = self.prims_.size();
        if (!out || count > size || first > size - count) {
            self.services_.fail("the refit asked for the primitives at " + std::to_string(count) + " positions from " +
                                std::to_string(first) + " on, but there are " + std::to_string(size));
            return RT_FAILED;
        }
        for (uint64_t i = first; i < first + count; ++i) {
            if (!self.wanted_[i])
                self.services_.fail("the refit asked for position " + std::to_string(i) +
                                    " in leaf order, which is in a group that is not changed");
            if (self.times_[i].fetch_add(1) == 1)
                self.services_.fail("the refit asked twice for position " + std::to_string(i) + " in leaf order");
            out[i - first] = self.prims_[i];
        }
        return RT_OK;
    }
    // Which position was never asked for; nothing: each was.
    Problem missing() const {
        uint64_t count = 0, first = 0;
        for (size_t i = times_count(); i-- > 0;)
            if (wanted_[i] && times_[i] == 0) ++count, first = i;
        if (count == 0) return {};
        return "the refit never asked for " + std::to_string(count) + " positions in leaf order, the first is " +
               std::to_string(first) + ": their boxes are those of before";
    }

 private:
    size_t times_count() const { return groups_.size(); }

    HostServices& services_;
    const std::vector<rt_u32> groups_;
    std::unique_ptr<std::atomic<uint8_t>[]> times_;
    std::vector<rt_prim> prims_;
    std::vector<bool> wanted_;
    GuardedBytes leaves_;
};

}  // namespace

const rt_packed_prim& packed_of(const BuildScene& scene, rt_u32 ref) {
    const rt_u32 index = RT_REF_INDEX(ref);
    return RT_REF_KIND(ref) == RT_REF_TRIANGLE  ? scene.triangles[index]
           : RT_REF_KIND(ref) == RT_REF_SPHERE  ? scene.spheres[index]
           : RT_REF_KIND(ref) == RT_REF_POLYGON ? scene.polygons[index]
           : RT_REF_KIND(ref) == RT_REF_SHAPE   ? scene.shape_leaves[index]
                                                : scene.instance_leaves[index];
}

std::vector<rt_u32> group_of_positions(const BuildScene& scene, const BuilderResult& built) {
    std::unordered_map<rt_u32, rt_u32> group_of;
    for (rt_u32 g = 0; g < scene.groups.size(); ++g)
        for (rt_u32 i = 0; i < scene.groups[g].count; ++i) group_of[scene.prims[scene.groups[g].first + i].ref] = g;
    std::vector<rt_u32> groups;
    const auto* const refs = static_cast<const rt_u32*>(built.refs.data());
    for (uint64_t i = 0; i < built.leaf_count; ++i) {
        const auto known = group_of.find(refs[i]);
        groups.push_back(known == group_of.end() ? RT_NONE : known->second);
    }
    return groups;
}

BuilderResult copy_of(const BuilderResult& from, const rt_plugin& plugin) {
    BuilderResult copy;
    for (size_t s = 0; s < from.slots.size(); ++s) {
        BuilderResult::Slot slot;
        slot.memory = GuardedBytes(from.slots[s].memory.bytes(), std::string("slot ") + plugin.accel->slots[s].name, 128,
                                   plugin.accel->slots[s].elem_bytes);
        std::memcpy(slot.memory.data(), from.slots[s].memory.data(), from.slots[s].memory.bytes());
        slot.count = from.slots[s].count;
        slot.allocated = true;
        copy.slots.push_back(std::move(slot));
    }
    copy.refs = GuardedBytes(from.leaf_count * sizeof(rt_u32), "the leaves");
    std::memcpy(copy.refs.data(), from.refs.data(), from.leaf_count * sizeof(rt_u32));
    copy.leaf_count = from.leaf_count;
    copy.leaves_given = true;
    copy.roots = from.roots;
    copy.rooted = from.rooted;
    copy.defines = from.defines;
    copy.stats = from.stats;
    return copy;
}

RefitRun run_refit(const rt_plugin& plugin, const ParameterValues& params, const BuilderResult& built, const BuildScene& moved,
                   const std::vector<uint8_t>& changed, Schedule schedule, unsigned cancel_after) {
    RefitRun run;
    run.result = copy_of(built, plugin);
    CancelAt progress(cancel_after);
    HostServices services({}, progress);
    AskedPrims asked(moved, built, changed, services);
    const rt_host host = scheduled(*services.host(), schedule);
    std::vector<void*> slots;
    std::vector<uint64_t> counts;
    for (BuilderResult::Slot& slot : run.result.slots) {
        slots.push_back(slot.memory.data());
        counts.push_back(slot.count);
    }
    struct Costs {
        std::vector<double> of_group;
        std::atomic<bool> wrong{false};
    } costs{std::vector<double>(changed.size(), -1), {}};
    rt_refit_input input{};
    input.struct_bytes = sizeof input;
    input.group_count = static_cast<rt_u32>(changed.size());
    input.changed = changed.data();
    input.roots = run.result.roots.data();
    input.slot_counts = counts.data();
    input.leaf_count = built.leaf_count;
    input.params = params.data();
    input.ctx = &asked;
    input.prims = AskedPrims::prims;
    input.leaves = asked.leaves();
    rt_refit_output output{};
    output.struct_bytes = sizeof output;
    output.slots = slots.data();
    output.ctx = &costs;
    output.cost = [](void* ctx, rt_u32 group, double cost) {
        Costs& all = *static_cast<Costs*>(ctx);
        if (group < all.of_group.size() && cost >= 0)
            all.of_group[group] = cost;
        else
            all.wrong = true;
    };
    try {
        services.check(static_cast<int>(Exit::failed), [&] {
            const ScopedFpMode floats;
            return refit_of(plugin).refit(&host, &input, &output);
        });
    } catch (const Cancelled&) {
        run.cancelled = true;
    } catch (const Error& e) {
        run.why = e.what();
    }
    run.reports = progress.reports();
    if (run.why || run.cancelled) return run;
    run.costs = costs.of_group;
    run.why = asked.missing();
    if (const std::string overrun = overrun_of(run.result); !run.why && !overrun.empty())
        run.why = "the refit wrote beyond the end of " + overrun;
    if (!run.why && costs.wrong)
        run.why = "the refit reported a cost that is negative or no number, or of a group that is not there";
    return run;
}

}  // namespace clarity::check
