// wire.cpp -- what a worker process leaves in shared memory, as the host reads it. A worker may be under an attacker's control.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
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
    const int file = memfd_create("scene", MFD_ALLOW_SEALING);
    if (file < 0 || !clarity::import::write_scene(file, scene).empty()) std::abort();
    std::string bytes(size_t(lseek(file, 0, SEEK_END)), '\0');
    if (pread(file, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) std::abort();
    close(file);
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
    const int file = memfd_create("scene", MFD_ALLOW_SEALING);
    if (file < 0 || write(file, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
    fcntl(file, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW);
    clarity::Scene scene;
    const std::string why = clarity::import::read_scene(file, scene);
    if (why.empty()) clarity::validate(scene);
    close(file);
    return 0;
}
