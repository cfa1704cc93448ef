#include "moving/on_host/host_mover.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/parallel_for.hpp"
#include "base/scoped_fp_mode.hpp"
#include "plugin/capabilities.hpp"
#include "plugin/host_services.hpp"

namespace clarity {
namespace {

constexpr uint32_t kVerticesPerTask = 1u << 13, kInstancesPerTask = 1u << 9;
constexpr size_t kKeptStructures = 3;  // structures

template <class Body>
void each_chunk(size_t count, uint32_t size, Body&& body) {
    parallel_for(static_cast<uint32_t>((count + size - 1) / size),
                 [&](uint32_t c) { body(size_t{size} * c, std::min(count, size_t{size} * (c + 1))); });
}

AlignedBytes copy_of(const AlignedBytes& from) {
    AlignedBytes copy(from.bytes(), false);
    const auto* in = static_cast<const char*>(from.data());
    auto* const out = static_cast<char*>(copy.data());
    constexpr size_t kPiece = size_t{1} << 20;
    parallel_for(static_cast<uint32_t>((from.bytes() + kPiece - 1) / kPiece), [&](uint32_t i) {
        const size_t at = i * kPiece;
        std::memcpy(out + at, in + at, std::min(kPiece, from.bytes() - at));
    });
    return copy;
}

}  // namespace

// A structure, and the moves that its groups have followed.
struct HostMover::Buffer {
    std::shared_ptr<AccelData> accel;
    std::vector<uint64_t> version;   // of each group; 0: unknown
    uint64_t instances_version = 0;  // the move whose transforms it has
};

HostMover::HostMover(std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built)
    : scene_(std::move(scene)), built_(std::move(built)), plugin_(refit_of(*built_->layout)) {
    if (!plugin_.refit) cannot_ = std::string("accel ") + built_->layout->id + " does not offer `refit`";
    find_flat_instances();
}
HostMover::~HostMover() = default;

// The vertices of a mesh are kept once, in the space of its only tree. So a mesh that is flattened must be placed once. An
// instance without volume, which is always flattened, may break that.
void HostMover::find_flat_instances() {
    const BuildScene& build = built_->scene;
    flat_instance_.assign(scene_->meshes.size(), RT_NONE);
    for (rt_u32 i = 0; i < scene_->instances.size(); ++i) {
        const Instance& instance = scene_->instances[i];
        if (!instance.visible || build.number_of_instance[i] != RT_NONE) continue;
        rt_u32& flat = flat_instance_[instance.mesh];
        if (!cannot_ && (flat != RT_NONE || build.group_of_mesh[instance.mesh] != 0))
            cannot_ = name_of(instance, i) + " has no volume, and its mesh is placed elsewhere, too";
        flat = i;
    }
}

// Sets everything up for the pose of the scene, and refits all of it once, to know the costs of the build.
void HostMover::start(Progress& progress) {
    const BuildScene& build = built_->scene;
    const auto group_count = build.groups.size();
    params_ = built_->layout == built_->plugin ? built_->params : default_parameters(*built_->layout);
    groups_ = std::make_unique<const GroupOfRef>(build);
    corners_ = corners_in_leaf_order(*scene_, *built_);
    primitives_of_group_.assign(group_count, 0);
    const auto* const leaves = static_cast<const rt_packed_prim*>(built_->leaves.data());
    rt_u32 group = 0, first = 0, count = 0;
    for (uint64_t i = 0; i < built_->leaf_count; ++i) {
        if (leaves[i].ref - first >= count) group = groups_->find(leaves[i].ref, first, count);
        ++primitives_of_group_[group];
    }

    instances_ = pose_at_rest(*scene_).instances;
    object_from_world_.assign(build.instances.size(), kIdentity);
    world_from_object_ = build.world_from_object;
    hidden_.assign(build.instances.size(), 0);
    for (size_t i = 0; i < scene_->instances.size(); ++i) {
        const rt_u32 number = build.number_of_instance[i];
        if (number == RT_NONE) continue;
        std::copy_n(build.instances[number].object_from_world, 12, object_from_world_[number].begin());
        hidden_[number] = build.instances[number].hidden;
    }
    positions_.resize(scene_->positions.size() + 1);
    positions_.back() = 0;
    for (rt_u32 m = 0; m < scene_->meshes.size(); ++m) {
        const rt_u32 flat = flat_instance_[m];
        transform_vertices(m, vertices_at_rest(m), flat == RT_NONE ? nullptr : &instances_[flat].world_from_object);
    }
    is_deformed_.assign(scene_->meshes.size(), 0);
    boxes_.assign(group_count, {});
    cost_.assign(group_count, 0);
    version_.assign(group_count, ++moves_);
    refit_into_spare(progress);
    built_cost_ = cost_;
    started_ = true;
}

// Writes the vertices of a mesh. world: nullptr: they stay where they are.
void HostMover::transform_vertices(rt_u32 mesh, const float* object, const Affine* world) {
    const Mesh& range = scene_->meshes[mesh];
    float* const out = positions_.data() + 3 * size_t(range.first_vertex);
    const bool moves = world && *world != kIdentity;
    each_chunk(range.vertex_count, kVerticesPerTask, [&](size_t begin, size_t end) {
        if (!moves) {
            std::copy(object + 3 * begin, object + 3 * end, out + 3 * begin);
            return;
        }
        for (size_t v = begin; v < end; ++v) {
            const auto p = transform_point(*world, object + 3 * v);
            std::copy(p.begin(), p.end(), out + 3 * v);
        }
    });
}

float* HostMover::vertices(rt_u32 mesh) {
    if (!started_ || mesh >= flat_instance_.size()) return nullptr;
    const rt_u32 flat = flat_instance_[mesh];
    if (flat == RT_NONE ? built_->scene.group_of_mesh[mesh] == 0 : instances_[flat].world_from_object != kIdentity)
        return nullptr;
    return positions_.data() + 3 * size_t(scene_->meshes[mesh].first_vertex);
}

void HostMover::touch(rt_u32 mesh) {
    if (flat_instance_[mesh] == RT_NONE && built_->scene.group_of_mesh[mesh] == 0) return;
    version_[built_->scene.group_of_mesh[mesh]] = moves_ + 1;
    is_deformed_[mesh] = 1;
}

// Takes over a pose. Returns why a build is needed; nothing is changed then.
Problem HostMover::place(const Pose& pose) {
    const BuildScene& build = built_->scene;
    find_moved_instances(*scene_, build, instances_, pose, moved_);
    if (moved_.why.empty()) moved_.why = wrong_vertices(*scene_, pose).text();
    if (!moved_.why.empty()) return moved_.why;

    is_posed_.assign(scene_->meshes.size(), 0);
    for (const PosedMesh& mesh : pose.meshes) is_posed_[mesh.mesh] = 1;
    for (size_t k = 0; k < moved_.numbers.size(); ++k) {
        const rt_u32 i = moved_.numbers[k], mesh = instances_[i].mesh, number = build.number_of_instance[i];
        const bool was_visible = instances_[i].visible, visible = pose.instances[i].visible;
        instances_[i].world_from_object = pose.instances[i].world_from_object;
        instances_[i].visible = visible;
        if ((!visible && !was_visible) || scene_->meshes[mesh].triangle_count == 0) continue;
        version_[0] = moves_ + 1;
        if (number != RT_NONE) {
            hidden_[number] = hidden_from(scene_->instances[i], visible);
            if (!visible) continue;  // its box stays where it was
            world_from_object_[number] = instances_[i].world_from_object;
            object_from_world_[number] = moved_.inverses[k];
        } else if (!is_posed_[mesh]) {
            transform_vertices(mesh, vertices_at_rest(mesh), &instances_[i].world_from_object);
        }
    }
    for (const PosedMesh& mesh : pose.meshes) set_vertices(mesh.mesh, mesh.positions.data());
    for (rt_u32 m = 0; m < is_deformed_.size(); ++m)
        if (is_deformed_[m] && !is_posed_[m]) set_vertices(m, vertices_at_rest(m));
    is_deformed_ = is_posed_;
    return {};
}

const float* HostMover::vertices_at_rest(rt_u32 mesh) const {
    return scene_->positions.data() + 3 * size_t(scene_->meshes[mesh].first_vertex);
}

// Takes over the vertices of a mesh, if they differ from those that are there.
void HostMover::set_vertices(rt_u32 mesh, const float* object) {
    const rt_u32 flat = flat_instance_[mesh], group = built_->scene.group_of_mesh[mesh];
    if (flat == RT_NONE && group == 0) return;
    const Affine* const world = flat == RT_NONE ? nullptr : &instances_[flat].world_from_object;
    if (!world || *world == kIdentity) {
        const float* const now = positions_.data() + 3 * size_t(scene_->meshes[mesh].first_vertex);
        std::atomic<bool> same{true};
        each_chunk(scene_->meshes[mesh].vertex_count, kVerticesPerTask, [&](size_t begin, size_t end) {
            if (same && std::memcmp(now + 3 * begin, object + 3 * begin, 3 * (end - begin) * sizeof(float)) != 0) same = false;
        });
        if (same) return;
    }
    transform_vertices(mesh, object, world);
    version_[group] = moves_ + 1;
}

// A structure that nobody else holds: the one that lags behind least.
HostMover::Buffer& HostMover::spare() {
    Buffer* best = nullptr;
    for (const auto& buffer : buffers_)
        if (buffer->accel.use_count() == 1 && (!best || buffer->instances_version > best->instances_version))
            best = buffer.get();
    if (best) {
        // The last other owner may have let go of it on another thread: what it read comes before what is written here.
        std::atomic_thread_fence(std::memory_order_acquire);
        return *best;
    }
    if (buffers_.size() == kKeptStructures) buffers_.erase(buffers_.begin());
    auto buffer = std::make_unique<Buffer>();
    buffer->accel =
        std::make_shared<AccelData>(clarity::copy_of(*built_, [](const AlignedBytes& memory) { return copy_of(memory); }));
    buffer->version.assign(built_->scene.groups.size(), 0);
    buffers_.push_back(std::move(buffer));
    return *buffers_.back();
}

// Writes transforms and boxes of the instances.
void HostMover::place_instances(AccelData& accel) {
    BuildScene& scene = accel.scene;
    each_chunk(scene.instances.size(), kInstancesPerTask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const rt_u32 group = scene.group_of_instance[i];
            const Affine &world = world_from_object_[i], &object = object_from_world_[i];
            const rt_prim box = box_of_instance(boxes_[group], world, object, static_cast<rt_u32>(i));
            std::copy_n(box.lo, 3, scene.instance_leaves[i].a);
            std::copy_n(box.hi, 3, scene.instance_leaves[i].b);
            scene.world_from_object[i] = world;
            std::copy(object.begin(), object.end(), scene.instances[i].object_from_world);
            std::copy(object.begin(), object.end(), accel.instances[i].object_from_world);
            scene.instances[i].hidden = accel.instances[i].hidden = hidden_[i];
        }
    });
}

// Calls the plugin for some groups.
void HostMover::call(Buffer& buffer, const std::vector<uint8_t>& changed, Progress& progress, MovedStructure& result) {
    AccelData& accel = *buffer.accel;
    uint64_t expected = 0;
    for (size_t g = 0; g < changed.size(); ++g) {
        if (!changed[g]) continue;
        expected += primitives_of_group_[g];
        boxes_[g] = {};
        cost_[g] = 0;
        buffer.version[g] = 0;
    }
    std::vector<void*> slots;
    std::vector<uint64_t> counts;
    for (AccelData::Slot& slot : accel.slots) {
        slots.push_back(slot.memory.data());
        counts.push_back(slot.count);
    }
    LeafPacker leaves(accel, corners_, positions_.data(), *groups_, boxes_);
    rt_refit_input input{};
    input.struct_bytes = sizeof input;
    input.group_count = static_cast<rt_u32>(changed.size());
    input.changed = changed.data();
    input.roots = accel.roots.data();
    input.slot_counts = counts.data();
    input.leaf_count = accel.leaf_count;
    input.params = params_.data();
    input.ctx = &leaves;
    input.prims = LeafPacker::prims;
    input.leaves = static_cast<const rt_packed_prim*>(accel.leaves.data());
    rt_refit_output output{};
    output.struct_bytes = sizeof output;
    output.slots = slots.data();
    output.ctx = &cost_;
    output.cost = [](void* ctx, rt_u32 group, double cost) {
        auto& costs = *static_cast<std::vector<double>*>(ctx);
        if (group < costs.size()) costs[group] = cost;
    };
    const std::string speaker = std::string("accel ") + accel.layout->id;
    HostServices services(speaker, progress);
    services.check(static_cast<int>(Exit::failed), [&] {
        const ScopedFpMode floats;
        return plugin_.refit(services.host(), &input, &output);
    });
    if (leaves.asked() != expected)
        throw Error(Exit::failed, speaker + ": its refit asked for " + std::to_string(leaves.asked()) + " of " +
                                      std::to_string(expected) + " primitives; this is a fault of the plugin");
    for (size_t g = 0; g < changed.size(); ++g) {
        if (!changed[g]) continue;
        buffer.version[g] = version_[g];
        const bool known = started_ && built_cost_[g] > 0;
        result.groups.push_back({static_cast<rt_u32>(g), primitives_of_group_[g], known ? cost_[g] / built_cost_[g] : 1.0});
    }
    result.refitted += expected;
}

MovedStructure HostMover::refit_into_spare(Progress& progress) {
    MovedStructure result;
    Buffer& buffer = spare();
    // The meshes first: instances need their boxes.
    std::vector<uint8_t> changed(version_.size(), 0);
    bool any = false;
    for (size_t g = 1; g < version_.size(); ++g) any |= changed[g] = buffer.version[g] != version_[g];
    if (any) call(buffer, changed, progress, result);
    if (buffer.version[0] != version_[0]) {
        place_instances(*buffer.accel);
        changed.assign(version_.size(), 0);
        changed[0] = 1;
        call(buffer, changed, progress, result);
        buffer.accel->scene.bounds = boxes_[0];
    }
    buffer.instances_version = moves_;
    double now = 0, then = 0;
    for (size_t g = 0; started_ && g < cost_.size(); ++g) {
        if (!(built_cost_[g] > 0)) continue;
        result.worst_cost_ratio = std::max(result.worst_cost_ratio, cost_[g] / built_cost_[g]);
        now += static_cast<double>(primitives_of_group_[g]) * cost_[g];
        then += static_cast<double>(primitives_of_group_[g]) * built_cost_[g];
    }
    for (auto& [label, value] : buffer.accel->stats)
        if (label.rfind("sah_", 0) == 0 && then > 0) value = built_->stat(label) * now / then;
    result.accel = buffer.accel;
    return result;
}

MovedStructure HostMover::move(const Pose& pose, Progress& progress) {
    const auto begin = std::chrono::steady_clock::now();
    MovedStructure result;
    if (cannot_) {
        result.why = cannot_.text();
        return result;
    }
    if (!started_) start(progress);
    result.why = place(pose).text();
    if (!result.why.empty()) return result;
    result = refit(progress);
    result.ms = ms_since(begin);
    return result;
}

MovedStructure HostMover::refit(Progress& progress) {
    const auto begin = std::chrono::steady_clock::now();
    if (!started_) start(progress);
    ++moves_;
    // A mesh that moves makes its instances move.
    for (size_t g = 1; g < version_.size(); ++g)
        if (version_[g] == moves_) version_[0] = moves_;
    MovedStructure result = refit_into_spare(progress);
    result.ms = ms_since(begin);
    return result;
}

uint64_t HostMover::state_bytes() const {
    uint64_t bytes = corners_.size() * sizeof(rt_u32) + positions_.size() * sizeof(float);
    for (const auto& buffer : buffers_)
        bytes += buffer->accel->bytes + buffer->accel->scene.attribute_triangle.size() * sizeof(uint32_t);
    return bytes;
}

}  // namespace clarity
