#include "kernels/program_cache.hpp"

#include "compile/compile.hpp"
#include "device/kernel_files.hpp"

namespace clarity {

// A picture's kernel contains two traversals and shading. Without a limit it takes 145 to 160 registers a work-item, so that 12
// warps run on a multiprocessor of an H200. With 128 registers 16 warps run, and frames are 1.02 to 1.16 times as fast. Limits
// of 112 and 144 are worse (docs/experiments.md). `path` takes 168 and more; with 128 it is 1.19 times as fast on cornell.scene
// and 1.08 on showpiece_sky.scene, and as fast to a hundredth on spheres_sky.scene.
std::string options_for(const DeviceInfo& info, const KernelSource& source) {
    return source.options + (source.limit_registers && info.nvidia && !info.pocl ? " -cl-nv-maxrregcount=128" : "");
}

TraceProgram::TraceProgram(const KernelSource& source, cl::Program compiled)
    : row(*source.row), program(std::move(compiled)), declarations_(source.declarations), macros_(source.macros) {}

KernelArguments TraceProgram::kernel(const char* entry) const {
    const std::string name = entry ? entry : row.entry;
    return {cl::Kernel(program, name.c_str()), argument_names(declarations_, name, macros_),
            std::string("cl/") + row.file + ": kernel " + name};
}

ProgramCache::~ProgramCache() {
    if (device_->loss()->stuck()) never_release(std::make_shared<std::list<Entry>>(std::move(entries_)));
}

std::shared_ptr<TraceProgram> ProgramCache::get(const KernelSource& source, bool* fresh) {
    Progress never_cancelled;
    return get(source, fresh, never_cancelled);
}

std::shared_ptr<TraceProgram> ProgramCache::get(const KernelSource& source, bool* fresh, Progress& progress) {
    if (fresh) *fresh = false;
    // After an edit of kernel files the old programs will not be asked for again. Each takes a megabyte on PoCL.
    if (const uint64_t revision = kernel_text_revision(); revision != text_revision_) {
        entries_.clear();
        text_revision_ = revision;
    }
    const std::string key = source.options + "\n" + source.text;
    for (auto it = entries_.begin(); it != entries_.end(); ++it)
        if (it->key == key) {
            entries_.splice(entries_.begin(), entries_, it);
            return it->program;
        }
    ++compiled_;
    const BuildResult built =
        compile_program(*device_, {source.text, options_for(device_->info(), source), source.what}, progress);
    auto program = std::make_shared<TraceProgram>(source, built.program);
    program->compile_ms = built.ms;
    entries_.push_front({key, program});
    if (entries_.size() > kKept) entries_.pop_back();
    if (fresh) *fresh = true;
    return program;
}

}  // namespace clarity
