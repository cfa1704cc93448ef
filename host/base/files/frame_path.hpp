// frame_path.hpp -- names of numbered files: walk_####.obj stands for walk_0001.obj and so on.
#pragma once
#include <string>
#include <vector>

namespace clarity {

// Puts a number in the place of the last run of # in the file's name: "out_####.png", 12 -> "out_0012.png". Numbers that are
// longer than the run are written in full. A path without # stays as it is.
std::string frame_path(const std::string& pattern, int frame);

// The numbers, 0 or more, for which a file exists. They are in order; there may be gaps. Empty for a path without #.
std::vector<int> frame_numbers(const std::string& pattern);

// The path itself if there is such a file, or it has no #. Otherwise the first file that the pattern stands for, or empty.
std::string first_frame(const std::string& path);

}  // namespace clarity
