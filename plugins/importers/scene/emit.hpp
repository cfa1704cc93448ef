// emit.hpp -- hands a sound Document to the host's sink.
#pragma once
#include <string_view>

#include "document.hpp"

namespace scene_format {

// RT_OK, RT_FAILED (the sink has recorded why; a log line tells where in `file`) or RT_CANCELLED.
int32_t emit(const Document& document, std::string_view file, const rt_host& host, const rt_scene_sink& sink);

}  // namespace scene_format
