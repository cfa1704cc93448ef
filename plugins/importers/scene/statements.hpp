// statements.hpp -- one function for each statement. Their reference is docs/scene_format.md.
#pragma once
#include "document.hpp"
#include "statement.hpp"

namespace scene_format {

// Each function reads the rest of its statement into the document. It throws StatementError if it cannot; the document may then
// only be used to find further errors.
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
