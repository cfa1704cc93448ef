// builder.hpp -- from the host's primitives to one tree per group, on all cores.
//
// Ranges of more than kTaskSize primitives are split breadth-first, all ranges of a level together, each cut into chunks that
// the threads bin and move in parallel; then every range is small enough to be one thread's task. Where chunks begin depends on
// the input only, and what threads compute is merged in the order of chunks, so the tree is the same whatever the number of
// threads.
#pragma once
#include <atomic>
#include <vector>

#include "scratch.hpp"
#include "subtree.hpp"

namespace bvh2 {

constexpr uint32_t kTaskSize = 16384;  // 0.5 MiB of records: stays in a core's own cache
constexpr uint32_t kChunkSize = 8192;

// A child of a node above the tasks: such a node, or a task.
struct TopChild {
    bool is_task = false;
    uint32_t index = 0;
};
struct TopNode {
    Box box[2];
    TopChild child[2];
    rt_u32 place = 0;  // in the finished array
};

class Builder {
 public:
    // Positions in leaf order are 28 bits, as refs are.
    static constexpr uint64_t kMaxPrimitives = RT_REF_INDEX_MAX;
    // Of memory that is given back at the end.
    static constexpr uint64_t kBytesPerPrimitive = 2 * sizeof(Record) + sizeof(bvh2_node);

    Builder(const rt_host* host, const rt_build_input& input, const Rules& rules, uint64_t primitive_count);
    void run(const rt_build_output* out);

 private:
    struct Pending {
        Range range;
        uint32_t parent;  // in top_; RT_NONE: it is the root of its group
        uint32_t which;   // child of the parent, or group
    };
    struct Chunk;
    struct Cut;

    std::vector<Pending> load();
    void split_top(std::vector<Pending> level);
    std::vector<Pending> split_level(const std::vector<Pending>& level);
    void run_tasks();
    rt_u32 place(TopChild child, rt_u32 next);
    void write_nodes(const rt_build_output* out);
    void put(const Pending& pending, TopChild child);
    void report(uint64_t work);
    template <class Body>
    void parallel_for(size_t count, Body&& body) const;

    const rt_host* const host_;
    const rt_build_input& input_;
    uint64_t primitive_count_, work_total_;
    Scratch<Record> records_[2];
    Scratch<bvh2_node> nodes_;
    Workspace workspace_;
    std::vector<TopNode> top_;
    std::vector<Range> tasks_;
    std::vector<Subtree> subtrees_;  // of tasks
    std::vector<rt_u32> task_place_;
    std::vector<TopChild> roots_;  // of groups
    std::vector<Box> boxes_;       // of groups
    std::atomic<uint64_t> work_done_{0};
};

}  // namespace bvh2
