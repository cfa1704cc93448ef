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
    if (!visible_ || posed_ != before || hidden_ != hidden) {
        hidden_ = hidden;
        visible_ = hidden_.empty() ? posed_ : std::make_shared<const Scene>(without_instances(*posed_, hidden_));
    }
    for (size_t i = 0; i < geometry_.instances.size(); ++i) geometry_.instances[i].visible = visible_->instances[i].visible;
}

// Whether posed() has the geometry of a pose. The scene at rest never has it if instances move, even where they stand as at
// rest: they are not kept apart in it.
bool ShownScene::shows(const Pose& pose) const {
    if (!has_geometry_of(*posed_, pose)) return false;
    if (posed_ != loaded_->scene) return true;
    const std::vector<bool> moving = moving_instances(*posed_);
    return std::find(moving.begin(), moving.end(), true) == moving.end();
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
        if (!shows(pose)) posed_ = std::make_shared<const Scene>(clarity::posed(rest, pose));
        cameras_ = std::move(pose.cameras);
        lights_ = std::move(pose.lights);
        geometry_ = std::move(pose);
    }
    pose_ = time;
}

}  // namespace clarity::ui
