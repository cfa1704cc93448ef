// picture_captions.hpp -- captions of compared pictures: which side it is, how it was made, how fast it is.
#pragma once
#include <string>
#include <vector>

#include "ui/hud/picture_hud.hpp"
#include "ui/session/session.hpp"

namespace clarity::ui {

// The settings which differ between the two sides, apart from the structure, in words: {"packet 4x4", "lanes 8"} for the first
// side, {"packet 8x8", "lanes 16"} for the second.
struct Differences {
    std::vector<std::string> of[2];
};
Differences differing_settings(const Picture& picture);

struct Caption {
    std::string title;    // "A  bvh2"
    std::string details;  // "packet 4x4, lanes 8"; empty if nothing else differs
    // "12.3 ms of kernels, 48.1 Mrays/s": as in the Stats tab. By the devices' clocks, since the host's part of a frame is
    // small on a CPU, which it shares, and may be the larger part on a GPU.
    std::string speed;
    std::string noise;    // with equal times: "4.1 % of error, 128 samples in 3.2 s"
    std::string verdict;  // see speed_verdict()
    bool faster = false;  // whether the verdict says "faster"
};
Caption caption_of(const Session& session, const Picture& picture, unsigned side);
std::vector<HudText> caption_lines(const Caption& caption);
std::string difference_text(const PictureDifference& difference);

// Decides from measured frame times which of two sides is faster.
inline constexpr const char* kAboutTheSame = "about the same";

// Returns "1.80x faster" if `mine` is faster than `others`, and kAboutTheSame if the difference is within the spread of the
// times. Returns an empty text for the slower side, and if a side has fewer than five times. Times are milliseconds of frames
// that the two sides trace alternately.
std::string speed_verdict(const std::vector<float>& mine, const std::vector<float>& others);

}  // namespace clarity::ui
