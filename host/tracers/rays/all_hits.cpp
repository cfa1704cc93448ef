// all_hits.cpp -- all hits of rays, launch by launch.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "device/cl_errors.hpp"
#include "tracers/rays/ray_kernels.hpp"
#include "tracers/rays/ray_queries.hpp"
#include "trial/trial.hpp"

namespace clarity {
namespace {

constexpr size_t kRaysAtOnce = 65536;  // so their lists take 10 MB
constexpr size_t kListFloats = size_t(RT_LIST_FIELDS) * kHitsAtOnce;

// Where field k of a block of `fields` has the number of ray i.
size_t place(size_t i, size_t k, size_t fields, unsigned lanes) {
    return (i / lanes * fields + k) * lanes + i % lanes;
}

// The hit at `place_in_list` of ray i; prim -1: there is none.
rt_hit hit_of(const std::vector<float>& lists, size_t i, size_t place_in_list, unsigned lanes) {
    float fields[RT_LIST_FIELDS];
    for (size_t k = 0; k < RT_LIST_FIELDS; ++k)
        fields[k] = lists[place(i, place_in_list * RT_LIST_FIELDS + k, kListFloats, lanes)];
    rt_hit hit{fields[0], fields[1], fields[2], -1, -1, 0, 0, 0};
    std::memcpy(&hit.prim, fields + 3, sizeof hit.prim);
    std::memcpy(&hit.instance, fields + 4, sizeof hit.instance);
    return hit;
}

// A hit comes behind another if its t is greater, or its number at the same t.
struct Known {
    float t = -INFINITY;
    rt_i32 prim = -1;
};

std::vector<float> packed(const std::vector<Known>& after, const std::vector<size_t>& rays, size_t slots, unsigned lanes) {
    std::vector<float> floats(2 * slots);
    for (size_t i = 0; i < slots; ++i) {
        const Known& known = after[rays[std::min(i, rays.size() - 1)]];
        floats[place(i, 0, 2, lanes)] = known.t;
        std::memcpy(&floats[place(i, 1, 2, lanes)], &known.prim, sizeof known.prim);
    }
    return floats;
}

}  // namespace

std::vector<float> RayQueries::list_hits(const Prepared& prepared, const TraceProgram& program, const RayBlocks& rays,
                                         const std::vector<float>& after) {
    const Layout& layout = prepared.layout;
    Queue& queue = device_->queue();
    const auto upload = [&](GrowingBuffer& buffer, const std::vector<float>& floats) {
        const cl::Buffer& on_device = buffer.fit(device_->context(), floats.size() * sizeof(float));
        queue.enqueueWriteBuffer(on_device, CL_TRUE, 0, floats.size() * sizeof(float), floats.data());
        return on_device;
    };
    std::vector<float> lists(rays.block_count() * layout.lanes * kListFloats);
    const cl::Buffer& out = out_.fit(device_->context(), lists.size() * sizeof(float));
    KernelArguments kernel = program.kernel();
    kernel.set("rays", upload(in_, rays.floats())).set("after", upload(after_, after)).set("answers", out);
    kernel.set("blocks", cl_uint(rays.block_count()));
    const bool debug = prepared.settings.debug;
    if (debug) overflows_.clear(queue);
    overflows_.bind(kernel);
    view_.bind(*prepared.on_device, kernel);
    const unsigned in_group = layout.group_packets() * layout.blocks();
    all_hits_launcher_.run(*device_, queue, kernel, (unsigned(rays.block_count()) + in_group - 1) / in_group,
                           layout.local_size(), [] {});
    if (debug) overflowed_ += overflows_.read(queue);
    queue.enqueueReadBuffer(out, CL_TRUE, 0, lists.size() * sizeof(float), lists.data());
    return lists;
}

AllHits RayQueries::trace_all(const Prepared& prepared, const std::vector<rt_ray>& rays, AllHitsQuery query,
                              Progress& progress) {
    return wrap_cl_errors(*device_, "tracing rays for all their hits", [&] {
        AllHits all;
        all.first.push_back(0);
        overflowed_ = 0;
        if (rays.empty()) return all;
        const Layout& layout = prepared.layout;
        all_hits_launcher_.forget();
        const auto program = tried_program(programs_, prepared, all_hits(), progress);
        write_frame(prepared, query.mask);
        for (size_t begin = 0; begin < rays.size(); begin += kRaysAtOnce) {
            const size_t count = std::min(kRaysAtOnce, rays.size() - begin);
            std::vector<std::vector<rt_hit>> found(query.count_only ? 0 : count);
            std::vector<uint64_t> counts(count);
            std::vector<Known> after(count);
            std::vector<size_t> left(count);  // rays whose hits may not all be known
            std::iota(left.begin(), left.end(), size_t(0));
            while (!left.empty()) {
                if (progress.cancelled()) throw Cancelled();
                std::vector<rt_ray> asked;
                for (const size_t i : left) asked.push_back(rays[begin + i]);
                const RayBlocks blocks(asked, layout.lanes);
                const size_t slots = blocks.block_count() * layout.lanes;
                const std::vector<float> lists =
                    list_hits(prepared, *program, blocks, packed(after, left, slots, layout.lanes));
                std::vector<size_t> full;
                for (size_t k = 0; k < left.size(); ++k) {
                    const size_t i = left[k];
                    for (size_t h = 0; h < kHitsAtOnce; ++h) {
                        const rt_hit hit = hit_of(lists, k, h, layout.lanes);
                        if (hit.prim < 0) break;
                        ++counts[i];
                        if (!query.count_only) found[i].push_back(hit);
                        after[i] = {hit.t, hit.prim};
                        if (h + 1 == kHitsAtOnce) full.push_back(i);
                    }
                }
                left = std::move(full);
            }
            for (size_t i = 0; i < count; ++i) {
                all.first.push_back(all.first.back() + counts[i]);
                if (!query.count_only) all.hits.insert(all.hits.end(), found[i].begin(), found[i].end());
            }
        }
        if (!query.quiet) report_overflows(overflowed_, prepared.accel->plugin->id);
        return all;
    });
}

}  // namespace clarity
