#include "scene/motion/file_sequence.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "scene/motion/deform.hpp"

namespace clarity {
namespace {

std::vector<float> vertices_of(const FileSequence& sequence, rt_u32 number, size_t expected, const FrameVertices& read) {
    const std::string file = frame_path(sequence.pattern, static_cast<int>(number));
    std::vector<float> positions = read(file);
    if (positions.size() != expected)
        throw Error(Exit::import_failed, file + ": has " + std::to_string(positions.size() / 3) +
                                             " vertices, but the first file of the sequence has " +
                                             std::to_string(expected / 3) +
                                             "; all files of a sequence must have the same faces");
    return positions;
}

}  // namespace

void add_sequences(const Scene& scene, double time_s, const FrameVertices& read, std::vector<PosedMesh>& meshes) {
    for (const FileSequence& sequence : scene.motion.sequences) {
        size_t count = 0;
        for (rt_u32 m = 0; m < sequence.mesh_count; ++m)
            count += 3 * size_t(scene.meshes[sequence.first_mesh + m].vertex_count);
        const rt_u32* numbers = &scene.motion.sequence_numbers[sequence.first_number];
        const double at = time_s * sequence.fps;
        const rt_u32* next = std::find_if(numbers, numbers + sequence.number_count - 1, [&](rt_u32 n) { return n >= at; });
        const rt_u32* last = next == numbers ? numbers : next - 1;
        std::vector<float> positions = vertices_of(sequence, *next, count, read);
        if (next != last && at < *next) {
            const std::vector<float> before = vertices_of(sequence, *last, count, read);
            const double x = (at - *last) / (double(*next) - *last);
            for (size_t i = 0; i < count; ++i)
                positions[i] = static_cast<float>(before[i] + (double(positions[i]) - before[i]) * x);
        }
        const float* from = positions.data();
        for (rt_u32 m = sequence.first_mesh; m < sequence.first_mesh + sequence.mesh_count; ++m) {
            PosedMesh mesh = at_rest(scene, m);
            mesh.positions.assign(from, from + mesh.positions.size());
            from += mesh.positions.size();
            if (!mesh.normals.empty()) renew_normals(scene, mesh);
            meshes.push_back(std::move(mesh));
        }
    }
}

}  // namespace clarity
