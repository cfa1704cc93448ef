// view_buffers.hpp -- what a view brings to a device with every frame: its numbers, lights and materials.
#pragma once
#include "render/device_scene.hpp"
#include "render/growing_buffer.hpp"
#include "render/renderer.hpp"

namespace clarity {

class ViewBuffers {
 public:
    // Throws Error(failed) if the view's materials do not fit the scene's: kernels look them and their textures up by number.
    void write(cl::CommandQueue& queue, const Scene& scene, const rt_frame& frame, const View& view);
    const cl::Buffer& frame() const { return frame_.get(); }
    // The context's arguments, from `first` on.
    void bind(const DeviceScene& scene, cl::Kernel& kernel, cl_uint first) const;

 private:
    GrowingBuffer frame_{CL_MEM_READ_ONLY}, lights_{CL_MEM_READ_ONLY}, materials_{CL_MEM_READ_ONLY};
    bool own_materials_ = false;
};

}  // namespace clarity
