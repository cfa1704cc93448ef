// emit.hpp -- passes a Document without errors to the host's sink.
#pragma once
#include <string_view>

#include "document.hpp"

namespace scene_format {

// Returns RT_OK, RT_CANCELLED, or RT_FAILED. If it fails, the sink has recorded the reason, and a log line names the statement
// in `file`.
int32_t emit(const Document& document, std::string_view file, const rt_host& host, const rt_scene_sink& sink);

}  // namespace scene_format
