// picture_captions.hpp -- what stands beside pictures that are compared: which is which, how they were made, how fast.
#pragma once
#include <string>
#include <vector>

#include "ui/hud/picture_hud.hpp"
#include "ui/session/session.hpp"

namespace clarity::ui {

// What differs between the two sides besides the structure, as a person says it: {"packet 4x4", "lanes 8"} of the first,
// {"packet 8x8", "lanes 16"} of the second.
struct Differences {
    std::vector<std::string> of[2];
};
Differences differing_settings(const Picture& picture);

struct Caption {
    std::string title;    // "A  bvh2"
    std::string details;  // "packet 4x4, lanes 8"; empty where nothing else differs
    std::string speed;    // "12.3 ms, 48.1 Mrays/s"
    std::string verdict;  // see speed_verdict()
    bool faster = false;  // the verdict says so
};
Caption caption_of(const Session& session, const Picture& picture, unsigned side);
std::vector<HudText> caption_lines(const Caption& caption);
std::string difference_text(const PictureDifference& difference);

}  // namespace clarity::ui
