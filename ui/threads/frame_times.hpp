// frame_times.hpp -- the last frame times of one side.
#pragma once
#include <memory>
#include <vector>

#include "ui/threads/prepared_scene.hpp"

namespace clarity::ui {

// Frame times of one program.
class FrameTimes {
 public:
    // Adds a time. Times of another program are dropped, and so is the first frame of this one: drivers finish compiling in it.
    void add(const std::shared_ptr<const Ready>& of, double ms);
    const std::vector<float>& ms() const { return ms_; }  // oldest first

 private:
    std::vector<float> ms_;
    std::shared_ptr<const Ready> of_;
    bool cold_ = false;  // holds only the time of the program's first frame
};

}  // namespace clarity::ui
