// wire.cpp -- what a worker process leaves in shared memory, as the host reads it. A worker may be under an attacker's control.
#include <cstdint>
#include <cstring>
#include <string>

#include "import/wire.hpp"

namespace {

std::string valid_scene() {
    clarity::Scene scene;
    scene.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    scene.triangles = {0, 1, 2};
    scene.triangle_materials = {0};
    scene.materials.push_back({"paint", clarity::default_material()});
    clarity::Mesh mesh{};
    mesh.name = "mesh";
    mesh.vertex_count = 3;
    mesh.triangle_count = 1;
    scene.meshes.push_back(mesh);
    scene.instances.emplace_back();
    scene.instances.back().name = "instance";
    scene.cameras.emplace_back();
    scene.lights.emplace_back();
    scene.warnings = {"a warning"};
    clarity::MemoryFile file;
    clarity::import::write_scene(file, scene);
    std::string bytes(file.bytes(), '\0');
    file.read_at(0, bytes.data(), bytes.size());
    return bytes;
}

}  // namespace

// The input is either the whole file, or after a 1, changes of a valid one: an offset of 2 bytes and the value of 8 bytes
// there.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const std::string valid = valid_scene();
    std::string bytes(reinterpret_cast<const char*>(data), size);
    if (size > 0 && data[0] == 1) {
        bytes = valid;
        for (size_t at = 1; at + 10 <= size; at += 10) {
            const size_t offset = (data[at] | data[at + 1] << 8) % (valid.size() - 7);
            std::memcpy(&bytes[offset], data + at + 2, 8);
        }
    }
    clarity::MemoryFile file;
    file.write_at(0, bytes.data(), bytes.size());
    file.seal_size();
    try {
        (void)clarity::validate(clarity::import::read_scene(file));
    } catch (const clarity::Error&) {
    }
    return 0;
}
