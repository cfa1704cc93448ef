// sequence_reader.hpp -- reads the files of sequences when poses need them, and keeps the last two.
#pragma once
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "import/import.hpp"

namespace clarity::import {

// Not thread-safe.
class SequenceReader {
 public:
    SequenceReader(const PluginRegistry& plugins, ImportOptions options, Progress& progress);
    // The vertices of a file, as FrameVertices of scene/motion/pose.hpp asks for them. Throws what import_scene() throws.
    std::vector<float> operator()(const std::string& file);

 private:
    const PluginRegistry& plugins_;
    ImportOptions options_;
    Progress& progress_;
    std::deque<std::pair<std::string, std::vector<float>>> kept_;
};

}  // namespace clarity::import
