// build.hpp -- makes a plugin of a submission: its files, and nothing else of it, in the teacher's folder, by compilers in a
// sandbox.
#pragma once
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "tools/lab/lab.hpp"
#include "tools/lab/tools.hpp"
#include "worker/job.hpp"

namespace clarity::lab {

// How compilers are kept from the teacher's files and the network.
enum class Sandbox {
    bubblewrap,  // namespaces of their own
    worker,      // a worker's limits: Landlock, seccomp and resource limits
    limits       // resource limits and no network alone: this system offers no more
};
Sandbox find_sandbox();
const char* sandbox_text(Sandbox sandbox);

// What a student may do about it. Nothing of the teacher's is in its text.
struct Refused : Error {
    explicit Refused(const std::string& why, std::string compiler = {}) : Error(Exit::failed, why, std::move(compiler)) {}
};

// Copies the lab's handout into the empty folder `to`, and of `from` the files that students hand in: regular ones, small
// enough, without forbidden words. Throws Refused.
void collect(const Lab& lab, const std::string& from, const std::string& to);
// The first forbidden word of a text outside of its comments, with its line; "": none.
std::string forbidden_word(std::string text, const std::vector<std::string>& words);

// Runs each tool once in the sandbox, in the folder `work`. Throws Error, with what a teacher may do about it.
void try_tools(const BuildTools& tools, Sandbox sandbox, const std::string& work, Progress& progress);
// Builds the folder `sources` in `build`, which may hold an earlier build. Returns the library. Throws Refused with the
// compiler's messages.
std::string compile(const Lab& lab, const std::string& sources, const std::string& build, const BuildTools& tools,
                    Sandbox sandbox, Progress& progress);

extern const worker::JobKind kToolsJob;

}  // namespace clarity::lab
