#include "ui/threads/shown_scene.hpp"

#include <algorithm>
#include <functional>

namespace clarity::ui {
namespace {

bool same_numbers(const SharedArray<float>& of_scene, rt_u32 first_vertex, const std::vector<float>& of_pose) {
    const size_t first = 3 * size_t(first_vertex);
    return of_scene.size() >= first + of_pose.size() &&
           std::equal(of_pose.begin(), of_pose.end(), of_scene.begin() + static_cast<std::ptrdiff_t>(first));
}

// Whether a scene has the instances of a pose, and the vertices that the pose does not leave out.
bool has_geometry_of(const Scene& scene, const Pose& pose) {
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& a = scene.instances[i];
        const PosedInstance& b = pose.instances[i];
        if (a.mesh != b.mesh || a.visible != b.visible || a.world_from_object != b.world_from_object) return false;
    }
    return std::all_of(pose.meshes.begin(), pose.meshes.end(), [&](const PosedMesh& mesh) {
        const rt_u32 first = scene.meshes[mesh.mesh].first_vertex;
        return same_numbers(scene.positions, first, mesh.positions) && same_numbers(scene.normals, first, mesh.normals);
    });
}

}  // namespace

ShownScene::ShownScene(const PluginRegistry& plugins, const import::ImportOptions& options)
    : sequences_(plugins, options, unwatched_) {}

void ShownScene::update(const std::shared_ptr<const ImportedScene>& loaded, const PrepareRequest& request) {
    const bool same_files = request.files_revision == loaded->files_revision, fresh = loaded_ != loaded;
    const PoseTime pose = same_files ? request.pose : fresh ? PoseTime() : pose_;
    const InstanceEdits edits = same_files ? request.instances : fresh ? InstanceEdits() : instances_;
    const MapEdits maps = same_files ? request.maps : fresh ? MapEdits() : maps_;
    const std::vector<rt_u32> apart = same_files ? request.apart : fresh ? std::vector<rt_u32>() : asked_apart_;
    if (fresh) {
        mapped_ = rest_ = scene_ = loaded->scene;
        cameras_ = scene_->cameras;
        lights_ = scene_->lights;
        pose_ = {};
        geometry_ = {};
        instances_ = {};
        maps_ = {};
        apart_.clear();
        asked_apart_.clear();
        middles_ = {};
        loaded_ = loaded;
    }
    const bool mapped = give_maps(maps), edited = edit(edits, apart, mapped);
    if (edited || !same_pose(pose, pose_)) place(pose, edited);
}

// Returns whether the imported scene has other textures now.
bool ShownScene::give_maps(const MapEdits& maps) {
    if (maps == maps_) return false;
    maps_ = maps;
    mapped_ = maps_.empty() ? loaded_->scene : std::make_shared<const Scene>(with_maps(*loaded_->scene, maps_));
    return true;
}

// Returns whether the scene at rest is another one now.
bool ShownScene::edit(const InstanceEdits& edits, const std::vector<rt_u32>& apart, bool mapped) {
    if (!mapped && edits == instances_ && apart == asked_apart_) return false;
    std::vector<rt_u32> all = apart_;
    for (const InstanceEdits::Moved& moved : edits.moved) all.push_back(moved.instance);
    for (const auto* more : {&edits.hidden, &apart}) all.insert(all.end(), more->begin(), more->end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    const bool same = !mapped && edits == instances_ && all == apart_;
    instances_ = edits;
    asked_apart_ = apart;
    apart_ = std::move(all);
    if (same) return false;
    rest_ = instances_.empty() && apart_.empty()
                ? mapped_
                : std::make_shared<const Scene>(with_edits(*mapped_, instances_, apart_, middles_));
    return true;
}

// Whether scene() has the geometry of a pose. The scene at rest never has it if the clip moves instances, even where they stand
// as at rest: they are not kept apart in it.
bool ShownScene::shows(const Pose& pose, const std::string& clip) const {
    if (!(pose.deformations == geometry_.deformations) || !has_geometry_of(*scene_, pose)) return false;
    if (scene_ != rest_) return true;
    const std::vector<bool> moving = moving_instances(*scene_, clip);
    for (size_t i = 0; i < moving.size(); ++i)
        if (moving[i] && !scene_->instances[i].apart) return false;
    return true;
}

void ShownScene::add_vertices() {
    if (left_out().empty()) return;
    clarity::add_vertices(*rest_, geometry_);
    scene_ = std::make_shared<const Scene>(posed(*rest_, geometry_));
}

std::vector<Deformation> ShownScene::left_out() const {
    std::vector<Deformation> deformations;
    for (const Deformation& deformation : geometry_.deformations)
        if (clarity::left_out(geometry_, deformation.mesh)) deformations.push_back(deformation);
    return deformations;
}

void ShownScene::place(const PoseTime& time, bool edited) {
    if (!time.time_s) {
        scene_ = rest_;
        geometry_ = {};
        if (!apart_.empty())
            for (const Instance& i : rest_->instances) geometry_.instances.push_back({i.mesh, i.world_from_object, i.visible});
        cameras_ = rest_->cameras;
        lights_ = rest_->lights;
    } else {
        Pose pose = evaluate_without_vertices(*rest_, time.clip, *time.time_s, std::ref(sequences_));
        cameras_ = pose.cameras;
        lights_ = pose.lights;
        if (edited || !shows(pose, time.clip))
            scene_ = std::make_shared<const Scene>(posed(*rest_, pose));
        else if (!pose.deformations.empty())
            pose.meshes = std::move(geometry_.meshes);  // with vertices that were added
        geometry_ = std::move(pose);
    }
    pose_ = time;
}

}  // namespace clarity::ui
