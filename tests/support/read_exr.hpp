// read_exr.hpp -- reads channels of an EXR file with OpenEXR itself. Empty without it.
#pragma once
#ifdef CLARITY_HAVE_OPENEXR
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/pictures/image_io.hpp"

namespace clarity {

inline FloatImage read_exr(const std::string& path, const std::vector<const char*>& names) {
    Imf::InputFile file(path.c_str());
    const auto window = file.header().dataWindow();
    FloatImage image{
        unsigned(window.max.x - window.min.x + 1), unsigned(window.max.y - window.min.y + 1), unsigned(names.size()), {}};
    image.pixels.resize(size_t(image.width) * image.height * image.channels);
    Imf::FrameBuffer frame;
    const size_t pixel = names.size() * sizeof(float);
    for (size_t c = 0; c < names.size(); ++c) {
        EXPECT_NE(file.header().channels().findChannel(names[c]), nullptr) << names[c];
        frame.insert(names[c],
                     Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(image.pixels.data() + c), pixel, pixel * image.width));
    }
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    return image;
}

}  // namespace clarity
#endif
