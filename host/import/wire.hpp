// wire.hpp -- passes a Scene from one process to another, in a file in memory (base/files/parcel.hpp).
#pragma once
#include <string>

#include "base/files/parcel.hpp"
#include "scene/scene.hpp"

namespace clarity::import {

// A scene among the values of a parcel. What is sent without being shared goes back to the system piece by piece, so that the
// scene is not held twice. Indices and numbers that arrive are not checked here but by validate().
struct SentScene {
    Scene scene;
    template <class Parcel, class Self>
    static void visit(Parcel& parcel, Self& self) {
        if constexpr (!Parcel::kWrites)
            receive(parcel, self.scene);
        else if constexpr (std::is_const_v<Self>)
            send(parcel, self.scene);
        else
            send(parcel, std::move(self.scene));
    }
    static void send(ParcelWriter& parcel, Scene scene);
    static void receive(ParcelReader& parcel, Scene& scene);
};

// Writes the scene into an empty file, whose size is sealed then. Throws Error(failed), as the other functions do.
void write_scene(MemoryFile& file, Scene scene);

// Reads a scene that write_scene() wrote. This empties the file: the memory of what was read goes back to the system. The
// process that wrote it is not trusted.
Scene read_scene(const MemoryFile& file);

// The scene of a file that write_scene() wrote and that has been sealed whole: its large arrays lie in the file, so that all
// processes that call this share one copy.
Scene map_scene(const MemoryFile& file);

// Tells whether two imported scenes make the same pictures.

// 32 hexadecimal digits, from all that the scene holds: geometry, materials, texels, lights, cameras, motion, edits. Left out
// are the places of its files, its warnings, and names by which nothing is chosen (of meshes, instances, materials, lights):
// the same files in another folder or on another machine have the same digest. Of numbered files of a sequence it holds the
// numbers, not the contents. Takes about as long as reading the scene's memory once. For any thread.
std::string scene_digest(const Scene& scene);

}  // namespace clarity::import
