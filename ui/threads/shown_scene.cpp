#include "ui/threads/shown_scene.hpp"

#include <algorithm>
#include <functional>

namespace clarity::ui {
namespace {

bool same_numbers(const std::vector<float>& of_scene, rt_u32 first_vertex, const std::vector<float>& of_pose) {
    const size_t first = 3 * size_t(first_vertex);
    return of_scene.size() >= first + of_pose.size() &&
           std::equal(of_pose.begin(), of_pose.end(), of_scene.begin() + static_cast<std::ptrdiff_t>(first));
}

}  // namespace

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

ShownScene::ShownScene(const PluginRegistry& plugins, const import::ImportOptions& options)
    : sequences_(plugins, options, unwatched_) {}

void ShownScene::update(const std::shared_ptr<const ImportedScene>& loaded, const PrepareRequest& request) {
    const bool same_files = request.files_revision == loaded->files_revision, fresh = loaded_ != loaded;
    const PoseTime pose = same_files ? request.pose : fresh ? PoseTime() : pose_;
    const std::vector<rt_u32> hidden = same_files ? request.hidden : fresh ? std::vector<rt_u32>() : hidden_;
    if (fresh) {
        posed_ = loaded->scene;
        cameras_ = posed_->cameras;
        lights_ = posed_->lights;
        pose_ = {};
        geometry_ = {};
        loaded_ = loaded;
        visible_.reset();
    }
    const std::shared_ptr<const Scene> before = posed_;
    if (!same_pose(pose, pose_)) place(pose);
    if (visible_ && posed_ == before && hidden_ == hidden) return;
    hidden_ = hidden;
    visible_ = hidden_.empty() ? posed_ : std::make_shared<const Scene>(without_instances(*posed_, hidden_));
}

void ShownScene::place(const PoseTime& time) {
    const Scene& rest = *loaded_->scene;
    if (!time.time_s) {
        posed_ = loaded_->scene;
        geometry_ = {};
        cameras_ = rest.cameras;
        lights_ = rest.lights;
    } else {
        Pose pose = evaluate(rest, time.clip, *time.time_s, std::ref(sequences_));
        if (!has_geometry_of(*posed_, pose)) posed_ = std::make_shared<const Scene>(clarity::posed(rest, pose));
        cameras_ = std::move(pose.cameras);
        lights_ = std::move(pose.lights);
        geometry_ = std::move(pose);
    }
    pose_ = time;
}

Pose ShownScene::geometry() const {
    Pose pose = geometry_;
    for (const rt_u32 i : hidden_)
        if (i < pose.instances.size()) pose.instances[i].visible = false;
    return pose;
}

}  // namespace clarity::ui
