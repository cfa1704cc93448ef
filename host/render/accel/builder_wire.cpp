#include "render/accel/builder_wire.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "base/error.hpp"
#include "base/files/memory_file.hpp"

namespace clarity {
namespace {

struct InputHead {
    uint64_t bytes, prim_count, triangle_count;  // bytes: of the whole input, a multiple of kAlign
    uint64_t node_count, ref_count;              // of the tree to be packed; no node: there is none
    uint32_t group_count, param_count;
    rt_device device;
};
struct ResultHead {
    uint64_t leaf_count;
    uint32_t slot_count, group_count, define_count, stat_count, leaves_given, pad;
};
constexpr uint64_t kAlign = 4096;

std::string write_all(int fd, const void* data, uint64_t bytes) {
    const char* at = static_cast<const char*>(data);
    while (bytes > 0) {
        const ssize_t written = write(fd, at, std::min<uint64_t>(bytes, 1u << 30));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return std::string("shared memory: ") + std::strerror(errno);
        at += written;
        bytes -= static_cast<uint64_t>(written);
    }
    return {};
}

// A whole file in memory. No data: it is empty, or cannot be mapped.
struct Mapped {
    std::shared_ptr<const char> data;
    uint64_t bytes = 0;
};

Mapped map_whole(int fd) {
    struct stat status {};
    if (fstat(fd, &status) != 0 || status.st_size <= 0) return {};
    const auto bytes = static_cast<uint64_t>(status.st_size);
    try {
        return {map_file(fd, bytes), bytes};
    } catch (const Error&) {
        return {};
    }
}

// Takes pieces from a range of memory, and never more than there is.
class Reader {
 public:
    Reader(const char* data, uint64_t bytes) : data_(data), left_(bytes) {}
    // Returns nullptr if there are fewer bytes.
    const void* take(uint64_t bytes) {
        if (bytes > left_) {
            left_ = 0;
            failed_ = true;
            return nullptr;
        }
        const char* piece = data_;
        data_ += bytes;
        left_ -= bytes;
        return piece;
    }
    template <class T>
    T number() {
        T value{};
        if (const void* piece = take(sizeof value)) std::memcpy(&value, piece, sizeof value);
        return value;
    }
    std::string text() {
        const auto size = number<uint32_t>();
        const void* piece = take(size);
        return piece ? std::string(static_cast<const char*>(piece), size) : std::string();
    }
    bool failed() const { return failed_; }

 private:
    const char* data_;
    uint64_t left_;
    bool failed_ = false;
};

template <class T>
void put(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}
void put_text(std::string& bytes, const std::string& text) {
    put(bytes, static_cast<uint32_t>(text.size()));
    bytes += text;
}

}  // namespace

std::string write_builder_input(int fd, const rt_build_input& input, uint64_t prim_count, rt_u32 param_count,
                                const rt_topology* tree) {
    const uint64_t triangles = input.geometry ? input.geometry->triangle_count : 0;
    InputHead head{sizeof head,       prim_count,  triangles,    tree ? tree->node_count : 0, tree ? tree->ref_count : 0,
                   input.group_count, param_count, *input.device};
    struct Piece {
        const void* data;
        uint64_t bytes;
    };
    std::vector<Piece> pieces = {{input.params, param_count * sizeof(double)},
                                 {input.groups, input.group_count * sizeof(rt_group)},
                                 {input.prims, prim_count * sizeof(rt_prim)}};
    if (triangles > 0) pieces.push_back({input.geometry->triangles, triangles * sizeof(rt_packed_prim)});
    if (tree) {
        pieces.push_back({tree->nodes, tree->node_count * sizeof(rt_topology_node)});
        pieces.push_back({tree->refs, tree->ref_count * sizeof(rt_u32)});
        pieces.push_back({tree->roots, tree->group_count * sizeof(rt_u32)});
    }
    uint64_t used = sizeof head;
    for (const Piece& piece : pieces) used += piece.bytes;
    head.bytes = (used + kAlign - 1) / kAlign * kAlign;
    const std::string padding(head.bytes - used, '\0');
    pieces.push_back({padding.data(), padding.size()});
    std::string why = write_all(fd, &head, sizeof head);
    for (const Piece& piece : pieces)
        if (why.empty()) why = write_all(fd, piece.data, piece.bytes);
    return why;
}

std::string read_builder_input(int fd, std::unique_ptr<BuilderInput>& input) {
    const Mapped map = map_whole(fd);
    if (!map.data) return "the input is not there";
    Reader reader(map.data.get(), map.bytes);
    const auto head = reader.number<InputHead>();
    const auto* params = static_cast<const char*>(reader.take(head.param_count * sizeof(double)));
    const void* groups = reader.take(head.group_count * sizeof(rt_group));
    const void* prims = reader.take(head.prim_count * sizeof(rt_prim));
    const void* triangles = reader.take(head.triangle_count * sizeof(rt_packed_prim));
    const void* nodes = reader.take(head.node_count * sizeof(rt_topology_node));
    const void* refs = reader.take(head.ref_count * sizeof(rt_u32));
    const void* roots = reader.take(head.node_count > 0 ? head.group_count * sizeof(rt_u32) : 0);
    if (reader.failed()) return "the input is incomplete";
    std::vector<double> values(head.param_count);
    if (!values.empty()) std::memcpy(values.data(), params, values.size() * sizeof(double));
    input = std::make_unique<BuilderInput>(
        static_cast<const rt_prim*>(prims), head.prim_count, static_cast<const rt_group*>(groups), head.group_count,
        static_cast<const rt_packed_prim*>(triangles), head.triangle_count, std::move(values), head.device);
    if (head.node_count > 0) {
        input->set_tree({sizeof(rt_topology), head.group_count, static_cast<const rt_topology_node*>(nodes), head.node_count,
                         static_cast<const rt_u32*>(refs), head.ref_count, static_cast<const rt_u32*>(roots)});
    }
    if (lseek(fd, static_cast<off_t>(head.bytes), SEEK_SET) < 0) return std::strerror(errno);
    return {};
}

std::string write_builder_result(int fd, const BuilderResult& result) {
    std::string bytes;
    put(bytes, ResultHead{result.leaf_count, static_cast<uint32_t>(result.slots.size()),
                          static_cast<uint32_t>(result.roots.size()), static_cast<uint32_t>(result.defines.size()),
                          static_cast<uint32_t>(result.stats.size()), result.leaves_given, 0});
    for (const BuilderResult::Slot& slot : result.slots) {
        put(bytes, static_cast<uint32_t>(slot.allocated));
        put(bytes, slot.count);
    }
    for (size_t g = 0; g < result.roots.size(); ++g) {
        put(bytes, static_cast<uint32_t>(result.rooted[g]));
        put(bytes, result.roots[g]);
    }
    for (const auto& [name, value] : result.defines) {
        put_text(bytes, name);
        put(bytes, value);
    }
    for (const auto& [label, value] : result.stats) {
        put_text(bytes, label);
        put(bytes, value);
    }
    std::string why = write_all(fd, bytes.data(), bytes.size());
    for (const BuilderResult::Slot& slot : result.slots)
        if (why.empty() && slot.allocated) why = write_all(fd, slot.memory.data(), slot.memory.bytes());
    if (why.empty() && result.leaves_given) why = write_all(fd, result.refs.data(), result.refs.bytes());
    return why;
}

std::string replay_builder_result(int fd, const rt_accel& accel, rt_u32 group_count, const rt_build_output& out) {
    const Mapped map = map_whole(fd);
    const std::string incomplete = "the build worker's result is incomplete";
    if (!map.data) return incomplete;
    Reader input(map.data.get(), map.bytes);
    const auto input_head = input.number<InputHead>();
    if (input.failed() || input_head.bytes > map.bytes) return incomplete;
    Reader reader(map.data.get() + input_head.bytes, map.bytes - input_head.bytes);
    const auto head = reader.number<ResultHead>();
    if (reader.failed() || head.slot_count != accel.slot_count || head.group_count != group_count) return incomplete;
    struct Slot {
        bool allocated;
        uint64_t count;
    };
    std::vector<Slot> slots;
    for (uint32_t s = 0; s < head.slot_count; ++s) {
        const bool allocated = reader.number<uint32_t>() != 0;
        slots.push_back({allocated, reader.number<uint64_t>()});
    }
    for (uint32_t g = 0; g < head.group_count; ++g) {
        const bool rooted = reader.number<uint32_t>() != 0;
        const auto node = reader.number<uint32_t>();
        if (rooted && !reader.failed()) out.root(out.ctx, g, node);
    }
    for (uint32_t i = 0; i < head.define_count && !reader.failed(); ++i) {
        const std::string name = reader.text();
        const auto value = reader.number<uint32_t>();
        if (!reader.failed()) out.define(out.ctx, name.c_str(), value);
    }
    for (uint32_t i = 0; i < head.stat_count && !reader.failed(); ++i) {
        const std::string label = reader.text();
        const auto value = reader.number<double>();
        if (!reader.failed()) out.stat(out.ctx, label.c_str(), value);
    }
    // Counts are compared with the bytes that are there before memory is asked for.
    for (uint32_t s = 0; s < head.slot_count; ++s) {
        if (!slots[s].allocated) continue;
        if (slots[s].count > map.bytes / accel.slots[s].elem_bytes) return incomplete;
        const void* content = reader.take(slots[s].count * accel.slots[s].elem_bytes);
        if (!content) return incomplete;
        void* memory = out.alloc(out.ctx, s, slots[s].count);
        if (!memory) return "no memory for a slot";
        std::memcpy(memory, content, slots[s].count * accel.slots[s].elem_bytes);
    }
    if (head.leaves_given != 0) {
        if (head.leaf_count > map.bytes / sizeof(rt_u32)) return incomplete;
        const void* content = reader.take(head.leaf_count * sizeof(rt_u32));
        if (!content) return incomplete;
        rt_u32* refs = out.leaves(out.ctx, head.leaf_count);
        if (!refs) return "no memory for the leaves";
        std::memcpy(refs, content, head.leaf_count * sizeof(rt_u32));
    }
    return reader.failed() ? incomplete : "";
}

}  // namespace clarity
