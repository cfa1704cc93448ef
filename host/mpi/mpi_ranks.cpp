#include "mpi/mpi_ranks.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "import/wire.hpp"

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

// A file in memory, closed at the end.
class MemoryFile {
 public:
    MemoryFile() : fd_(memfd_create("clarity-scene", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
        if (fd_ < 0) throw Error(Exit::failed, std::string("memory for the scene: ") + std::strerror(errno));
    }
    ~MemoryFile() { close(fd_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    int fd() const { return fd_; }

 private:
    const int fd_;
};

void check_file(const std::string& why) {
    if (!why.empty()) throw Error(Exit::failed, "sharing the scene among ranks: " + why);
}

void transfer(const std::function<ssize_t(char*, size_t, off_t)>& call, std::vector<char>& bytes, uint64_t at) {
    for (size_t done = 0; done < bytes.size();) {
        const ssize_t count = call(&bytes[done], bytes.size() - done, static_cast<off_t>(at + done));
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) check_file(std::strerror(errno));
        done += static_cast<size_t>(count);
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

void MpiRanks::collect(const std::string& mine, const std::function<void(unsigned, const std::string&)>& take) {
    const std::vector<double> sizes = gather(double(mine.size()));
    if (rank_ > 0) return check(module_->send(mine.data(), mine.size()), "sending rows");
    std::string bytes;
    for (unsigned from = 1; from < count_; ++from) {
        bytes.resize(static_cast<size_t>(sizes[from]));
        check(module_->receive(from, &bytes[0], bytes.size()), "receiving rows");
        take(from, bytes);
    }
}

std::vector<DeviceInfo> MpiRanks::own(const std::vector<DeviceInfo>& devices) const {
    std::vector<DeviceInfo> own;
    for (size_t i = here_; i < devices.size(); i += here_count_) own.push_back(devices[i]);
    if (own.empty()) own.push_back(devices[here_ % devices.size()]);
    return own;
}

// The scene goes as the flat file in which a worker hands it over, piece by piece: no rank holds it twice.
Scene MpiRanks::share_scene(const std::function<Scene()>& import) {
    constexpr uint64_t kPiece = uint64_t{64} << 20;
    const MemoryFile file;
    Scene scene;
    double size = 0;
    if (rank_ == 0) {
        scene = import();
        if (count_ == 1) return scene;
        check_file(import::write_scene(file.fd(), scene));
        struct stat status {};
        if (fstat(file.fd(), &status) != 0) check_file(std::strerror(errno));
        size = double(status.st_size);
    }
    const auto bytes = static_cast<uint64_t>(gather(size)[0]);
    std::vector<char> piece;
    for (uint64_t at = 0; at < bytes; at += kPiece) {
        piece.resize(std::min(kPiece, bytes - at));
        if (rank_ == 0) transfer([&](char* to, size_t n, off_t from) { return pread(file.fd(), to, n, from); }, piece, at);
        check(module_->broadcast(piece.data(), piece.size()), "sharing the scene");
        if (rank_ > 0) transfer([&](char* from, size_t n, off_t to) { return pwrite(file.fd(), from, n, to); }, piece, at);
    }
    if (rank_ == 0) return scene;
    if (fcntl(file.fd(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0) check_file(std::strerror(errno));
    check_file(import::read_scene(file.fd(), scene));
    check_file(validate(scene));
    return scene;
}

}  // namespace clarity
