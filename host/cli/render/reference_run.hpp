// reference_run.hpp -- how the error of a picture against a reference falls while its samples are traced (--reference).
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "render/compare/picture_errors.hpp"
#include "render/settings/settings.hpp"

namespace clarity {

class MultiFrameRenderer;

class ReferenceRun {
 public:
    // Reads the reference. settings: must outlive this. Throws Error(failed); with a size that is not the picture's,
    // Error(usage).
    ReferenceRun(const std::string& file, const Settings& settings);

    struct Point {
        unsigned samples;
        PictureErrors errors;
    };
    // Begins a picture anew.
    void begin() { points_.clear(); }
    // Compares the picture so far, if it has twice the samples of the last comparison, or is finished.
    void offer(MultiFrameRenderer& frames, unsigned samples, bool finished);
    const std::vector<Point>& points() const { return points_; }
    const std::string& file() const { return file_; }
    double slope() const;

 private:
    const Settings& settings_;
    std::string file_;
    FloatImage reference_;
    std::vector<Point> points_;
};

}  // namespace clarity
