// frame_claim.hpp -- tells other processes that a frame is being rendered, so that none renders it twice. A claim that is lost,
// or that nobody else sees, costs double work and nothing else: the renaming of a whole picture decides who has written it.
#pragma once
#include <memory>
#include <string>

namespace clarity {

// A hidden file beside the picture, ".out_0001.exr.claim". While it lives, a thread sets the file's time every few seconds.
class FrameClaim {
 public:
    // A claim whose time is older than this has expired, because its process was killed. Of this host's processes that is known
    // at once.
    static constexpr double kExpiresAfterS = 60;

    // Returns nullptr if another process has a claim that has not expired. Where no file can be written, the claim is this
    // process's own secret.
    static std::unique_ptr<FrameClaim> take(const std::string& picture);
    // Of a picture that is complete: removes what a process left that was killed just then.
    static void remove_expired(const std::string& picture);
    ~FrameClaim();
    FrameClaim(const FrameClaim&) = delete;
    FrameClaim& operator=(const FrameClaim&) = delete;

 private:
    struct Impl;
    explicit FrameClaim(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace clarity
