// harness.hpp -- runs the builder of an acceleration structure as the host does, but without a device: it loads the library,
// passes it primitives in groups, and keeps the results.
#pragma once
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "rt_plugin.h"

namespace accel_test {

// Loads the library of a plugin of this build. Throws std::runtime_error with the loader's reason.
const rt_plugin& load(const std::string& id, const std::string& file = {});

// The input of a builder. Group 0 always exists.
struct Input {
    std::vector<rt_prim> prims;
    std::vector<rt_group> groups;
    std::vector<rt_packed_prim> triangles;  // by the index of the ref, for builders that cut them; may be empty
    void add_group(const std::vector<rt_prim>& more);
};
Input one_group(const std::vector<rt_prim>& prims);
// Makes each ref the primitive's number.
void number(Input& input);

// The results of a builder.
struct Built {
    int32_t status = RT_OK;
    std::string why;
    std::vector<std::vector<char>> storage;  // over-allocated, see slot()
    std::vector<const void*> slots;
    std::vector<uint64_t> slot_counts;
    std::vector<rt_u32> leaves, roots;
    bool allocated_twice = false;
    std::map<std::string, rt_u32> defines;
    std::map<std::string, double> stats;

    template <class T>
    const T* slot(size_t i = 0) const {
        return static_cast<const T*>(slots[i]);
    }
    rt_built view() const;
};

struct Options {
    std::map<std::string, double> params;  // parameters that are not listed have their defaults; an unknown key throws
    unsigned threads = 2;                  // number of threads of parallel_for
    std::function<bool(float)> progress;   // returns false to cancel
};

Built build(const rt_plugin& plugin, const Input& input, const Options& options = {});
// Whether two builds of a plugin wrote the same bytes and numbers.
bool same_tree(const rt_plugin& plugin, const Built& a, const Built& b);

// One of the volumes of a level.
struct Volume {
    float lo[3], hi[3];            // for a box
    float center[3], radius = -1;  // for a sphere, if radius >= 0
    float halves[9];               // for an oriented box, with `center`, if not all of them 0
};
std::vector<Volume> volumes(const rt_plugin& plugin, const Built& built, rt_u32 group, rt_u32 level);

// ---- primitives for tests

rt_prim box_prim(const float lo[3], const float hi[3], rt_u32 ref, rt_u32 mesh = 0);
rt_prim cube(float x, float y, float z, float size, rt_u32 ref);
// Calls make_one(0), make_one(1), ...
template <class Make>
std::vector<rt_prim> make(uint32_t count, Make make_one) {
    std::vector<rt_prim> prims;
    for (uint32_t i = 0; i < count; ++i) prims.push_back(make_one(i));
    return prims;
}
// Returns the boxes of about `count` triangles of a bumpy sphere. Fills `corners` (9 floats per triangle) unless it is null.
std::vector<rt_prim> bumpy_sphere(uint32_t count, std::vector<float>* corners = nullptr);
// Returns small boxes that are spread over a cube with the given size and centre.
std::vector<rt_prim> scattered(uint32_t count, float size, float center, unsigned seed);

}  // namespace accel_test
