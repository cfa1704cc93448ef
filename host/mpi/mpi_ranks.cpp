#include "mpi/mpi_ranks.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "import/import.hpp"
#include "import/wire.hpp"
#include "structures/shared_accel.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

#ifdef CLARITY_MPI_LIBRARY
std::vector<fs::path> places() {
    const fs::path folder = program_file().parent_path();
    // The installed program, and the layout of the build folder.
    return {(folder / CLARITY_LIBRARIES_FROM_PROGRAM / "clarity/mpi.so").lexically_normal(),
            (folder / "../lib/clarity/mpi.so").lexically_normal()};
}

// Parts that MPI's library loads later find its symbols only if they are global.
void* open_library(const std::string& file) {
    void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
    if (!library)
        throw Error(Exit::usage, std::string("--mpi: ") + dlerror() +
                                     "; install Open MPI (Debian: libopenmpi3, openmpi-bin), or load its module");
    return library;
}

const clarity_mpi_module* load() {
    std::string tried;
    for (const fs::path& path : places()) {
        std::error_code ignored;
        if (!fs::exists(path, ignored)) {
            tried += (tried.empty() ? "" : ", ") + path.string();
            continue;
        }
        open_library(CLARITY_MPI_LIBRARY);
        const auto* module = static_cast<const clarity_mpi_module*>(dlsym(open_library(path), CLARITY_MPI_MODULE_SYMBOL));
        if (!module) throw Error(Exit::usage, "--mpi: " + path.string() + " is of another version of this program");
        return module;
    }
    throw Error(Exit::usage, "--mpi: there is no " + tried + "; install the program again, with this library");
}
#else
const clarity_mpi_module* load() {
    throw Error(Exit::usage, "--mpi: this program was built without MPI; build it where libopenmpi-dev is installed");
}
#endif

constexpr uint64_t kPiece = uint64_t{64} << 20;  // bytes that a rank holds twice while a scene comes in

// Waits until the first rank of this host has written the whole file. MPI would wait with a busy processor, which that rank
// needs.
void wait_for(const MemoryFile& file, int64_t first_rank, Progress& progress) {
    while (!file.sealed()) {
        if (progress.cancelled()) throw Cancelled();
        // Not every starter of ranks ends all when one has ended.
        if (kill(static_cast<pid_t>(first_rank), 0) != 0 && errno == ESRCH && !file.sealed())
            throw Error(Exit::failed, "the first rank of this host has ended; its messages say why");
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

}  // namespace

MpiRanks::MpiRanks() : module_(load()) {
    check(module_->begin(&rank_, &count_, &here_, &here_count_), "begin");
}

void MpiRanks::finish() {
    check(module_->end(), "end");
}

void MpiRanks::check(const char* why, const char* what) const {
    if (why) throw Error(Exit::failed, "MPI, rank " + std::to_string(rank_) + ", " + what + ": " + why);
}

std::vector<double> MpiRanks::gather(double mine) {
    std::vector<double> all(count_);
    check(module_->gather(mine, all.data()), "gathering numbers");
    return all;
}

void MpiRanks::send(const void* data, uint64_t bytes) {
    check(module_->send(data, bytes), "sending rows");
}

void MpiRanks::receive(unsigned from, void* data, uint64_t bytes) {
    check(module_->receive(from, data, bytes), "receiving rows");
}

std::vector<DeviceInfo> MpiRanks::own(const std::vector<DeviceInfo>& devices) const {
    std::vector<DeviceInfo> own;
    for (size_t i = here_; i < devices.size(); i += here_count_) own.push_back(devices[i]);
    if (own.empty()) own.push_back(devices[here_ % devices.size()]);
    return own;
}

// The file of this host's first rank, open in all ranks of the host. mine: whether this rank has to fill it. So has the first
// one, and one that cannot open the file of the first, as in a container of its own, and has its own instead.
MemoryFile MpiRanks::file_of_host(bool& mine) {
    std::optional<MemoryFile> file;
    MemoryFile::Address address;
    if (here_ == 0) address = file.emplace().address();
    check(module_->tell_host(&address, sizeof address), "sharing memory");
    if (here_ > 0) file = MemoryFile::open(address);
    first_of_host_ = address.process;
    mine = here_ == 0 || !file;
    if (!file) file.emplace();
    gather(0);  // the first rank does not close its file before the others have opened it
    return std::move(*file);
}

// The scene goes as the flat file in which a worker hands it over, piece by piece.
Scene MpiRanks::share_scene(const PluginRegistry& plugins, const std::function<Scene()>& import, Progress& progress) {
    if (count_ == 1) return import();
    bool fills = false;
    MemoryFile file = file_of_host(fills);
    check(module_->receivers(fills), "sharing the scene");
    if (rank_ == 0) import::write_scene(file, import());
    if (fills) {
        double bytes = rank_ == 0 ? double(file.bytes()) : 0;
        check(module_->broadcast(&bytes, sizeof bytes), "sharing the scene");
        std::vector<char> piece;
        for (uint64_t at = 0; at < uint64_t(bytes); at += kPiece) {
            piece.resize(std::min(kPiece, uint64_t(bytes) - at));
            if (rank_ == 0) file.read_at(at, piece.data(), piece.size());
            check(module_->broadcast(piece.data(), piece.size()), "sharing the scene");
            if (rank_ > 0) file.write_at(at, piece.data(), piece.size());
        }
        file.seal();
    }
    wait_for(file, first_of_host_, progress);
    Scene scene = import::map_scene(file);
    if (const Problem why = import::complete_scene(plugins, scene))
        throw Error(Exit::import_failed, "the scene that rank 0 has sent " + why.text());
    return scene;
}

std::shared_ptr<const AccelData> MpiRanks::share_structure(const PluginRegistry& plugins, const AccelBuilder& build,
                                                           const Scene& scene, Progress& progress) {
    if (count_ == 1) return nullptr;
    bool fills = false;
    MemoryFile file = file_of_host(fills);
    if (here_count_ == 1 || (fills && here_ > 0)) return nullptr;
    if (fills) write_accel(file, *build(scene, progress));
    wait_for(file, first_of_host_, progress);
    return map_accel(file, plugins);
}

}  // namespace clarity
