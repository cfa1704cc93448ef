// statements.hpp -- one function for each statement; docs/scene_format.md is their reference.
#pragma once
#include "document.hpp"
#include "statement.hpp"

namespace scene_format {

// All of them read the rest of the statement into the document, or throw StatementError; the document is then only good for
// finding further errors.
void read_camera(Statement&, Document&, Diagnostics&);
void read_light(Statement&, Document&, Diagnostics&);
void read_background(Statement&, Document&, Diagnostics&);
void read_ambient(Statement&, Document&, Diagnostics&);
void read_material(Statement&, Document&, Diagnostics&);
void read_sphere(Statement&, Document&, Diagnostics&);
void read_plane(Statement&, Document&, Diagnostics&);
void read_polygon(Statement&, Document&, Diagnostics&);
void read_triangle(Statement&, Document&, Diagnostics&);
void read_load(Statement&, Document&, Diagnostics&);
void read_animate(Statement&, Document&, Diagnostics&);

}  // namespace scene_format
