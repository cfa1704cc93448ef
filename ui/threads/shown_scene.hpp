// shown_scene.hpp -- the scene that is prepared: what was imported, in a pose, and without its hidden instances.
//
// Every new Scene object needs a new structure, new buffers and so on. So objects are kept as long as they look right.
#pragma once
#include <memory>
#include <vector>

#include "base/progress.hpp"
#include "import/sequence_reader.hpp"
#include "ui/threads/prepared_scene.hpp"

namespace clarity::ui {

// Used on the preparing thread.
class ShownScene {
 public:
    ShownScene(const PluginRegistry& plugins, const import::ImportOptions& options);
    // Shows what the request asks for. A request for other files than `loaded` changes neither pose nor hidden instances.
    // Throws what evaluate() throws; everything then stays as it was.
    void update(const std::shared_ptr<const ImportedScene>& loaded, const PrepareRequest& request);

    const std::shared_ptr<const Scene>& posed() const { return posed_; }
    const std::shared_ptr<const Scene>& visible() const { return visible_; }  // posed() without the hidden instances
    const PoseTime& pose() const { return pose_; }
    // The instances and deformed meshes of visible(); no cameras and lights. Empty for a scene at rest.
    const Pose& geometry() const { return geometry_; }
    const std::vector<rt_u32>& hidden() const { return hidden_; }
    const std::vector<Camera>& cameras() const { return cameras_; }
    const std::vector<Light>& lights() const { return lights_; }

 private:
    void place(const PoseTime& pose);
    bool shows(const Pose& pose) const;

    Progress unwatched_;  // of files of sequences
    import::SequenceReader sequences_;
    std::shared_ptr<const ImportedScene> loaded_;
    std::shared_ptr<const Scene> posed_, visible_;
    Pose geometry_;  // of visible_
    PoseTime pose_;
    std::vector<rt_u32> hidden_;
    std::vector<Camera> cameras_;
    std::vector<Light> lights_;
};

// Whether a scene has the instances and vertices of a pose, so that only cameras and lights may differ.
bool has_geometry_of(const Scene& scene, const Pose& pose);

}  // namespace clarity::ui
