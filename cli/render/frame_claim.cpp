#include "cli/render/frame_claim.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "base/machine.hpp"

namespace clarity {
namespace {

constexpr auto kBeat = std::chrono::seconds(5);

std::string claim_path(const std::string& picture) {
    const size_t slash = picture.rfind('/'), name = slash == std::string::npos ? 0 : slash + 1;
    return picture.substr(0, name) + "." + picture.substr(name) + ".claim";
}

double seconds_of(const timespec& time) {
    return double(time.tv_sec) + double(time.tv_nsec) * 1e-9;
}

// The file server's time, which may be another than this host's: that of a file that is written now.
bool server_time(const std::string& beside, double& seconds) {
    const std::string path = beside + "." + host_name() + "-" + std::to_string(getpid());
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) return false;
    struct stat status{};
    const bool known = write(file, "?", 1) == 1 && fstat(file, &status) == 0;
    close(file);
    unlink(path.c_str());
    if (known) seconds = seconds_of(status.st_mtim);
    return known;
}

// A process of this host that is gone, or a claim that nobody has renewed.
bool has_expired(const std::string& path) {
    std::ifstream file(path);
    std::string host;
    long process = 0;
    if (file >> host >> process && host == host_name() && process > 0 && kill(pid_t(process), 0) != 0 && errno == ESRCH)
        return true;
    struct stat status{};
    if (stat(path.c_str(), &status) != 0) return errno == ENOENT;
    double now = 0;
    return server_time(path, now) && now - seconds_of(status.st_mtim) > FrameClaim::kExpiresAfterS;
}

}  // namespace

struct FrameClaim::Impl {
    std::string path;
    int file = -1;
    std::mutex mutex;
    std::condition_variable wake;
    bool ends = false;
    std::thread beats;

    void beat() {
        std::unique_lock<std::mutex> lock(mutex);
        while (!wake.wait_for(lock, kBeat, [this] { return ends; })) futimens(file, nullptr);
    }
    // Whether the file of that name is the one that is open here: another process may have taken the claim for expired.
    bool is_ours() const {
        struct stat mine{}, named{};
        return fstat(file, &mine) == 0 && stat(path.c_str(), &named) == 0 && mine.st_ino == named.st_ino &&
               mine.st_dev == named.st_dev;
    }
};

FrameClaim::FrameClaim(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

std::unique_ptr<FrameClaim> FrameClaim::take(const std::string& picture) {
    auto impl = std::make_unique<Impl>();
    impl->path = claim_path(picture);
    for (int attempt = 0; attempt < 3 && impl->file < 0; ++attempt) {
        impl->file = open(impl->path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (impl->file >= 0 || errno != EEXIST) break;
        if (!has_expired(impl->path)) return nullptr;
        unlink(impl->path.c_str());
    }
    if (impl->file >= 0) {
        const std::string text = host_name() + " " + std::to_string(getpid()) + "\n";
        if (write(impl->file, text.data(), text.size()) >= 0) impl->beats = std::thread([&claim = *impl] { claim.beat(); });
    }
    return std::unique_ptr<FrameClaim>(new FrameClaim(std::move(impl)));
}

void FrameClaim::remove_expired(const std::string& picture) {
    const std::string path = claim_path(picture);
    struct stat status{};
    if (stat(path.c_str(), &status) == 0 && has_expired(path)) unlink(path.c_str());
}

FrameClaim::~FrameClaim() {
    {
        const std::lock_guard<std::mutex> lock(impl_->mutex);
        impl_->ends = true;
    }
    impl_->wake.notify_all();
    if (impl_->beats.joinable()) impl_->beats.join();
    if (impl_->file < 0) return;
    if (impl_->is_ours()) unlink(impl_->path.c_str());
    close(impl_->file);
}

}  // namespace clarity
