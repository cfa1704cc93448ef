// sky_edit.hpp -- edits of the sky as text: see edit.hpp.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "view/view.hpp"

namespace clarity {

struct Word;

// key: "sky" or "sky.KEY". Throws Error(usage).
void read_sky(const Scene& scene, View& view, const std::string& key, const std::string& value);
// The words that turn one sky into another one.
void add_sky_words(const SkyValues& was, const SkyValues& is, std::vector<Word>& words);
// "gradient  zenith 1 1 1  strength 2": all that the sky is made of.
std::string sky_line(const SkyValues& sky);

}  // namespace clarity
