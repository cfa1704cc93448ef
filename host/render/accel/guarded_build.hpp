// guarded_build.hpp -- runs a builder on memory between guard pages. For worker processes, in which a plugin may crash.
#pragma once
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "plugin/host_services.hpp"
#include "render/accel/guarded_memory.hpp"
#include "rt_plugin.h"

namespace clarity {

// The input of a builder as this process owns it.
struct BuilderInput {
    GuardedBytes prims, groups, triangles;
    std::vector<double> params;
    rt_u32 group_count = 0;
    uint64_t prim_count = 0, triangle_count = 0;

    // Copies the arrays into read-only memory.
    BuilderInput(const rt_prim* prim_array, uint64_t prims_in_all, const rt_group* group_array, rt_u32 groups_in_all,
                 const rt_packed_prim* triangle_array, uint64_t triangles_in_all, std::vector<double> values);
    // The tables that a builder gets. Valid as long as this object.
    const rt_build_input& table();

 private:
    rt_geometry geometry_{};
    rt_build_input table_{};
};

// What a builder wrote.
struct BuilderResult {
    struct Slot {
        GuardedBytes memory;
        uint64_t count = 0;
        bool allocated = false;
    };
    std::vector<Slot> slots;
    GuardedBytes refs;
    uint64_t leaf_count = 0;
    bool leaves_given = false;
    std::vector<rt_u32> roots;
    std::vector<bool> rooted;
    std::map<std::string, rt_u32> defines;
    std::vector<std::pair<std::string, double>> stats;

    // Which memory was written beyond its end; empty: none.
    std::string overrun() const;
    // How the builder broke its contract, in its terms: "never asked for the leaves"; empty: it did not. Refs are not checked.
    std::string breach(const rt_accel& accel) const;
};

// Receives what a builder writes. Thread-safe, as the functions of rt_build_output are.
class GuardedOutput {
 public:
    GuardedOutput(const rt_accel& accel, rt_u32 group_count, HostServices& services);
    GuardedOutput(const GuardedOutput&) = delete;
    GuardedOutput& operator=(const GuardedOutput&) = delete;
    const rt_build_output* table() const { return &table_; }
    BuilderResult& result() { return result_; }

 private:
    void* alloc(rt_u32 slot, uint64_t count);
    rt_u32* leaves(uint64_t count);
    void* refuse(const std::string& why);

    const rt_accel& accel_;
    const rt_u32 group_count_;
    HostServices& services_;
    std::mutex mutex_;
    rt_build_output table_{};
    BuilderResult result_;
};

}  // namespace clarity
