#include "bench/cases/ray_entries.hpp"

#include "bench/cases/analysis.hpp"

namespace clarity::bench {

void add_rays(CaseState& state, Entry& entry, const Fixture::Held& held) {
    const RaySet& set = state.fixture.rays(state.definition.measure, held);
    state.rays = &set;
    const auto lanes = static_cast<unsigned>(held.prepared->settings.lanes);
    std::shared_ptr<const RayBlocks>& packed = state.packed[lanes];
    if (!packed) packed = std::make_shared<const RayBlocks>(set.rays, lanes);
    entry.once = [=, &set, blocks = packed] {
        Sample sample;
        sample.time_ms = held.queries->trace(*held.prepared, *blocks, RayQuery{set.any_hit, false, true});
        const RayTuning tuning = held.queries->tuning();
        sample.trial = tuning.trial;
        sample.settled = tuning.settled;
        sample.variant = tuning.variant;
        return sample;
    };
    entry.finish = [=, &set, &state](BenchRecord& row) {
        const auto hits = held.queries->trace(*held.prepared, set.rays, RayQuery{set.any_hit, true});
        const rt_accel& accel = *held.prepared->accel->layout->accel;
        row.analysis = analyze(set.rays, hits, lanes, accel.slot_count > 0 ? accel.slots[0].elem_bytes : 0);
        std::vector<float> distances;
        for (const rt_hit& hit : hits) distances.push_back(hit.t);
        state.agreement.check_hits(row, set, distances);
    };
    set_ray_counts(entry.row, set);
}

void set_ray_counts(BenchRecord& row, const RaySet& set) {
    (set.kind == "primary" ? row.rays_primary : set.kind == "shadow" ? row.rays_shadow : row.rays_secondary) = set.active;
}

}  // namespace clarity::bench
