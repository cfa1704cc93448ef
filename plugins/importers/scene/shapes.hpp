// shapes.hpp -- statements of shapes, which plugins make. Their words and keys come from the host as a table.
#pragma once
#include <string_view>
#include <vector>

#include "document.hpp"
#include "statement.hpp"

namespace scene_format {

// All kinds of shapes that the sink takes; none if it is of a host without shapes.
std::vector<const rt_primitive_kind*> shape_kinds(const rt_scene_sink& sink);

// Reads the rest of the statement into the document. Throws StatementError.
void read_shape(Statement& s, const rt_primitive_kind& kind, Document& document);

}  // namespace scene_format
