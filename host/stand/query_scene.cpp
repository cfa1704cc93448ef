#include "stand/query_scene.hpp"

#include "device/cl_errors.hpp"
#include "launch/device_scene.hpp"

namespace clarity {

std::shared_ptr<const Prepared> prepare_queries(Device& device, std::shared_ptr<const Scene> scene,
                                                std::shared_ptr<const AccelData> accel, const Settings& settings,
                                                Progress& progress) {
    auto prepared = std::make_shared<Prepared>();
    prepared->scene = scene;
    prepared->accel = accel;
    Settings& s = prepared->settings = settings;
    s.accel = accel->plugin->id;
    s.accel_params = accel->params;
    resolve_packet(s, device.info());
    prepared->layout = make_layout(s, device.info().traces_packets());
    progress.stage("uploading the scene");
    wrap_cl_errors(device, "uploading the scene", [&] {
        prepared->on_device = std::make_shared<DeviceScene>(device, std::move(scene), std::move(accel), progress);
        return 0;
    });
    return prepared;
}

}  // namespace clarity
