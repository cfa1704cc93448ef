// Layout: a Header, then sections at multiples of 64 bytes. Each section is the array of one member of Scene, in the order of
// `visit`. Elements with a name are split: their plain data, with the length of the name, is in a section of their kind; all
// names, one after the other, are in the last section.
#include "import/wire.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <type_traits>

namespace clarity::import {
namespace {

constexpr uint64_t kMagic = 0x31656E6563536C43;  // "ClScene1"
constexpr uint32_t kSectionCount = 47;
constexpr uint64_t kPieceAlignment = 64;
// Writing is not sealed, because the reader gives pages back behind its reading, which counts as writing. The reader copies
// each byte once and checks the copy, so that what is written later does nothing.
constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW;

struct Section {
    uint64_t offset, bytes;
};
struct Header {
    uint64_t magic, total_bytes;
    Section sections[kSectionCount];
};
struct WireGlobals {
    std::array<float, 3> background, ambient;
    uint32_t up_axis, pad;
    double unit_scale;
};
struct WireMesh {
    uint32_t name_bytes, first_vertex, vertex_count, first_triangle, triangle_count, polygon_count;
};
struct WireInstance {
    uint32_t name_bytes, mesh, material, visible, node, root, moving_mesh;
    Affine world_from_object, node_from_object;
};
struct WireMaterial {
    uint32_t name_bytes;
    rt_material values;
};
struct WireLight {
    uint32_t name_bytes, node;
    rt_light values;
    std::array<float, 3> at_node;
};
struct WireCamera {
    uint32_t name_bytes, node;
    std::array<float, 3> eye, target, up, node_eye, node_target, node_up;
    float fov_y_rad;
};
struct WireNode {
    uint32_t name_bytes, pad;
    rt_node_desc values;  // its name is NULL
};
struct WireClip {
    uint32_t name_bytes, rig, first_layer, layer_count;
    double begin_s, end_s, fps;
};
struct WireSequence {
    uint32_t name_bytes, first_mesh, mesh_count, first_number, number_count, pad;
    double fps;
};
struct WireMorph {
    uint32_t name_bytes, mesh, first_target, target_count;
    double weight;
};

// The members of Scene which are not plain arrays, converted to plain arrays.
struct Converted {
    std::vector<WireGlobals> globals;
    std::vector<WireMesh> meshes;
    std::vector<WireInstance> instances;
    std::vector<WireMaterial> materials;
    std::vector<WireLight> lights;
    std::vector<WireCamera> cameras;
    std::vector<WireNode> nodes;
    std::vector<WireClip> clips;
    std::vector<WireMorph> morphs;
    std::vector<WireSequence> sequences;
    std::vector<uint32_t> shape_kinds, warnings, edits, sources;  // length of each text in `names`, in bytes
    std::vector<char> names;
};

// Writing and reading use the same list of sections, so that they always agree.
template <class S, class C, class Visitor>
void visit(S& s, C& c, Visitor&& v) {
    v(c.globals), v(s.positions), v(s.normals), v(s.uvs), v(s.triangles), v(s.triangle_materials), v(c.meshes), v(c.instances);
    v(s.spheres), v(s.planes), v(s.polygons), v(s.polygon_corners), v(c.shape_kinds), v(s.shapes), v(s.shape_parts);
    v(s.shape_numbers), v(c.materials), v(s.textures), v(s.texels), v(c.lights);
    v(c.cameras), v(c.nodes), v(c.clips), v(c.morphs);
    auto& m = s.motion;
    v(m.layers), v(m.channels), v(m.key_times), v(m.key_values), v(m.key_handles), v(m.key_spans), v(m.skins), v(m.bones);
    v(m.weights), v(m.shares), v(m.morph_targets), v(m.morph_vertices), v(m.morph_positions), v(m.morph_normals), v(m.frames);
    v(m.frame_times), v(m.frame_positions), v(m.sequence_numbers), v(c.sequences), v(c.warnings), v(c.edits), v(c.sources),
        v(c.names);
}

Converted convert(const Scene& s) {
    Converted c;
    const auto name = [&](const std::string& text) {
        c.names.insert(c.names.end(), text.begin(), text.end());
        return static_cast<uint32_t>(text.size());
    };
    c.globals.push_back({s.background, s.ambient, s.up_axis, 0, s.unit_scale});
    for (const Mesh& m : s.meshes) {
        c.meshes.push_back({name(m.name), m.first_vertex, m.vertex_count, m.first_triangle, m.triangle_count, m.polygon_count});
    }
    for (const Instance& i : s.instances)
        c.instances.push_back({name(i.name), i.mesh, i.material, i.visible, i.node, i.root, i.moving_mesh, i.world_from_object,
                               i.node_from_object});
    for (const ShapeKind& kind : s.shape_kinds) c.shape_kinds.push_back(name(kind.id));
    for (const Material& m : s.materials) c.materials.push_back({name(m.name), m.values});
    for (const Light& l : s.lights) c.lights.push_back({name(l.name), l.node, l.values, l.at_node});
    for (const Camera& k : s.cameras)
        c.cameras.push_back({name(k.name), k.node, k.eye, k.target, k.up, k.node_eye, k.node_target, k.node_up, k.fov_y_rad});
    for (const Node& n : s.motion.nodes) c.nodes.push_back({name(n.name), 0, n.values});
    for (const Clip& k : s.motion.clips)
        c.clips.push_back({name(k.name), k.rig, k.first_layer, k.layer_count, k.begin_s, k.end_s, k.fps});
    for (const Morph& m : s.motion.morphs) c.morphs.push_back({name(m.name), m.mesh, m.first_target, m.target_count, m.weight});
    for (const FileSequence& q : s.motion.sequences)
        c.sequences.push_back({name(q.pattern), q.first_mesh, q.mesh_count, q.first_number, q.number_count, 0, q.fps});
    for (const std::string& warning : s.warnings) c.warnings.push_back(name(warning));
    for (const SceneEdit& edit : s.edits)
        for (const std::string* text : {&edit.key, &edit.value, &edit.where}) c.edits.push_back(name(*text));
    for (const std::string& source : s.sources) c.sources.push_back(name(source));
    return c;
}

// Converts back to a Scene. Returns false if the names do not match their lengths.
bool convert_back(const Converted& c, Scene& s) {
    size_t at = 0;
    bool good = c.globals.size() == 1;
    const auto name = [&](uint32_t bytes) {
        good = good && bytes <= c.names.size() - at;
        if (!good) return std::string();
        at += bytes;
        return std::string(c.names.data() + at - bytes, bytes);
    };
    if (!good) return false;
    const WireGlobals& g = c.globals.front();
    s.background = g.background;
    s.ambient = g.ambient;
    s.up_axis = g.up_axis;
    s.unit_scale = g.unit_scale;
    for (const WireMesh& m : c.meshes) {
        s.meshes.push_back(
            {name(m.name_bytes), m.first_vertex, m.vertex_count, m.first_triangle, m.triangle_count, m.polygon_count});
    }
    for (const WireInstance& i : c.instances)
        s.instances.push_back({name(i.name_bytes), i.mesh, i.material, i.world_from_object, i.visible != 0, i.node, i.root,
                               i.moving_mesh, i.node_from_object});
    for (const uint32_t bytes : c.shape_kinds) s.shape_kinds.push_back({name(bytes), nullptr});
    for (const WireMaterial& m : c.materials) s.materials.push_back({name(m.name_bytes), m.values});
    for (const WireLight& l : c.lights) s.lights.push_back({name(l.name_bytes), l.values, l.node, l.at_node, 0});
    for (const WireCamera& k : c.cameras)
        s.cameras.push_back(
            {name(k.name_bytes), k.eye, k.target, k.up, k.fov_y_rad, k.node, k.node_eye, k.node_target, k.node_up, 0});
    for (const WireNode& n : c.nodes) {
        s.motion.nodes.push_back({name(n.name_bytes), n.values});
        s.motion.nodes.back().values.name = nullptr;
    }
    for (const WireClip& k : c.clips)
        s.motion.clips.push_back({name(k.name_bytes), k.rig, k.first_layer, k.layer_count, k.begin_s, k.end_s, k.fps});
    for (const WireMorph& m : c.morphs)
        s.motion.morphs.push_back({name(m.name_bytes), m.mesh, m.first_target, m.target_count, m.weight});
    for (const WireSequence& q : c.sequences)
        s.motion.sequences.push_back({name(q.name_bytes), q.first_mesh, q.mesh_count, q.first_number, q.number_count, q.fps});
    for (const uint32_t bytes : c.warnings) s.warnings.push_back(name(bytes));
    good = good && c.edits.size() % 3 == 0;
    for (size_t i = 0; good && i < c.edits.size(); i += 3) {
        SceneEdit edit;
        edit.key = name(c.edits[i]);
        edit.value = name(c.edits[i + 1]);
        edit.where = name(c.edits[i + 2]);
        s.edits.push_back(std::move(edit));
    }
    for (const uint32_t bytes : c.sources) s.sources.push_back(name(bytes));
    return good && at == c.names.size();
}

// Bytes that both processes hold at the same time while an array goes from one to the other.
constexpr uint64_t kBytesAtOnce = uint64_t(4) << 20;
// Bytes that are copied out of the file at once: they stay in the processor's cache until they are in their array.
constexpr uint64_t kCopiedAtOnce = uint64_t(256) << 10;

// The whole pages within a range of addresses or offsets.
template <class Body>
void for_whole_pages(uint64_t first, uint64_t end, const Body& body) {
    static const uint64_t page = static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
    first = (first + page - 1) / page * page;
    end = end / page * page;
    if (first < end) body(first, end - first);
}

// Appends all bytes to the file. write() may stop early. Returns an empty text on success, otherwise the reason.
std::string append(int fd, const char* from, uint64_t bytes) {
    while (bytes > 0) {
        const ssize_t written = write(fd, from, bytes);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return std::string("cannot write the scene into shared memory: ") + std::strerror(errno);
        from += written;
        bytes -= static_cast<uint64_t>(written);
    }
    return {};
}

// Appends an array to the file, and gives its memory back to the system behind the writing: afterwards its elements are lost.
template <class T>
std::string move_to_file(int fd, std::vector<T>& array) {
    std::string why;
    auto* const bytes = reinterpret_cast<char*>(array.data());
    const uint64_t size = array.size() * sizeof(T);
    for (uint64_t at = 0; at < size && why.empty(); at += kBytesAtOnce) {
        const uint64_t piece = std::min(kBytesAtOnce, size - at);
        why = append(fd, bytes + at, piece);
        const uint64_t address = reinterpret_cast<uintptr_t>(bytes) + at;
        for_whole_pages(address, address + piece, [](uint64_t first, uint64_t length) {
            madvise(reinterpret_cast<void*>(first), length, MADV_DONTNEED);
        });
    }
    std::vector<T>().swap(array);
    return why;
}

template <class T>
std::string move_to_file(int fd, SharedArray<T>& array) {
    std::string why = move_to_file(fd, array.own());
    array.clear();
    return why;
}

// Reserves memory and asks for large pages where it spans some, because half of the reading time is spent on page faults.
template <class T>
void reserve_on_large_pages(std::vector<T>& array, size_t count) {
    constexpr uintptr_t kLargePage = 2u << 20;
    array.reserve(count);
    const uintptr_t first = (reinterpret_cast<uintptr_t>(array.data()) + kLargePage - 1) / kLargePage * kLargePage;
    const uintptr_t last = reinterpret_cast<uintptr_t>(array.data() + count) / kLargePage * kLargePage;
    if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
}

// Copies bytes out of the file. Returns false if they are not all there.
bool copy_from_file(int fd, uint64_t offset, void* to, uint64_t bytes) {
    auto* at = static_cast<char*>(to);
    while (bytes > 0) {
        const ssize_t count = pread(fd, at, bytes, static_cast<off_t>(offset));
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        at += count;
        offset += static_cast<uint64_t>(count);
        bytes -= static_cast<uint64_t>(count);
    }
    return true;
}

// Copies a section of the file into an array, and gives the file's memory back to the system behind the reading.
template <class T>
bool move_from_file(int fd, const Section& section, std::vector<char>& buffer, std::vector<T>& array) {
    reserve_on_large_pages(array, section.bytes / sizeof(T));
    buffer.resize(std::max<uint64_t>(1, kCopiedAtOnce / sizeof(T)) * sizeof(T));
    uint64_t given_back = section.offset;
    for (uint64_t done = 0; done < section.bytes;) {
        const uint64_t piece = std::min<uint64_t>(buffer.size(), section.bytes - done);
        if (!copy_from_file(fd, section.offset + done, buffer.data(), piece)) return false;
        const auto* first = reinterpret_cast<const T*>(buffer.data());
        array.insert(array.end(), first, first + piece / sizeof(T));
        done += piece;
        const uint64_t read_up_to = section.offset + done;
        if (read_up_to - given_back < kBytesAtOnce && done < section.bytes) continue;
        for_whole_pages(given_back, read_up_to, [&](uint64_t from, uint64_t length) {
            fallocate(fd, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(from), static_cast<off_t>(length));
        });
        given_back = read_up_to;
    }
    return true;
}

template <class T>
bool move_from_file(int fd, const Section& section, std::vector<char>& buffer, SharedArray<T>& array) {
    return move_from_file(fd, section, buffer, array.own());
}

}  // namespace

std::string write_scene(int fd, Scene scene) {
    Converted converted = convert(scene);
    Header header{};
    header.magic = kMagic;
    uint64_t offset = sizeof header;
    uint32_t section = 0;
    const auto padding = [&] { return (kPieceAlignment - offset % kPieceAlignment) % kPieceAlignment; };
    visit(scene, converted, [&](const auto& array) {
        using Element = typename std::decay_t<decltype(array)>::value_type;
        static_assert(std::is_trivially_copyable_v<Element>, "only plain data goes through shared memory");
        offset += padding();
        header.sections[section++] = {offset, array.size() * sizeof(Element)};
        offset += array.size() * sizeof(Element);
    });
    header.total_bytes = offset;
    std::string why = append(fd, reinterpret_cast<const char*>(&header), sizeof header);
    offset = sizeof header;
    section = 0;
    visit(scene, converted, [&](auto& array) {
        static const char zeros[kPieceAlignment] = {};
        if (why.empty()) why = append(fd, zeros, padding());
        if (why.empty()) why = move_to_file(fd, array);
        offset = header.sections[section].offset + header.sections[section].bytes;
        ++section;
    });
    if (!why.empty()) return why;
    if (fcntl(fd, F_ADD_SEALS, kSeals) != 0) return std::string("cannot seal the shared memory: ") + std::strerror(errno);
    return {};
}

std::string read_scene(int fd, Scene& scene) {
    struct stat status {};
    if (fstat(fd, &status) != 0) return std::strerror(errno);
    const uint64_t size = static_cast<uint64_t>(status.st_size);
    const int seals = fcntl(fd, F_GET_SEALS);
    if (seals < 0 || (seals & kSeals) != kSeals) return "the shared memory is not sealed";
    if (size < sizeof(Header)) return "the shared memory holds " + std::to_string(size) + " bytes, less than its header";
    constexpr const char* unreadable = "the shared memory cannot be read";
    Header header;
    if (!copy_from_file(fd, 0, &header, sizeof header)) return unreadable;
    if (header.magic != kMagic) return "the shared memory holds no scene";
    if (header.total_bytes != size) return "the shared memory's size is not the one in its header";

    Converted converted;
    uint32_t section = 0;
    std::vector<char> buffer;
    std::string why;
    visit(scene, converted, [&](auto& array) {
        using Element = typename std::decay_t<decltype(array)>::value_type;
        const Section& s = header.sections[section++];
        if (s.offset % kPieceAlignment != 0 || s.offset > size || s.bytes > size - s.offset || s.bytes % sizeof(Element) != 0) {
            why = "section " + std::to_string(section - 1) + " of the shared memory is out of range";
        }
        if (why.empty() && !move_from_file(fd, s, buffer, array)) why = unreadable;
    });
    if (why.empty() && !convert_back(converted, scene)) why = "the names in the shared memory do not match their lengths";
    return why;
}

}  // namespace clarity::import
