// shutter.hpp -- the times of a picture's samples while a shutter is open.
#pragma once

namespace clarity {

// A shutter that is open around the time of a picture: half of it before, half after.
struct Shutter {
    double time_s = 0;     // of the picture, on the clip's clock
    double open_s = 0;     // how long it is open; 0: all samples are at the picture's time
    unsigned samples = 1;  // of a pixel
    bool operator==(const Shutter& b) const { return time_s == b.time_s && open_s == b.open_s && samples == b.samples; }
};

// The time of a sample. The shutter's time is cut into as many equal parts as there are samples, and each sample is in the
// middle of one. Samples that follow each other are in parts far apart, so that a picture of some of its samples is evenly
// blurred, too. Depends on the arguments alone.
double sample_time(const Shutter& shutter, unsigned sample);

}  // namespace clarity
