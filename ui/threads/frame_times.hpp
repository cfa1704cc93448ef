// frame_times.hpp -- the last frame times of one side.
#pragma once
#include <memory>
#include <vector>

#include "ui/threads/picture.hpp"

namespace clarity::ui {

// Times of the frames of one program, in milliseconds, oldest first.
class FrameTimes {
 public:
    // Adds those of a frame. Times of another program are dropped, and so is the first frame of this one: drivers finish
    // compiling in it.
    void add(const std::shared_ptr<const Ready>& of, const PictureSide& side);
    // PictureSide::frame_ms, and the sums of its kernels. The former has the host's part too.
    const std::vector<float>& frames_ms() const { return frames_ms_; }
    const std::vector<float>& kernels_ms() const { return kernels_ms_; }
    // Of the last 30 frames, to compare two sides: with more, frames of an earlier view would count too.
    std::vector<float> recent_kernels_ms() const;
    size_t size() const { return frames_ms_.size(); }

 private:
    std::vector<float> frames_ms_, kernels_ms_;
    std::shared_ptr<const Ready> of_;
    bool cold_ = false;  // holds only the time of the program's first frame
};

}  // namespace clarity::ui
