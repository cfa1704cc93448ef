// trust.hpp -- where the code of a plugin library runs: at once in this process, or in a worker first. One rule for opening it,
// for its builds and for its kernels.
#pragma once
#include <string>

#include "base/problem.hpp"
#include "worker/job.hpp"

namespace clarity {

enum class Trust {
    none,    // in a worker first
    proven,  // a build of a library with this content has come to its end in a worker. Its kernels are tried all the same
    own      // in a plugin folder of this program, or of the program that CLARITY_WORKER names
};

// Of a library. With CLARITY_PLUGINS=worker there is none for any library, so that each is opened, and each structure built, in
// a worker every time. Thread-safe; may read the file.
Trust trust_of(const std::string& path);

// From now on no library is proven in this process, only own ones are trusted: for processes that a crash must not end.
void trust_own_libraries_only();

// Makes a library proven, in this process and later ones ($XDG_CACHE_HOME/clarity/known_plugins).
void remember_library(const std::string& path);

// Opens a library in a worker process before this process does. The dynamic loader and a library's
// constructors run at once; a damaged file crashes them.

// Opens and checks a library without trust (trust.hpp) in a worker. Returns nothing if that worker came to
// an end, or could not be started; otherwise how it died: the library must then not be opened here. Thread-safe.
Problem try_to_load(const std::string& path);

extern const worker::JobKind kLoadJob;

}  // namespace clarity
