#include "moving/on_device/device_mover.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "base/elapsed.hpp"
#include "device/cl_errors.hpp"

namespace clarity {
namespace {

constexpr size_t kCopies = 3;
constexpr uint64_t kCostsEvery = 4;  // moves

bool is_complete(const cl::Event& event) {
    return event.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>() == CL_COMPLETE;
}

}  // namespace

DeviceMover::DeviceMover(std::shared_ptr<Device> device, std::shared_ptr<const Scene> scene,
                         std::shared_ptr<const AccelData> built, std::shared_ptr<const DeviceScene> on_device,
                         std::shared_ptr<const Scene> rest, BuildForm form)
    : device_(std::move(device)),
      scene_(std::move(scene)),
      built_(std::move(built)),
      on_device_(std::move(on_device)),
      rest_(std::move(rest)),
      can_deform_(rest_ && rest_->meshes.size() <= scene_->meshes.size() && DeviceDeformer::fits(*rest_, device_->info())),
      kernels_(device_, form),
      accel_(built_) {
    wrap_cl_errors(*device_, "preparing a scene that moves", [&] {
        groups_ = std::make_unique<DeviceGroups>(kernels_, built_, on_device_, pose_);
        return 0;
    });
}

DeviceMover::~DeviceMover() {
    try {
        for (const cl::Event& event : sent_) event.wait();
        if (costs_known_()) costs_known_.wait();
    } catch (const cl::Error&) {  // the device is lost: nothing reads or writes this memory any more
    }
}

const Problem& DeviceMover::cannot() const {
    return groups_->cannot();
}

// Sends the pose of the build, and refits all of it once, to know the costs of the build.
void DeviceMover::start() {
    const BuildScene& build = built_->scene;
    Queue& queue = device_->queue();
    const auto filled = [&](const void* data, size_t bytes) {
        cl::Buffer buffer = kernels_.buffer(bytes);
        if (bytes > 0) queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data);
        return buffer;
    };
    positions_.assign(scene_->positions.begin(), scene_->positions.end());
    normals_.assign(scene_->normals.begin(), scene_->normals.end());
    pose_.positions = filled(positions_.data(), positions_.size() * sizeof(float));
    pose_.normals = filled(normals_.data(), normals_.size() * sizeof(float));
    if (on_device_->has_triangles()) {
        pose_.corners = on_device_->fixed().triangles;
    } else {
        UninitializedVector<rt_u32> corners(3 * build.attribute_triangle.size());
        for (size_t i = 0; i < build.attribute_triangle.size(); ++i)
            std::copy_n(&scene_->triangles[3 * size_t(build.attribute_triangle[i])], 3, &corners[3 * i]);
        pose_.corners = filled(corners.data(), corners.size() * sizeof(rt_u32));
    }
    instances_ = pose_at_rest(*scene_).instances;
    placements_.resize(build.instances.size());
    for (size_t i = 0; i < placements_.size(); ++i) {
        std::copy_n(build.world_from_object[i].begin(), 12, placements_[i].world_from_object);
        std::copy_n(build.instances[i].object_from_world, 12, placements_[i].object_from_world);
        placements_[i].hidden = build.instances[i].hidden;
    }
    pose_.placements = filled(placements_.data(), placements_.size() * sizeof(DevicePlacement));
    pose_.group_of_instance = filled(build.group_of_instance.data(), build.group_of_instance.size() * sizeof(rt_u32));
    std::vector<float> nothing;
    for (size_t g = 0; g < build.groups.size(); ++g)
        for (const float bound : {INFINITY, -INFINITY}) nothing.insert(nothing.end(), 4, bound);
    pose_.group_boxes = filled(nothing.data(), nothing.size() * sizeof(float));
    pose_.no_bounds = filled(nothing.data() + 1, 6 * sizeof(float));  // three of either sign
    costs_.assign(build.groups.size(), 0);
    pose_.costs = filled(costs_.data(), costs_.size() * sizeof(float));
    is_deformed_.assign(scene_->meshes.size(), 0);
    version_.assign(build.groups.size(), ++moves_);
    built_in_.assign(build.groups.size(), 0);
    is_fresh_.assign(build.groups.size(), 0);
    structures_.clear();
    bring_up(spare(), Update::refit, true);
    queue.enqueueReadBuffer(pose_.costs, CL_TRUE, 0, costs_.size() * sizeof(float), costs_.data());
    built_costs_ = costs_;
    started_ = true;
}

// Takes over a pose. Returns why a build is needed; nothing is changed then.
Problem DeviceMover::place(const Pose& pose) {
    const BuildScene& build = built_->scene;
    find_moved_instances(*scene_, build, instances_, pose, moved_);
    if (moved_.why.empty()) moved_.why = wrong_vertices(*scene_, pose).text();
    const auto in_world = [&](rt_u32 i) {
        return instances_[i].visible && build.number_of_instance[i] == RT_NONE &&
               scene_->meshes[instances_[i].mesh].triangle_count > 0;
    };
    is_posed_.assign(scene_->meshes.size(), 0);
    for (const rt_u32 m : deforming_meshes(pose))
        if (m < is_posed_.size()) is_posed_[m] = 1;
    for (const Deformation& d : pose.deformations)
        if (moved_.why.empty() && !can_deform_ && left_out(pose, d.mesh))
            moved_.why = "the vertices of mesh " + std::to_string(d.mesh) + " are missing";
    for (const rt_u32 i : moved_.numbers)
        if (in_world(i)) moved_.why = "instance " + std::to_string(i) + " is part of the world's tree";
    for (rt_u32 i = 0; i < instances_.size(); ++i)
        if (is_posed_[instances_[i].mesh] && in_world(i))
            moved_.why = "mesh " + std::to_string(instances_[i].mesh) + " is part of the world's tree";
    if (!moved_.why.empty()) return moved_.why;

    for (const cl::Event& event : sent_) event.wait();  // what is sent may be changed again
    sent_.clear();
    rt_u32 first = RT_NONE, last = 0;
    for (size_t k = 0; k < moved_.numbers.size(); ++k) {
        const rt_u32 i = moved_.numbers[k], number = build.number_of_instance[i];
        instances_[i].world_from_object = pose.instances[i].world_from_object;
        instances_[i].visible = pose.instances[i].visible;
        if (number == RT_NONE) continue;
        placements_[number].hidden = hidden_from(scene_->instances[i], instances_[i].visible);
        if (instances_[i].visible) {  // else its box stays where it was
            std::copy_n(instances_[i].world_from_object.begin(), 12, placements_[number].world_from_object);
            std::copy_n(moved_.inverses[k].begin(), 12, placements_[number].object_from_world);
        }
        first = std::min(first, number);
        last = std::max(last, number);
    }
    if (first != RT_NONE) {
        version_[0] = moves_ + 1;
        send(pose_.placements, first * sizeof(DevicePlacement), (last - first + 1) * sizeof(DevicePlacement),
             &placements_[first]);
    }
    for (const PosedMesh& mesh : pose.meshes)
        set_vertices(mesh.mesh, mesh.positions.data(), mesh.normals.empty() ? nullptr : mesh.normals.data());
    for (rt_u32 m = 0; m < is_deformed_.size(); ++m)
        if (is_deformed_[m] && !is_posed_[m]) {
            const size_t at = 3 * size_t(scene_->meshes[m].first_vertex);
            set_vertices(m, &scene_->positions[at], normals_.empty() ? nullptr : &scene_->normals[at]);
        }
    deform(pose);
    is_deformed_ = is_posed_;
    return {};
}

// Lets the device make the vertices that a pose leaves out, where what moves them has changed.
void DeviceMover::deform(const Pose& pose) {
    std::vector<const Deformation*> changed;
    for (const Deformation& d : pose.deformations) {
        if (!left_out(pose, d.mesh) || built_->scene.group_of_mesh[d.mesh] == 0) continue;
        const auto known = made_by_.find(d.mesh);
        if (known != made_by_.end() && known->second == d) continue;
        touch(d.mesh);
        made_by_[d.mesh] = d;
        changed.push_back(&d);
    }
    if (changed.empty()) return;
    if (!deformer_) deformer_ = std::make_unique<DeviceDeformer>(kernels_, rest_);
    deformer_->deform(changed, pose_.positions, pose_.normals);
}

// Takes over the vertices of a mesh, if they differ from those that are there.
void DeviceMover::set_vertices(rt_u32 mesh, const float* positions, const float* normals) {
    const rt_u32 group = built_->scene.group_of_mesh[mesh];
    const Mesh& range = scene_->meshes[mesh];
    const size_t at = 3 * size_t(range.first_vertex), bytes = 12 * size_t(range.vertex_count);
    if (group == 0 || bytes == 0) return;
    const bool made = made_by_.erase(mesh) > 0;  // by the device: other vertices are there
    const bool moves = made || std::memcmp(&positions_[at], positions, bytes) != 0;
    const bool turns = normals && !normals_.empty() && (made || std::memcmp(&normals_[at], normals, bytes) != 0);
    if (moves) {
        std::memcpy(&positions_[at], positions, bytes);
        send(pose_.positions, at * sizeof(float), bytes, &positions_[at]);
    }
    if (turns) {
        std::memcpy(&normals_[at], normals, bytes);
        send(pose_.normals, at * sizeof(float), bytes, &normals_[at]);
    }
    if (moves || turns) version_[group] = version_[0] = moves_ + 1;
}

void DeviceMover::send(const cl::Buffer& to, size_t at, size_t bytes, const void* data) {
    sent_.emplace_back();
    device_->queue().enqueueWriteBuffer(to, CL_FALSE, at, bytes, data, nullptr, &sent_.back());
}

// A structure that nobody else holds: the oldest one. Frames that still read it on the device come before what is enqueued now.
DeviceStructure& DeviceMover::spare() {
    const auto unused = std::find_if(structures_.begin(), structures_.end(),
                                     [](const auto& structure) { return structure->on_device().use_count() == 1; });
    std::unique_ptr<DeviceStructure> taken;
    if (unused != structures_.end()) {
        taken = std::move(*unused);
        structures_.erase(unused);
    } else {
        if (structures_.size() == kCopies) structures_.pop_front();
        taken = std::make_unique<DeviceStructure>(*groups_);
    }
    structures_.push_back(std::move(taken));
    return *structures_.back();
}

// Brings a structure to the pose. Returns how many primitives were refitted.
uint64_t DeviceMover::bring_up(DeviceStructure& structure, Update update, bool with_costs) {
    uint64_t refitted = 0;
    for (rt_u32 m = 0; !normals_.empty() && m < scene_->meshes.size(); ++m) {
        const rt_u32 group = built_->scene.group_of_mesh[m];
        if (group > 0 && structure.version[group] != version_[group])
            structure.take_normals(scene_->meshes[m].first_vertex, scene_->meshes[m].vertex_count);
    }
    for (rt_u32 k = 1; k <= version_.size(); ++k) {
        const rt_u32 g = k % static_cast<rt_u32>(version_.size());  // the world last: instances need the boxes of their meshes
        if (structure.version[g] == version_[g]) continue;
        structure.version[g] = 0;
        if (update == Update::build && version_[g] == moves_) {
            structure.build(g, true);
            structure.built_in[g] = built_in_[g] = moves_;
            is_fresh_[g] = 1;
        } else {
            if (structure.built_in[g] != built_in_[g]) structure.take_tree(g, with_tree_of(g));
            structure.refit(g, with_costs);
        }
        structure.version[g] = version_[g];
        refitted += groups_->primitives(g);
    }
    return refitted;
}

// A structure that has the newest tree of a group.
const DeviceStructure& DeviceMover::with_tree_of(rt_u32 group) const {
    const auto found = std::find_if(structures_.begin(), structures_.end(),
                                    [&](const auto& structure) { return structure->built_in[group] == built_in_[group]; });
    return **found;
}

double DeviceMover::worst_cost_ratio() {
    double worst = 1;
    if (costs_known_() && !is_complete(costs_known_)) return last_ratio_;
    ratios_.resize(costs_.size(), 1);
    for (size_t g = 0; g < costs_.size(); ++g) {
        if (is_fresh_[g]) built_costs_[g] = costs_[g];
        is_fresh_[g] = 0;
        if (built_costs_[g] > 0 && std::isfinite(costs_[g])) ratios_[g] = double(costs_[g]) / built_costs_[g];
        worst = std::max(worst, ratios_[g]);
    }
    return last_ratio_ = worst;
}

// The groups that the last move has changed.
std::vector<MovedGroup> DeviceMover::moved_groups() const {
    std::vector<MovedGroup> groups;
    for (rt_u32 g = 0; g < version_.size(); ++g)
        if (version_[g] == moves_) groups.push_back({g, groups_->primitives(g), g < ratios_.size() ? ratios_[g] : 1.0});
    return groups;
}

MovedOnDevice DeviceMover::move(const Pose& pose, Update update) {
    const auto begin = std::chrono::steady_clock::now();
    MovedOnDevice result;
    result.why = cannot().text();
    if (!result.why.empty()) return result;
    return wrap_cl_errors(*device_, "moving the scene", [&] {
        if (!started_) start();
        result.worst_cost_ratio = worst_cost_ratio();
        device_->queue().enqueueMarkerWithWaitList(nullptr, &result.begin);
        result.why = place(pose).text();
        if (result.why.empty()) finish_move(update, result);
        result.ms = ms_since(begin);
        return result;
    });
}

// Kernels are made for the deepest tree that a device may build: so none is compiled later.
void DeviceMover::raise_defines(const std::map<std::string, rt_u32>& defines) {
    const auto enough = [&](const auto& define) {
        const auto known = accel_->defines.find(define.first);
        return known != accel_->defines.end() && known->second >= define.second;
    };
    if (std::all_of(defines.begin(), defines.end(), enough)) return;
    struct Raised {
        std::shared_ptr<const AccelData> from;  // owns slots and leaves
        AccelData data;
    };
    auto raised = std::make_shared<Raised>();
    raised->from = accel_;
    raised->data = copy_of(*accel_, [](const AlignedBytes& memory) {
        return AlignedBytes::borrow(const_cast<void*>(memory.data()), memory.bytes());
    });
    for (const auto& [name, value] : defines) {
        rt_u32& known = raised->data.defines[name];
        known = std::max(known, value);
    }
    accel_ = std::shared_ptr<const AccelData>(raised, &raised->data);
}

// Refits or builds what version_ says that move number moves_ + 1 has changed.
void DeviceMover::finish_move(Update update, MovedOnDevice& moved) {
    ++moves_;
    DeviceStructure& structure = spare();
    const bool asks = update == Update::build || !costs_known_() || (moves_ % kCostsEvery == 0 && is_complete(costs_known_));
    moved.refitted = bring_up(structure, update, asks);
    raise_defines(structure.defines());
    if (asks && costs_known_()) costs_known_.wait();
    if (asks)
        device_->queue().enqueueReadBuffer(pose_.costs, CL_FALSE, 0, costs_.size() * sizeof(float), costs_.data(), nullptr,
                                           &costs_known_);
    device_->queue().enqueueMarkerWithWaitList(nullptr, &moved.end);
    device_->queue().flush();
    moved.on_device = structure.on_device();
    moved.groups = moved_groups();
}

void DeviceMover::touch(rt_u32 mesh) {
    const rt_u32 group = built_->scene.group_of_mesh[mesh];
    if (group == 0) return;
    version_[group] = version_[0] = moves_ + 1;
    is_deformed_[mesh] = 1;
    made_by_.erase(mesh);
    positions_[3 * size_t(scene_->meshes[mesh].first_vertex)] =
        NAN;  // no longer what is there: the next pose sends its vertices
}

MovedOnDevice DeviceMover::update(Update update) {
    const auto begin = std::chrono::steady_clock::now();
    MovedOnDevice result;
    return wrap_cl_errors(*device_, "moving the scene", [&] {
        result.worst_cost_ratio = worst_cost_ratio();
        device_->queue().enqueueMarkerWithWaitList(nullptr, &result.begin);
        finish_move(update, result);
        result.ms = ms_since(begin);
        return result;
    });
}

}  // namespace clarity
