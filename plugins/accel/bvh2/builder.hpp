// builder.hpp -- from the host's primitives to one binary tree per group, on all cores.
//
// Large ranges are split breadth-first, all ranges of a level together, each cut into chunks that the threads bin and move in
// parallel; then every range is small enough to be one thread's task. Where chunks begin depends on the input only, and what
// threads compute is merged in the order of chunks, so the tree is the same whatever the number of threads.
#pragma once
#include <atomic>
#include <functional>
#include <vector>

#include "kernels.hpp"
#include "morton.hpp"
#include "rt_plugin.hpp"
#include "scratch.hpp"
#include "spatial.hpp"

namespace bvh2 {

// A range that one thread builds, and its tree, whose nodes begin at first_node.
struct Task {
    Range range;
    uint32_t first_node;
    float scale;  // half a length times this is that length where the longest side of the group's box is 1
    Subtree tree;
};
// A node above the tasks.
struct Top {
    rt_u32 node;
    float scale;
};
// The tree of a group: a node or a leaf; RT_NONE: the group is empty.
struct Root {
    Bounds box;
    rt_u32 code = RT_NONE;
};
// A finished tree, in the builder's own places: see Workspace::nodes. Codes of children name these.
struct BinaryTree {
    const bvh2_node* nodes;
    std::vector<Task> tasks;
    std::vector<Top> tops;    // parents before children
    std::vector<Root> roots;  // of groups
    uint64_t leaf_count = 0;  // refs in leaf order
    uint32_t depth = 1;       // nodes from a root to the deepest leaf
};

// By which half a length becomes that length where the longest side of a group's box is 1.
float unit_scale(const Bounds& box);

class Builder {
 public:
    // Positions in leaf order are 28 bits, as refs are.
    static constexpr uint64_t kMaxPrimitives = RT_REF_INDEX_MAX;
    // Of memory that is given back at the end, at most.
    static uint64_t bytes(const Rules& rules, uint64_t primitive_count);

    // Progress goes from 0 to `share`. The tree lives as long as this does.
    Builder(const rt_host* host, const rt_build_input& input, const Rules& rules, uint64_t primitive_count, float share);
    // Writes the leaf order. `after` is called for each task when it is done, by the thread that built it, whose caches hold
    // it.
    BinaryTree run(const rt_build_output* out, const std::function<void(const Task&)>& after);
    const Workspace& workspace() const { return workspace_; }

 private:
    // A range that is not yet split, and where the code of its tree goes.
    struct Pending {
        Range range;
        uint32_t parent;  // node; RT_NONE: it is the root of its group
        uint32_t which;   // child of the parent, or group
        uint32_t group;
        uint32_t room_begin, room_end;  // see RoomyRange
    };
    struct Chunk;
    struct Cut;

    std::vector<Pending> load();
    void add_task(const Pending& pending);
    // What is small enough becomes a task; returns the rest.
    std::vector<Pending> part_tasks(const std::vector<Pending>& level);
    void split_top(std::vector<Pending> level);
    std::vector<Pending> split_level(const std::vector<Pending>& level);
    void build_sorted(const std::function<void(const Task&)>& after);
    void split_space(std::vector<Pending> level, const rt_build_output* out);
    void close_gaps(const std::vector<uint32_t>& counts, const rt_build_output* out);
    void run_tasks(const std::function<void(uint32_t)>& run_task);
    void put(const Pending& pending, rt_u32 code);
    void report(uint64_t work);
    template <class Body>
    void parallel_for(size_t count, Body&& body) const {
        rt::parallel_for(host_, static_cast<rt_u32>(count), std::forward<Body>(body));
    }
    static uint64_t room(const Rules& rules, uint64_t primitive_count);

    const rt_host* const host_;
    const rt_build_input& input_;
    const uint64_t primitive_count_, room_, work_total_;
    const float share_;
    const uint32_t task_size_, chunk_size_;
    const Kernels& kernels_;
    Scratch<Record> records_[2];
    Scratch<bvh2_node> nodes_;
    Workspace workspace_;
    BinaryTree tree_;
    std::vector<Pending> task_place_;  // of tasks, without their ranges
    std::vector<float> scales_;        // of groups
    std::atomic<uint64_t> work_done_{0};
};

}  // namespace bvh2
