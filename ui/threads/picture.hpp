// picture.hpp -- what the frame thread takes and makes: jobs and traced pictures.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "picture/film_noise.hpp"
#include "stand/multi_frame_renderer.hpp"
#include "ui/threads/picture_part.hpp"
#include "ui/threads/prepared_scene.hpp"
#include "view/settings/aov.hpp"

namespace clarity::ui {

// How the estimated error of a picture of `path` has fallen while its samples were traced.

class Convergence {
 public:
    struct Point {
        double samples;  // a pixel, the mean
        double seconds;  // of tracing
        double error;    // FilmNoise::error
        double rmse;     // against the reference; NaN: there is none of this size
    };
    // A sample more was traced, in so many milliseconds; sample 0 begins anew. Returns whether the error is to be estimated
    // now: of some samples only, as the film must be read for it.
    bool add(unsigned sample, double ms);
    // Estimated after the last sample. More than once does no harm.
    void put(const FilmNoise& noise, double rmse);
    double seconds() const { return seconds_; }  // of all samples
    const std::vector<Point>& points() const { return points_; }
    // The exponent of the samples by which the error falls; NaN: not known.
    double slope() const;

 private:
    std::vector<Point> points_;
    double seconds_ = 0;
};

// Everything that the frame thread needs to trace and display a picture.
struct FrameJob {
    std::shared_ptr<const Ready> ready;
    Settings settings;                       // as desired; settings which need another preparation than `ready` are ignored
    std::optional<Settings> other_settings;  // of the second side, which is traced if `ready` has it
    View view;
    bool known = true;                            // Ready::knows() the view; else nothing is traced
    double open_s = 0;                            // motion blur: how long the shutter is open, of the clip's clock; 0: none
    CameraPath camera_path;                       // that the view's camera is on, for motion blur; empty: it is on none
    uint64_t revision = 0;                        // when it changes, the films start again from sample 0
    uint64_t display_revision = 0;                // when it changes, the films are displayed again
    bool continuous = false;                      // trace again and again, to measure
    bool equal_time = false;                      // of two sides: DesiredState::equal_time
    float resolution_scale = 1;                   // factor for the settings' width and height
    bool moving = false;                          // something moves
    std::shared_ptr<const FloatImage> reference;  // what pictures of its size should be; nullptr: not known
    std::optional<PicturePart> part;              // that alone is traced
    float moving_fps = 0;  // target frame rate while something moves, which may reduce the pixels; 0: trace all pixels
};

// One side of a picture.
struct PictureSide {
    ByteImage image;        // the whole, also if a part was traced, as `settings` then say
    FalseColorScale scale;  // the scale of an AOV; without a map for colours
    Settings settings;      // as traced
    FrameStats stats;
    // Milliseconds that this thread spent on the frame: tracing, and the readback if the thread had to wait for it.
    double frame_ms = 0;
    double kernels_ms() const;  // sum of the kernels and copies of this frame, by the device's clock
    // Distances of the camera rays of sample 0, +inf for a miss. nullptr if not asked for; an empty image if they are not
    // known.
    std::shared_ptr<const FloatImage> distance;
    std::shared_ptr<const FloatImage> values;  // the values behind a false-color picture; otherwise nullptr
    Convergence convergence;                   // of `path`
};

// How much two images differ.
struct PictureDifference {
    ByteImage image;               // |a - b| in each channel, times eight
    double mean = 0, largest = 0;  // of 255
    double share = 0;              // share of the pixels which differ by more than 1 of 255
};

// A traced picture. It does not change after latest() has returned it.
struct Picture {
    FrameJob job;
    PictureSide main;
    std::optional<PictureSide> other;
    std::optional<PictureDifference> difference;
    bool reduced = false;  // has fewer pixels than asked for, because something moves
};

// The settings to trace with: those of `desired_now` that apply to the next frame at once, and all others as prepared.
Settings frame_settings(const Settings& prepared, const Settings& desired_now);

// Removes the times of the display kernels, which reading the display adds again.
FrameStats traced_part(FrameStats stats);
// Two heat maps can only be compared if a colour means the same in both. So both get the larger of the two scales.
void share_scale(PictureSide& a, PictureSide& b);
// Replaces the image of a side by that of the finished picture. The picture is being traced again for its times, and its first
// samples are jagged: to show them between finished pictures would flicker.
void keep_image(PictureSide& side, const PictureSide& finished);

// What is shown around a part of a picture: the last whole one that was seen from there.
class Surroundings {
 public:
    // Puts images of a part into the whole. Remembers those of a whole picture.
    void put_around(Picture& picture);

 private:
    ByteImage images_[2];
    Camera camera_;
    std::weak_ptr<const void> loaded_;
};

// Compares two pictures of the same view pixel by pixel.

// Compares two images of the same size. If the sizes differ, every pixel counts as different and the image is empty.
PictureDifference compare_pictures(const ByteImage& a, const ByteImage& b);

// The last frame times of one side.

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
