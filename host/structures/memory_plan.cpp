#include "structures/memory_plan.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "structures/accel_build.hpp"

namespace clarity {
namespace {

constexpr uint64_t kPrimitivesPerNode = 12;

constexpr const char* kAdvice =
    "; take fewer triangles, meshes placed several times instead of copies, or another device (`clarity devices`)";
constexpr const char* kTextures = "textures";
constexpr const char* kSmallerPictures = "; make the pictures of textures smaller, or take another device (`clarity devices`)";
constexpr const char* kSmallerNodes =
    "; take a structure of smaller nodes (`clarity bench accel` lists their bytes per triangle)";

}  // namespace

std::vector<MemoryPiece> plan_memory(const SceneCounts& counts, const Scene& scene, const rt_accel& accel) {
    std::vector<MemoryPiece> pieces;
    pieces.push_back({"leaves", (counts.references + kLeafPadding) * sizeof(rt_packed_prim)});
    if (accel.slot_count > 0)
        pieces.push_back({accel.slots[0].name, counts.references / kPrimitivesPerNode * accel.slots[0].elem_bytes});
    if (scene.has_attributes()) pieces.push_back({"triangles", counts.triangles * sizeof(rt_triangle)});
    pieces.push_back({"normals", scene.normals.size() * sizeof(float)});
    pieces.push_back({"texture coordinates", scene.uvs.size() * sizeof(float)});
    if (!scene.tangents.empty()) pieces.push_back({"tangents", 3 * counts.triangles * sizeof(rt_u32)});
    pieces.push_back({"second texture coordinates", scene.uvs2.size() * sizeof(float)});
    pieces.push_back({"colours of vertices", scene.colors.size() * sizeof(float)});
    pieces.push_back({"numbers of shapes", scene.shape_numbers.size() * sizeof(float)});
    pieces.push_back({kTextures, scene.texels.size() * sizeof(uint32_t)});
    return pieces;
}

void check_fits(const std::vector<MemoryPiece>& pieces, const DeviceInfo& device, const std::string& scene) {
    uint64_t total = 0;
    for (const MemoryPiece& piece : pieces) {
        total += piece.bytes;
        if (device.max_allocation_bytes == 0 || piece.bytes <= device.max_allocation_bytes) continue;
        throw Error(Exit::failed, "the scene does not fit: the " + piece.what + " of " + scene + " take " +
                                      memory_text(piece.bytes) + ", and " + device.name + " allows " +
                                      memory_text(device.max_allocation_bytes) + " in one piece" +
                                      (piece.what == kTextures ? kSmallerPictures : kAdvice));
    }
    if (device.global_bytes == 0 || total <= device.global_bytes) return;
    std::vector<MemoryPiece> largest = pieces;
    std::stable_sort(largest.begin(), largest.end(),
                     [](const MemoryPiece& a, const MemoryPiece& b) { return a.bytes > b.bytes; });
    std::string parts;
    for (size_t i = 0; i < std::min<size_t>(largest.size(), 3) && largest[i].bytes > 0; ++i)
        parts += (parts.empty() ? "" : ", ") + largest[i].what + " " + memory_text(largest[i].bytes);
    throw Error(Exit::failed, "the scene does not fit: " + scene + " take at least " + memory_text(total) + " (" + parts +
                                  "), and " + device.name + " has " + memory_text(device.global_bytes) +
                                  (pieces.size() > 1 && pieces[0].bytes < device.global_bytes ? kSmallerNodes : "") + kAdvice);
}

}  // namespace clarity
