#include "bench/cases/build_entry.hpp"

#include <chrono>

#include "base/elapsed.hpp"

namespace clarity::bench {

void add_build(CaseState& state, Entry& entry, const rt_plugin& plugin, const Settings& settings) {
    const auto last = std::make_shared<BenchRecord>(entry.row);
    entry.once = [=, &state, &plugin] {
        const auto begin = std::chrono::steady_clock::now();
        const AccelData built =
            build_accel(*state.fixture.scene(), plugin, settings.accel_params, state.progress, state.fixture.target_of(plugin));
        describe(*last, built);
        return Sample{built.build_ms + built.pack_ms, ms_since(begin)};
    };
    entry.finish = [=](BenchRecord& row) {
        row.build_ms = last->build_ms;
        row.pack_ms = last->pack_ms;
        row.accel_bytes = last->accel_bytes;
        row.bytes_per_triangle = last->bytes_per_triangle;
        row.nodes = last->nodes;
        row.sah_cost = last->sah_cost;
    };
}

}  // namespace clarity::bench
