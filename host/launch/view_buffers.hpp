// view_buffers.hpp -- device buffers with the data that changes with every frame: frame constants, lights and materials.
#pragma once
#include "device/growing_buffer.hpp"
#include "device/queue.hpp"
#include "launch/device_scene.hpp"
#include "launch/emitters/sky_table.hpp"
#include "scene/scene.hpp"
#include "structures/accel_build.hpp"
#include "view/view.hpp"

namespace clarity {

// One buffer. Uploads only if the data has changed, and does not wait for the upload: either would cost as much as the kernel
// of a small frame.
class UploadedBuffer {
 public:
    ~UploadedBuffer();
    void write(Queue& queue, const void* data, size_t bytes);
    const cl::Buffer& get() const { return buffer_.get(); }

 private:
    GrowingBuffer buffer_{CL_MEM_READ_ONLY};
    std::vector<unsigned char> written_;  // last content; the device may read it until on_its_way_ is complete
    cl::Event on_its_way_;
};

// Reused from frame to frame. Uploads only what has changed. Used from one thread.
class ViewBuffers {
 public:
    // Uploads a view.
    // frames: one for each sample that the next launch traces.
    // rows: numbers of the work-group rows that a device traces of a shared picture; row_count entries are valid, the rest is
    // padding.
    // on_device: the buffers that the frames are traced in.
    // Throws Error(failed) if the view's materials do not match the scene's, since kernels index materials and textures by
    // number.
    void write(Queue& queue, const Scene& scene, const DeviceScene& on_device, const std::vector<rt_frame>& frames,
               const View& view, const std::vector<rt_u32>& rows = {});
    // Uploads the table of emitters, for kernels with kPicksLights. The view is that of write(). Makes the table only if the
    // structure, the lights or the materials have changed, or after forget_emitters(). moved: the buffers of a structure that
    // was moved on the device, of which surfaces that emit are read back; nullptr: it is where accel has it. settings: say
    // whether there is a light tree.
    void write_emitters(Queue& queue, const Scene& scene, const std::shared_ptr<const AccelData>& accel, const View& view,
                        const Settings& settings, const DeviceScene* moved = nullptr);
    void forget_emitters() { has_emitters_ = false; }
    const cl::Buffer& frame() const { return frame_.get(); }
    // Sets `frame` and the scene's arguments of the kernel.
    void bind(const DeviceScene& scene, KernelArguments& kernel) const;

 private:
    // What the table of emitters is made from.
    struct EmittersOf {
        std::weak_ptr<const AccelData> accel;
        std::vector<rt_light> lights;
        std::vector<MaterialValues> materials;
        std::array<float, 3> background{};
        SkyValues sky;
        SharedArray<float> sky_texels;
        std::vector<rt_map> maps;           // an edit of textures keeps the structure
        std::vector<rt_u32> emission_maps;  // of each material
        bool tree = false;
    };
    UploadedBuffer frame_, lights_, materials_, layers_, emitters_, emitter_runs_, light_nodes_, lighting_, sky_texels_,
        sky_picks_;
    std::vector<rt_material> plain_materials_;  // these two are kept for their memory: frames allocate nothing
    std::vector<rt_layers> material_layers_;
    EmittersOf emitters_of_;
    bool has_emitters_ = false;  // the table was made from these
    SharedArray<float> sky_of_;  // the picture that sky_ was made from
    SkyTable sky_;
    std::vector<unsigned char> frames_and_rows_;
    bool own_materials_ = false;
};

}  // namespace clarity
