// shown_scene.hpp -- the scene that is prepared: what was imported, with the instances moved and hidden as the user wants them,
// in a pose.
//
// Every new Scene object needs a new structure, or a refit of it. So objects are kept as long as they look right.
#pragma once
#include <memory>
#include <vector>

#include "base/progress.hpp"
#include "import/import.hpp"
#include "scene/instance_edit.hpp"
#include "stand/pose_preparer.hpp"
#include "ui/threads/prepared_scene.hpp"

namespace clarity::ui {

// Used on the preparing thread.
class ShownScene : public PosedScene {
 public:
    ShownScene(const PluginRegistry& plugins, const import::ImportOptions& options);
    // Shows what the request asks for. A request for other files than `loaded` changes neither pose nor edits. Throws what
    // evaluate() throws; everything then stays as it was.
    void update(const std::shared_ptr<const ImportedScene>& loaded, const PrepareRequest& request);

    // In its pose. Hidden instances are in it, but not visible.
    const std::shared_ptr<const Scene>& scene() const override { return scene_; }
    // At rest, with the edits; poses are made of it.
    const std::shared_ptr<const Scene>& rest() const override { return rest_; }
    const PoseTime& pose() const { return pose_; }
    // Whether a structure should follow geometry() by refits: a clip plays, or the user has moved or hidden something. Once he
    // has, this stays so until another scene is loaded, so that undo is a refit, too.
    bool follows() const override { return pose_.time_s || !apart_.empty(); }
    PosedFrom from() const override { return {mapped_, pose_.clip, !pose_.time_s, apart_}; }
    // The pose of scene(); its cameras and lights may be of another one. Empty unless follows().
    const Pose& geometry() const override { return geometry_; }
    void add_vertices() override;
    // What moves the meshes whose vertices are left out: scene() has them at rest.
    std::vector<Deformation> left_out() const;
    const InstanceEdits& instances() const { return instances_; }
    const MapEdits& maps() const { return maps_; }
    const std::vector<rt_u32>& asked_apart() const { return asked_apart_; }
    const std::vector<Camera>& cameras() const { return cameras_; }
    const std::vector<Light>& lights() const { return lights_; }

 private:
    bool edit(const InstanceEdits& edits, const std::vector<rt_u32>& apart, bool mapped);
    bool give_maps(const MapEdits& maps);
    void place(const PoseTime& pose, bool edited);
    bool shows(const Pose& pose, const std::string& clip) const;

    Progress unwatched_;  // of files of sequences
    import::SequenceReader sequences_;
    std::shared_ptr<const ImportedScene> loaded_;
    std::shared_ptr<const Scene> mapped_;  // what was imported, with the textures that the user gave to materials
    std::shared_ptr<const Scene> rest_, scene_;
    Pose geometry_;
    PoseTime pose_;
    InstanceEdits instances_;
    MapEdits maps_;
    std::vector<rt_u32> apart_, asked_apart_;  // instances that the user has moved or hidden, or is about to; ascending
    MeshMiddles middles_;
    std::vector<Camera> cameras_;
    std::vector<Light> lights_;
};

}  // namespace clarity::ui
