#include "scene/motion/file_sequence.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "scene/motion/deform.hpp"

namespace clarity {
namespace {

// The files around a time by their numbers; both are the same at the time of a file, before the first and after the last one.
struct Neighbours {
    rt_u32 before, after;
    double share;  // of the way from one to the other, 0..1
};

Neighbours neighbours(const Scene& scene, const FileSequence& sequence, double time_s) {
    const rt_u32* numbers = &scene.motion.sequence_numbers[sequence.first_number];
    const double at = time_s * sequence.fps;
    const rt_u32* after = std::find_if(numbers, numbers + sequence.number_count - 1, [&](rt_u32 n) { return n >= at; });
    if (after == numbers || at >= *after) return {*after, *after, 1};
    const rt_u32 before = after[-1];
    return {before, *after, (at - before) / (double(*after) - before)};
}

std::string file_of(const FileSequence& sequence, rt_u32 number) {
    return frame_path(sequence.pattern, static_cast<int>(number));
}

std::vector<float> vertices_of(const FileSequence& sequence, rt_u32 number, size_t expected, const FrameVertices& read) {
    const std::string file = file_of(sequence, number);
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
        const Neighbours files = neighbours(scene, sequence, time_s);
        std::vector<float> positions = vertices_of(sequence, files.after, count, read);
        if (files.before != files.after) {
            const std::vector<float> before = vertices_of(sequence, files.before, count, read);
            for (size_t i = 0; i < count; ++i)
                positions[i] = static_cast<float>(before[i] + (double(positions[i]) - before[i]) * files.share);
        }
        const float* from = positions.data();
        for (rt_u32 m = sequence.first_mesh; m < sequence.first_mesh + sequence.mesh_count; ++m) {
            PosedMesh mesh = stored_mesh(scene, m);
            mesh.positions.assign(from, from + mesh.positions.size());
            from += mesh.positions.size();
            if (!mesh.normals.empty()) renew_normals(scene, mesh);
            meshes.push_back(std::move(mesh));
        }
    }
}

void add_sequence_files(const Scene& scene, double time_s, std::set<std::string>& files) {
    for (const FileSequence& sequence : scene.motion.sequences) {
        const Neighbours around = neighbours(scene, sequence, time_s);
        for (const rt_u32 number : {around.before, around.after}) files.insert(file_of(sequence, number));
    }
}

}  // namespace clarity
