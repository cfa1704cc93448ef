#include "render/view_buffers.hpp"

#include "base/error.hpp"

namespace clarity {
namespace {

void check_materials(const Scene& scene, const std::vector<rt_material>& materials) {
    if (materials.size() != scene.materials.size())
        throw Error(Exit::failed, "the view brings " + std::to_string(materials.size()) + " materials and the scene has " +
                                      std::to_string(scene.materials.size()) + ": one for each is needed");
    for (size_t i = 0; i < materials.size(); ++i)
        if (materials[i].texture != RT_NONE && materials[i].texture >= scene.textures.size())
            throw Error(Exit::failed, "material " + std::to_string(i) + " of the view names texture " +
                                          std::to_string(materials[i].texture) + " and the scene has " +
                                          std::to_string(scene.textures.size()));
}

template <class T>
void upload(cl::CommandQueue& queue, GrowingBuffer& buffer, const T* data, size_t count) {
    const cl::Buffer& to = buffer.fit(queue.getInfo<CL_QUEUE_CONTEXT>(), count * sizeof(T));
    if (count) queue.enqueueWriteBuffer(to, CL_TRUE, 0, count * sizeof(T), data);
}

}  // namespace

void ViewBuffers::write(cl::CommandQueue& queue, const Scene& scene, const rt_frame& frame, const View& view) {
    own_materials_ = !view.materials.empty();
    if (own_materials_) check_materials(scene, view.materials);
    upload(queue, frame_, &frame, 1);
    upload(queue, lights_, view.lights.data(), view.lights.size());
    if (own_materials_) upload(queue, materials_, view.materials.data(), view.materials.size());
}

void ViewBuffers::bind(const DeviceScene& scene, cl::Kernel& kernel, cl_uint first) const {
    scene.bind(kernel, first, lights_.get(), own_materials_ ? &materials_.get() : nullptr);
}

}  // namespace clarity
