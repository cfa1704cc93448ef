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

    // Returns nullptr if another process has a claim that has not expired. If the claim's file cannot be written, the claim
    // holds all the same, but no other process sees it.
    static std::unique_ptr<FrameClaim> take(const std::string& picture);
    // Removes the expired claim of a picture that is complete: its process was killed before it could remove the claim.
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
