// spawn.hpp -- starts a program in a process group of its own.
#pragma once
#include <spawn.h>
#include <sys/types.h>

#include <string>
#include <vector>

namespace clarity::worker {

// How a program is started. Ctrl-C reaches only us, so that we turn it into a cancel, and its signals have the default
// handlers. It reads nothing from stdin, and gets no descriptors but those given.
class Spawn {
 public:
    Spawn();
    ~Spawn();
    Spawn(const Spawn&) = delete;
    Spawn& operator=(const Spawn&) = delete;

    // Our descriptor becomes the program's descriptor `number`.
    void give(int descriptor, int number);
    // Starts the program words[0], found by PATH if it has no slash. environment: ends with nullptr. Returns 0, or the number
    // of what went wrong.
    int start(std::vector<std::string>& words, char* const* environment, pid_t& pid);

 private:
    posix_spawn_file_actions_t files_;
    posix_spawnattr_t attributes_;
};

}  // namespace clarity::worker
