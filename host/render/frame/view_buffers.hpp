// view_buffers.hpp -- what a view brings to a device with every frame: its numbers, lights and materials.
#pragma once
#include "render/film/growing_buffer.hpp"
#include "render/frame/device_scene.hpp"
#include "render/frame/renderer.hpp"

namespace clarity {

class ViewBuffers {
 public:
    // Throws Error(failed) if the view's materials do not fit the scene's: kernels look them and their textures up by number.
    // frames: of each sample that is to be traced at once. rows: of work-groups that a device has of a shared picture;
    // row_count of them, or more.
    void write(cl::CommandQueue& queue, const Scene& scene, const std::vector<rt_frame>& frames, const View& view,
               const std::vector<rt_u32>& rows = {});
    const cl::Buffer& frame() const { return frame_.get(); }
    // The context's arguments, from `first` on.
    void bind(const DeviceScene& scene, cl::Kernel& kernel, cl_uint first) const;

 private:
    // Sends only what has changed, and does not wait for it: either costs as much as a small frame's kernel.
    class Part {
     public:
        ~Part();
        void write(cl::CommandQueue& queue, const void* data, size_t bytes);
        const cl::Buffer& get() const { return buffer_.get(); }

     private:
        GrowingBuffer buffer_{CL_MEM_READ_ONLY};
        std::vector<unsigned char> written_;  // read by the device until:
        cl::Event on_its_way_;
    };
    Part frame_, lights_, materials_;
    std::vector<unsigned char> frames_and_rows_;
    bool own_materials_ = false;
};

}  // namespace clarity
